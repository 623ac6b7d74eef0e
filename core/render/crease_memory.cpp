#include "core/render/crease_memory.h"

#include <algorithm>
#include <cmath>

namespace paperbake {

CreasesOfMesh::CreasesOfMesh(const Points2& pattern,
                             const std::vector<std::pair<int, int>>& creases) {
  for (const auto& [a, b] : creases) {
    const Segment2 line{pattern.row(a), pattern.row(b)};
    creases_.push_back({0.5 * (line.a.x() + line.b.x()), line, creases_.size()});
  }
  std::sort(creases_.begin(), creases_.end(), [](const Crease& a, const Crease& b) {
    return a.x < b.x || (a.x == b.x && a.number < b.number);
  });
}

std::vector<double> CreasesOfMesh::least_shares(const Sheet& sheet) const {
  if (sheet.remembered.empty()) return {};
  std::vector<double> shares(creases_.size(), 0.0);
  for (const RememberedCrease& edge : sheet.remembered) {
    const Vector2d a = sheet.pattern.row(edge.a), b = sheet.pattern.row(edge.b);
    const double near = 1e-3 * (b - a).norm();
    const auto [low, high] = std::minmax(a.x(), b.x());
    auto crease = std::lower_bound(creases_.begin(), creases_.end(), low - near,
                                   [](const Crease& c, double x) { return c.x < x; });
    for (; crease != creases_.end() && crease->x <= high + near; ++crease)
      if (distance_to_segment(crease->line.a, a, b) < near &&
          distance_to_segment(crease->line.b, a, b) < near)
        shares[crease->number] = std::max(shares[crease->number], edge.share);
  }
  return shares;
}

}  // namespace paperbake
