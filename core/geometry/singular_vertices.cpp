#include "core/geometry/singular_vertices.h"

namespace paperbake {

bool is_at_vertex(const SingularPoint& point, const Sheet& sheet, int vertex) {
  constexpr double rounding = 1e-9;  // [m]
  return (sheet.pattern.row(vertex).transpose() - point.pattern).norm() < rounding;
}

std::vector<char> singular_vertices(const Sheet& sheet) {
  std::vector<char> singular(sheet.pattern.rows(), 0);
  for (const SingularPoint& point : sheet.singular)
    for (int v = 0; v < sheet.pattern.rows(); ++v)
      if (is_at_vertex(point, sheet, v)) singular[v] = 1;
  return singular;
}

}  // namespace paperbake
