#include "core/animation/swing.h"

#include "core/geometry/measure.h"
#include "core/geometry/rigid_motion.h"

#include <Eigen/LU>

#include <cmath>

namespace paperbake {

Swing swing_to(const Sheet& equilibrium, const Points3& from, const std::vector<int>& held,
               double freed, double area_density) {
  const RigidMotion motion = motion_with_held(from, equilibrium.x, held);
  const Points3 move = equilibrium.x - moved(motion, from);
  double action = 0;  // [kg m2]
  for (int t = 0; t < equilibrium.triangles.rows(); ++t) {
    const auto corners = equilibrium.triangles.row(t);
    Eigen::Matrix2d sides;
    for (int i = 0; i < 2; ++i)
      sides.row(i) = equilibrium.pattern.row(corners[i + 1]) - equilibrium.pattern.row(corners[0]);
    const double share = area_density * std::abs(sides.determinant()) / 6;  // [kg] of a corner
    for (int i = 0; i < 3; ++i) action += share * move.row(corners[i]).squaredNorm();
  }
  Swing swing;
  swing.amplitude = max_row_norm(move);
  if (freed > 0 && action > 0) swing.rate = std::sqrt(2 * freed / action);
  return swing;
}

double quarter_period(const Swing& swing) { return 0.5 * M_PI / swing.rate; }

double critical_damping(const Swing& swing, double gravity) {
  return 2 * std::sqrt(1.545 * std::abs(gravity) / swing.amplitude);
}

bool needs_inertia(const Swing& swing, double side) {
  return swing.amplitude > visible_motion * side && swing.rate > 0 && swing.rate < fastest_swing;
}

double still(double side) { return 5e-4 * side; }

}  // namespace paperbake
