#include "core/render/crease_memory.h"

#include "core/model/segment2.h"

#include <algorithm>
#include <cmath>

namespace paperbake {

CreasesOfMesh::CreasesOfMesh(const Points2& pattern,
                             const std::vector<std::pair<int, int>>& creases) {
  for (const auto& [a, b] : creases) {
    const Vector2d p = pattern.row(a), q = pattern.row(b);
    creases_.push_back({0.5 * (p + q), (q - p).normalized(), creases_.size()});
  }
  std::sort(creases_.begin(), creases_.end(), [](const Crease& a, const Crease& b) {
    return a.middle.x() < b.middle.x() || (a.middle.x() == b.middle.x() && a.number < b.number);
  });
}

std::vector<double> CreasesOfMesh::least_shares(
    const Points2& pattern, const std::vector<RememberedCrease>& remembered) const {
  constexpr double beside = 0.05, askew = 0.3;  // [1] of the length; sine of an angle
  if (remembered.empty()) return {};
  std::vector<double> shares(creases_.size(), 0.0);
  for (const RememberedCrease& edge : remembered) {
    const Vector2d a = pattern.row(edge.a), b = pattern.row(edge.b);
    const double length = (b - a).norm(), near = beside * length;
    const auto [low, high] = std::minmax(a.x(), b.x());
    auto crease = std::lower_bound(creases_.begin(), creases_.end(), low - near,
                                   [](const Crease& c, double x) { return c.middle.x() < x; });
    for (; crease != creases_.end() && crease->middle.x() <= high + near; ++crease)
      if (distance_to_segment(crease->middle, a, b) <= near &&
          std::abs(cross(crease->along, b - a)) <= askew * length)
        shares[crease->number] = std::max(shares[crease->number], edge.share);
  }
  return shares;
}

}  // namespace paperbake
