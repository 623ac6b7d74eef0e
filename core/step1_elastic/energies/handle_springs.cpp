#include "core/step1_elastic/energies/handle_springs.h"

#include "core/step1_elastic/energies/membrane.h"

#include <limits>

namespace paperbake {
namespace {

constexpr double hard = 3e4;         // [N/m] a tenth of what paper itself resists with
constexpr double yield_force = 0.3;  // [N]
constexpr double yielding = 300;     // [N/m]

}  // namespace

HandleSpring soft_spring(int vertex, const Vector3d& target, double stiffness) {
  return {vertex, target, stiffness, std::numeric_limits<double>::infinity()};
}

HandleSpring yielding_spring(int vertex, const Vector3d& target) {
  return {vertex, target, hard, yield_force};
}

HardConstraints hard_handles(const PositionConstraints& held) {
  HardConstraints hard{{}, Points3(held.targets.rows(), 3)};
  for (std::size_t k = 0; k < held.vertices.size(); ++k) {
    if (!held.stiffness.empty() && held.stiffness[k] > 0) continue;
    hard.targets.row(hard.vertices.size()) = held.targets.row(k);
    hard.vertices.push_back(held.vertices[k]);
  }
  hard.targets.conservativeResize(hard.vertices.size(), 3);
  return hard;
}

std::vector<HandleSpring> handle_springs(const PositionConstraints& held, HardHandles hard) {
  std::vector<HandleSpring> springs;
  for (std::size_t k = 0; k < held.vertices.size(); ++k) {
    const double soft = held.stiffness.empty() ? 0 : held.stiffness[k];
    if (soft > 0)
      springs.push_back(soft_spring(held.vertices[k], held.targets.row(k), soft));
    else if (hard == HardHandles::may_yield)
      springs.push_back(yielding_spring(held.vertices[k], held.targets.row(k)));
  }
  return springs;
}

bool yields(const HandleSpring& s, const Points3& x) {
  return (x.row(s.vertex).transpose() - s.target).norm() * s.stiffness > s.yield_force;
}

double energy(const std::vector<HandleSpring>& springs, const Points3& x) {
  double sum = 0;
  for (const HandleSpring& s : springs) {
    const double r = (x.row(s.vertex).transpose() - s.target).norm(),
                 r0 = s.yield_force / s.stiffness, beyond = r - r0;
    sum += beyond <= 0 ? 0.5 * s.stiffness * r * r
                       : 0.5 * s.yield_force * r0 + s.yield_force * beyond +
                             0.5 * yielding * beyond * beyond;
  }
  return sum;
}

double differentiate(const std::vector<HandleSpring>& springs, const Points3& x,
                     const std::vector<int>& block_of, Points3& gradient, BlockCholesky& matrix) {
  for (const HandleSpring& s : springs) {
    const Vector3d d = x.row(s.vertex).transpose() - s.target;
    const double r = d.norm(), beyond = r - s.yield_force / s.stiffness;
    // second derivative across and along the way to the target
    double across = s.stiffness, along = s.stiffness;
    if (beyond > 0) across = (s.yield_force + yielding * beyond) / r, along = yielding;
    gradient.row(s.vertex) += across * d.transpose();
    Matrix3 second = across * Matrix3::Identity();
    if (beyond > 0) second += (along - across) / (r * r) * d * d.transpose();
    matrix.add(matrix.slot(block_of[s.vertex], block_of[s.vertex]), second);
  }
  return energy(springs, x);
}

}  // namespace paperbake
