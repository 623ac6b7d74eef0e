#pragma once

#include "core/model/sheet.h"

#include <optional>
#include <vector>

namespace paperbake {

/// x -> turn x + shift
struct RigidMotion {
  Eigen::Matrix3d turn;
  Vector3d shift;  // [m]
  Vector3d operator()(const Vector3d& x) const { return turn * x + shift; }
};

/// The motion that does the same as the given one when it is done twice; it turns by less than 180
/// degrees.
RigidMotion half_of(const RigidMotion&);

/// Half way to a target: on the arc of a motion that goes near it, and straight for what is left.
/// [m]
Vector3d half_way(const RigidMotion&, const Vector3d& from, const Vector3d& target);

/// The places to which a motion takes points. n x 3 [m]
Points3 moved(const RigidMotion&, const Points3&);

/// The rigid motion that takes points nearest to their targets, by least squares. Where the points
/// lie in one line, the turn about that line is arbitrary.
/// points, targets  n x 3 [m]
/// source           [Kabsch 1976]
RigidMotion nearest_rigid_motion(const Points3& points, const Points3& targets);

/// The same if it takes each point to within `slack` [m] of its target; none: it does not.
std::optional<RigidMotion> rigid_motion_between(const Points3& points, const Points3& targets,
                                                double slack);

/// The nearest one, each of the n points with its weight, which is not negative.
RigidMotion nearest_rigid_motion(const Points3& points, const Points3& targets,
                                 const Eigen::VectorXd& weights);

/// The rigid motion of a whole sheet: the nearest one, in which held points count a thousand times
/// as much as all free ones together.
/// held  numbers of the points that are held
RigidMotion motion_with_held(const Points3& points, const Points3& targets,
                             const std::vector<int>& held);

}  // namespace paperbake
