#include "core/geometry/crease_network.h"

#include "core/geometry/hinges.h"
#include "core/geometry/singular_vertices.h"

#include <cmath>
#include <vector>

namespace paperbake {

CreaseNetwork crease_network(const Sheet& sheet) {
  constexpr double folded = 0.35;  // [rad] 20 degrees
  struct Part {
    int to;
    double length;  // [m]
  };
  CreaseNetwork network;
  std::vector<std::vector<Part>> creases_at(sheet.pattern.rows());
  for (const Hinge& hinge : find_hinges(sheet.triangles).hinges) {
    if (std::abs(dihedral_angle(sheet.x, hinge)) < folded) continue;
    const int a = hinge.vertices[0], b = hinge.vertices[1];
    const double length = (sheet.pattern.row(b) - sheet.pattern.row(a)).norm();
    creases_at[a].push_back({b, length});
    creases_at[b].push_back({a, length});
    network.length += length;
  }
  const std::vector<char> singular = singular_vertices(sheet);
  const auto is_end = [&](int v) { return creases_at[v].size() != 2 || singular[v]; };
  for (int v = 0; v < sheet.pattern.rows(); ++v) {
    if (!is_end(v)) continue;
    network.count += 0.5 * creases_at[v].size();
    for (const Part& first : creases_at[v]) {
      int from = v, to = first.to;
      double length = first.length;
      while (!is_end(to)) {
        const Part& next = creases_at[to][creases_at[to][0].to == from];
        from = to;
        to = next.to;
        length += next.length;
      }
      // a crease is found from both of its ends: keep it once
      if (v < to || (v == to && first.to < from)) network.creases.push_back(length);
    }
  }
  return network;
}

}  // namespace paperbake
