#include "core/step1_elastic/position_constraints.h"

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

void archive(Serializer& a, PositionConstraint& c) { a(c.vertex, c.target, c.stiffness); }

}  // namespace paperbake
