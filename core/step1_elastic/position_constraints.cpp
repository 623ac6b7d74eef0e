#include "core/step1_elastic/position_constraints.h"

#include "core/geometry/principal_axes.h"
#include "core/model/serializer.h"

#include <algorithm>
#include <iterator>

namespace paperbake {

PositionConstraints hard_constraints(const PositionConstraints& all) {
  PositionConstraints hard;
  std::copy_if(all.begin(), all.end(), std::back_inserter(hard),
               [](const PositionConstraint& c) { return c.is_hard(); });
  return hard;
}

PositionConstraints soft_constraints(const PositionConstraints& all) {
  PositionConstraints soft;
  std::copy_if(all.begin(), all.end(), std::back_inserter(soft),
               [](const PositionConstraint& c) { return !c.is_hard(); });
  return soft;
}

std::vector<int> vertices_of(const PositionConstraints& constraints) {
  std::vector<int> vertices;
  vertices.reserve(constraints.size());
  for (const PositionConstraint& c : constraints) vertices.push_back(c.vertex);
  return vertices;
}

double grip_on(const Paper& paper) {
  return std::min(1.0, paper.membrane_stiffness / Paper{}.membrane_stiffness);
}

std::optional<RigidMotion> rigid_motion_of(const Points3& x, const PositionConstraints& constraints,
                                           double slack) {
  if (constraints.size() < 3) return std::nullopt;
  Points3 from(constraints.size(), 3), to(constraints.size(), 3);
  for (std::size_t k = 0; k < constraints.size(); ++k) {
    if (!constraints[k].is_hard()) return std::nullopt;
    from.row(k) = x.row(constraints[k].vertex);
    to.row(k) = constraints[k].target;
  }
  const SymmetricEigen<3> axes = principal_axes(from);
  if (!(axes.values[1] > min_width * min_width * axes.values[2])) return std::nullopt;
  return rigid_motion_between(from, to, slack);
}

void archive(Serializer& a, PositionConstraint& c) { a(c.vertex, c.target, c.stiffness, c.grip); }

}  // namespace paperbake
