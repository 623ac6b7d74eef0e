#include "core/step1_elastic/energies/handle_springs.h"

#include <limits>

namespace paperbake {
namespace {

// of copy paper
constexpr double hard = 3e4;              // [N/m] a tenth of the stiffness of paper itself
constexpr double hold_force = 3;          // [N] a hand holds paper by this
constexpr double stiffness_beyond = 300;  // [N/m]

struct Spring {
  double stiffness;         // [N/m] k
  double hold_force;        // [N] F0
  double stiffness_beyond;  // [N/m] k_y
};

// not inlined: a sum of constants would round otherwise than the same sum of variables
[[gnu::noinline]] Spring spring_of(const PositionConstraint& c) {
  return c.is_hard() ? Spring{c.grip * hard, c.grip * hold_force, c.grip * stiffness_beyond}
                     : Spring{c.stiffness, std::numeric_limits<double>::infinity(), 0};
}

}  // namespace

bool gives_way(const PositionConstraint& c, const Points3& x) {
  const Spring s = spring_of(c);
  return (x.row(c.vertex).transpose() - c.target).norm() * s.stiffness > s.hold_force;
}

double spring_energy(const PositionConstraints& constraints, const Points3& x) {
  double sum = 0;
  for (const PositionConstraint& c : constraints) {
    const Spring s = spring_of(c);
    const double r = (x.row(c.vertex).transpose() - c.target).norm(),
                 r0 = s.hold_force / s.stiffness, beyond = r - r0;
    sum += beyond <= 0 ? 0.5 * s.stiffness * r * r
                       : 0.5 * s.hold_force * r0 + s.hold_force * beyond +
                             0.5 * s.stiffness_beyond * beyond * beyond;
  }
  return sum;
}

double differentiate_springs(const PositionConstraints& constraints, const Points3& x,
                             const std::vector<int>& block_of, Points3& gradient,
                             BlockCholesky& matrix) {
  for (const PositionConstraint& c : constraints) {
    const Spring s = spring_of(c);
    const Vector3d d = x.row(c.vertex).transpose() - c.target;
    const double r = d.norm(), beyond = r - s.hold_force / s.stiffness;
    // second derivative across and along the direction to the target
    double across = s.stiffness, along = s.stiffness;
    if (beyond > 0) {
      across = (s.hold_force + s.stiffness_beyond * beyond) / r;
      along = s.stiffness_beyond;
    }
    gradient.row(c.vertex) += across * d.transpose();
    Matrix3d second = across * Matrix3d::Identity();
    if (beyond > 0) second += (along - across) / (r * r) * d * d.transpose();
    matrix.add(matrix.slot(block_of[c.vertex], block_of[c.vertex]), second);
  }
  return spring_energy(constraints, x);
}

}  // namespace paperbake
