#pragma once

#include "core/geometry/rigid_motion.h"
#include "core/model/paper.h"
#include "core/model/sheet.h"

#include <optional>
#include <vector>

namespace paperbake {

class Serializer;

/// A vertex that a handle holds, and where it is to be at the end of a step. A hard constraint is
/// met exactly as long as the sheet does not touch itself; all others pull with springs
/// (handle_springs.h).
struct PositionConstraint {
  int vertex;
  Vector3d target;       // [m]
  double stiffness = 0;  // [N/m] of a soft constraint; 0: it is hard
  double grip = 1;       // [1] of the force of a hand, if it is hard: grip_on the paper
  bool is_hard() const { return !(stiffness > 0); }
};

/// [1] How firmly a hand holds a sheet, against copy paper: a sheet that is stretched more easily
/// is held by as much less, so that no grade is stretched more by its handles than copy paper.
double grip_on(const Paper&);

/// Constraints of one sheet, each vertex at most once. The same list goes from the handles of an
/// animation to the terms of the solver.
using PositionConstraints = std::vector<PositionConstraint>;

/// Those that are hard, and those that are soft, in the same order.
PositionConstraints hard_constraints(const PositionConstraints&);
PositionConstraints soft_constraints(const PositionConstraints&);

std::vector<int> vertices_of(const PositionConstraints&);

// [m] held vertices whose distances change by less keep them
inline constexpr double rounding_of_handles = 1e-5;

// [1] of the extent of points, across it: what is narrower is in one line, about which it could
// turn; assumed
inline constexpr double min_width = 0.02;

/// The motion that takes the held vertices to their targets as one rigid body; none: they are in
/// one line, a constraint is soft, or a target is more than `slack` [m] off.
/// x  |V|x3 [m] present positions
std::optional<RigidMotion> rigid_motion_of(const Points3& x, const PositionConstraints&,
                                           double slack);

void archive(Serializer&, PositionConstraint&);

}  // namespace paperbake
