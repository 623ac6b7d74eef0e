#include "core/animation/motion_measures.h"

#include <algorithm>
#include <limits>

namespace paperbake {

double max_displacement(const Sheet& sheet, const PositionConstraints& held,
                        const PositionConstraints& held_before, const Points3& before,
                        const Colliders* colliders) {
  if (held.vertices != held_before.vertices) return std::numeric_limits<double>::infinity();
  double most =
      held.targets.rows() ? (held.targets - held_before.targets).rowwise().norm().maxCoeff() : 0;
  if (colliders)
    most = std::max(most, farthest_move(*colliders, held.colliders.from, held.colliders.to));
  if (before.rows() != sheet.x.rows()) return std::numeric_limits<double>::infinity();
  return std::max(most, (sheet.x - before).rowwise().norm().maxCoeff());
}

std::vector<int> isolated_moving_handles(const Sheet& sheet, const PositionConstraints& held,
                                         double min_move, double apart) {
  std::vector<int> pulled;
  for (std::size_t k = 0; k < held.vertices.size(); ++k) {
    const auto p = sheet.pattern.row(held.vertices[k]);
    bool alone = (sheet.x.row(held.vertices[k]) - held.targets.row(k)).norm() > min_move;
    for (std::size_t j = 0; j < held.vertices.size() && alone; ++j)
      alone = j == k || (sheet.pattern.row(held.vertices[j]) - p).norm() > apart;
    if (alone) pulled.push_back(held.vertices[k]);
  }
  return pulled;
}

double relative_handle_motion(const Sheet& sheet, const PositionConstraints& held,
                              const PositionConstraints& held_before) {
  Points3 way(held.vertices.size(), 3);
  for (std::size_t k = 0; k < held.vertices.size(); ++k) {
    const auto was =
        std::find(held_before.vertices.begin(), held_before.vertices.end(), held.vertices[k]);
    const Eigen::RowVector3d from =
        was == held_before.vertices.end()
            ? Eigen::RowVector3d(sheet.x.row(held.vertices[k]))
            : Eigen::RowVector3d(held_before.targets.row(was - held_before.vertices.begin()));
    way.row(k) = held.targets.row(k) - from;
  }
  return way.rows() ? (way.rowwise() - way.colwise().mean().eval()).rowwise().norm().maxCoeff() : 0;
}

}  // namespace paperbake
