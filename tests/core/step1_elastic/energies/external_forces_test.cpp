#include "core/step1_elastic/energies/external_forces.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

TEST(ExternalForcesTest, TheGradientIsTheDerivativeOfTheEnergyAndThePotential) {
  const ExternalForces forces{9.81};
  const Eigen::Vector3d mass(1e-3, 2e-3, 5e-3);  // [kg]
  Points3 x(3, 3);
  x << 0.1, 0.2, 0.3, -0.4, 0.5, 0.6, 0.7, 0.8, -0.9;
  const double step = 1e-3;  // [m] the energy is linear: only rounding is left
  ASSERT_GT(Eigen::RowVector3d(forces.gradient()).norm(), 9);
  EXPECT_DOUBLE_EQ(forces.energy(mass, x), mass.dot(forces.potential(x)));
  for (int v = 0; v < 3; ++v)
    for (int k = 0; k < 3; ++k) {
      Points3 ahead = x, behind = x;
      ahead(v, k) += step;
      behind(v, k) -= step;
      const double slope = (forces.energy(mass, ahead) - forces.energy(mass, behind)) / (2 * step);
      EXPECT_NEAR(slope, mass[v] * Eigen::RowVector3d(forces.gradient())[k], 1e-12);
    }
}

TEST(ExternalForcesTest, WithoutGravityNothingPulls) {
  const Points3 x = Points3::Constant(2, 3, 0.3);
  EXPECT_EQ(ExternalForces{}.energy(Eigen::Vector2d(1, 2), x), 0);
  EXPECT_EQ(Eigen::RowVector3d(ExternalForces{}.gradient()).norm(), 0);
}

}  // namespace
}  // namespace paperbake
