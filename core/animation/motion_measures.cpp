#include "core/animation/motion_measures.h"

#include "core/geometry/measure.h"
#include "core/geometry/rigid_motion.h"

#include <algorithm>
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

const PositionConstraint* constraint_of(int vertex, const PositionConstraints& held) {
  const auto found = std::find_if(held.begin(), held.end(), [vertex](const PositionConstraint& c) {
    return c.vertex == vertex;
  });
  return found == held.end() ? nullptr : &*found;
}

double max_displacement(const Sheet& sheet, const StepInput& now,
                        const PositionConstraints& held_before, const Points3& before) {
  const PositionConstraints& held = now.constraints;
  if (vertices_of(held) != vertices_of(held_before)) return std::numeric_limits<double>::infinity();
  double most = held.empty() ? 0 : max_row_norm(targets_of(held) - targets_of(held_before));
  most = std::max(most, farthest_move(now.colliders.from, now.colliders.to));
  if (before.rows() != sheet.x.rows()) return std::numeric_limits<double>::infinity();
  return std::max(most, max_row_norm(sheet.x - before));
}

double farthest_target_move(const PositionConstraints& before, const PositionConstraints& now) {
  double most = 0;
  for (const PositionConstraint& c : now)
    if (const PositionConstraint* was = constraint_of(c.vertex, before))
      most = std::max(most, (c.target - was->target).norm());
  return most;
}

bool lets_go(const PositionConstraints& before, const PositionConstraints& now) {
  return std::any_of(before.begin(), before.end(), [&](const PositionConstraint& c) {
    return constraint_of(c.vertex, now) == nullptr;
  });
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
  if (held.empty()) return 0;
  Points3 from(held.size(), 3), to(held.size(), 3);
  for (std::size_t k = 0; k < held.size(); ++k) {
    const PositionConstraint* was = constraint_of(held[k].vertex, held_before);
    from.row(k) = was ? was->target : Vector3d(sheet.x.row(held[k].vertex));
    to.row(k) = held[k].target;
  }
  if (max_row_norm(moved(nearest_rigid_motion(from, to), from) - to) <= rounding_of_handles)
    return 0;
  const Points3 moves = to - from;
  return max_row_norm(moves.rowwise() - moves.colwise().mean().eval());
}

double rms_deformation(const Points3& before, const Points3& now) {
  if (before.rows() != now.rows() || now.rows() == 0) return 0;
  const Points3 carried = moved(nearest_rigid_motion(before, now), before);
  return rms_distance(now, carried);
}

double squeeze(const Points3& x, const ColliderMotion& moving) {
  if (moving.from == moving.to) return 0;
  std::vector<double> within;
  for (std::size_t c = 0; c < moving.from.size(); ++c)
    within.push_back(farthest_move(*moving.from[c], *moving.to[c]) + collider_dhat);
  std::vector<Vector3d> touched, there;
  for (int v = 0; v < x.rows(); ++v) {
    const Vector3d p = x.row(v);
    for (std::size_t c = 0; c < moving.from.size(); ++c) {
      const Collider& from = *moving.from[c];
      if (from.nearest(p, collider_dhat, 1).triangle < 0) continue;
      touched.push_back(p);
      there.push_back(carried(from, *moving.to[c], p, within[c], 1));
      break;
    }
  }
  if (touched.size() < 3) return 0;
  Points3 before(touched.size(), 3), now(touched.size(), 3);
  for (std::size_t k = 0; k < touched.size(); ++k) {
    before.row(k) = touched[k];
    now.row(k) = there[k];
  }
  return rms_deformation(before, now);
}

}  // namespace paperbake
