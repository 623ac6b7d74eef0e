#include "core/animation/motion_measures.h"

#include "core/geometry/rigid_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace paperbake {
namespace {

/// |constraints|x3 [m]
Points3 targets_of(const PositionConstraints& constraints) {
  Points3 targets(constraints.size(), 3);
  for (std::size_t k = 0; k < constraints.size(); ++k) targets.row(k) = constraints[k].target;
  return targets;
}

}  // namespace

double max_displacement(const Sheet& sheet, const StepInput& now,
                        const PositionConstraints& held_before, const Points3& before) {
  const PositionConstraints& held = now.constraints;
  if (vertices_of(held) != vertices_of(held_before)) return std::numeric_limits<double>::infinity();
  double most =
      held.empty() ? 0 : (targets_of(held) - targets_of(held_before)).rowwise().norm().maxCoeff();
  most = std::max(most, farthest_move(now.colliders.from, now.colliders.to));
  if (before.rows() != sheet.x.rows()) return std::numeric_limits<double>::infinity();
  return std::max(most, (sheet.x - before).rowwise().norm().maxCoeff());
}

std::vector<int> isolated_moving_handles(const Sheet& sheet, const PositionConstraints& held,
                                         double min_move, double apart) {
  std::vector<int> pulled;
  for (const PositionConstraint& c : held) {
    const auto p = sheet.pattern.row(c.vertex);
    const bool moves = (sheet.x.row(c.vertex) - c.target.transpose()).norm() > min_move;
    if (moves && std::all_of(held.begin(), held.end(), [&](const PositionConstraint& other) {
          return &other == &c || (sheet.pattern.row(other.vertex) - p).norm() > apart;
        }))
      pulled.push_back(c.vertex);
  }
  return pulled;
}

double relative_handle_motion(const Sheet& sheet, const PositionConstraints& held,
                              const PositionConstraints& held_before) {
  Points3 way(held.size(), 3);
  for (std::size_t k = 0; k < held.size(); ++k) {
    const auto was =
        std::find_if(held_before.begin(), held_before.end(),
                     [&](const PositionConstraint& c) { return c.vertex == held[k].vertex; });
    const Vector3d from =
        was == held_before.end() ? Vector3d(sheet.x.row(held[k].vertex)) : was->target;
    way.row(k) = held[k].target - from;
  }
  return way.rows() ? (way.rowwise() - way.colwise().mean().eval()).rowwise().norm().maxCoeff() : 0;
}

double rms_deformation(const Points3& before, const Points3& now) {
  if (before.rows() != now.rows() || now.rows() == 0) return 0;
  const RigidMotion motion = nearest_rigid_motion(before, now);
  const Points3 carried = (before * motion.turn.transpose()).rowwise() + motion.shift.transpose();
  return std::sqrt((now - carried).rowwise().squaredNorm().mean());
}

}  // namespace paperbake
