#include "core/step1_elastic/energies/air_drag.h"
#include "core/model/segment2.h"

#include "core/step1_elastic/elastic.h"
#include "tests/core/test_meshes.h"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

constexpr double g = 9.81, density = 1.2, across = 1.2;  // [m/s2], [kg/m3], C_d
constexpr double dt = 1 / 96.0;                          // [s]

Paper copy80() {
  Paper paper;
  paper.area_density = 0.08;
  return paper;
}

Wind steady(const Vector3d& v) { return {"wind", v.transpose(), 0, 0}; }

/// A rolled sheet that turns and flies.
Sheet flying_sheet() {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 4);
  sheet.v = Points3::Zero(sheet.x.rows(), 3);
  for (int v = 0; v < sheet.x.rows(); ++v) {
    const double u = sheet.pattern(v, 0), w = sheet.pattern(v, 1);
    sheet.x.row(v) << 0.05 * std::sin(u / 0.05), w, 0.05 * (1 - std::cos(u / 0.05));
    sheet.v.row(v) << 1 - 5 * w, 0.3 + 4 * u, -0.7 + 3 * w;
  }
  return sheet;
}

TEST(AirDragTest, DerivativesMatchTheEnergyAndTheSecondIsNeverIndefinite) {
  const Sheet sheet = flying_sheet();
  const AirDrag drag({density, {steady({2, 1, 0.5})}}, sheet, dt, 0);
  const int n = static_cast<int>(sheet.x.rows());
  std::vector<std::pair<int, int>> coupled;
  std::vector<int> block_of;
  for (int i = 0; i < n; ++i) {
    block_of.push_back(i);
    for (int j = i + 1; j < n; ++j) coupled.emplace_back(i, j);
  }
  BlockCholesky matrix(n, coupled);
  const auto at = [&](const Points3& x, Points3& gradient) {
    matrix.set_zero();
    gradient = Points3::Zero(n, 3);
    return drag.differentiate(x, block_of, gradient, matrix);
  };
  Points3 gradient, ahead, behind;
  const double step = 1e-6;
  EXPECT_EQ(at(sheet.x, gradient), drag.energy(sheet.x));
  ASSERT_GT(gradient.norm(), 1e-3);  // [N] the air pushes
  const Eigen::MatrixXd second = matrix.dense();
  const Eigen::MatrixXd whole = second.selfadjointView<Eigen::Upper>();
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(whole).eigenvalues().minCoeff(),
            -1e-12 * whole.norm());
  for (int v = 0; v < n; v += 7)
    for (int k = 0; k < 3; ++k) {
      Points3 x = sheet.x;
      x(v, k) += step;
      at(x, ahead);
      const double up = drag.energy(x);
      x(v, k) -= 2 * step;
      at(x, behind);
      EXPECT_NEAR((up - drag.energy(x)) / (2 * step), gradient(v, k), 1e-6 * gradient.norm());
      const Eigen::Matrix<double, -1, -1, Eigen::RowMajor> change = (ahead - behind) / (2 * step);
      const Eigen::VectorXd column = Eigen::Map<const Eigen::VectorXd>(change.data(), 3 * n);
      EXPECT_LT((column - whole.col(3 * v + k)).norm(), 1e-6 * whole.norm());
    }
}

TEST(AirDragTest, StillAirNeverDoesWorkOnASheet) {
  const Sheet sheet = flying_sheet();
  const AirDrag drag({density}, sheet, dt, 0);
  double most = 0;
  for (unsigned k = 0; k < 50; ++k) {
    srand(k);
    const Points3 u = Points3::Random(sheet.x.rows(), 3);  // [m/s]
    // W(x0 + s dt u) is s^2 times a number that is not negative: force and way are opposed
    const double w = drag.energy(sheet.x + dt * u);
    EXPECT_GE(w, 0);
    EXPECT_NEAR(drag.energy(sheet.x + 2 * dt * u), 4 * w, 1e-9 * w);
    most = std::max(most, w);
  }
  EXPECT_GT(most, 1e-6);
}

/// Energy of a sheet that moves without weight. [J]
double energy_of(Elastic& elastic, const Paper& paper, const Sheet& sheet) {
  double kinetic = 0;
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    const Vector2d a = sheet.pattern.row(sheet.triangles(t, 0)),
                   b = sheet.pattern.row(sheet.triangles(t, 1)),
                   c = sheet.pattern.row(sheet.triangles(t, 2));
    const double area = 0.5 * std::abs(cross(b - a, c - a));
    for (int i = 0; i < 3; ++i)
      kinetic += paper.area_density * area / 6 * sheet.v.row(sheet.triangles(t, i)).squaredNorm();
  }
  return kinetic + elastic.evaluate_energies(sheet).energy;
}

TEST(AirDragTest, InStillAirASheetOnlyLosesEnergy) {
  const Paper paper = copy80();
  Sheet sheet = flying_sheet();
  ElasticOptions options;
  options.inertia = Inertia::dynamic;
  options.air.density = density;
  Elastic elastic(paper, options);
  elastic.set_mesh(sheet);
  const double begun = energy_of(elastic, paper, sheet);
  double before = begun;
  for (int k = 0; k < 48; ++k) {
    ASSERT_TRUE(elastic.step(sheet, {}, dt).converged) << k;
    const double now = energy_of(elastic, paper, sheet);
    EXPECT_LT(now, before * (1 + 1e-9)) << "step " << k;
    before = now;
  }
  EXPECT_LT(before, 0.3 * begun);
}

TEST(AirDragTest, ALevelSheetFallsAtItsTerminalSpeed) {
  const Paper paper = copy80();
  Sheet sheet = test::hex_sheet(0.1, 0.1, 4);
  sheet.v = Points3::Zero(sheet.x.rows(), 3);
  ElasticOptions options;
  options.inertia = Inertia::dynamic;
  options.forces.gravity = g;
  options.air.density = density;
  Elastic elastic(paper, options);
  elastic.set_mesh(sheet);
  for (int k = 0; k < 96; ++k) elastic.step(sheet, {}, dt);
  const double terminal = std::sqrt(2 * paper.area_density * g / (density * across));
  EXPECT_NEAR(-sheet.v.col(2).mean(), terminal, 0.005 * terminal);
}

TEST(AirDragTest, ASheetThatGlidesAlongItselfIsSlowedByItsLaminarBoundaryLayer) {
  const Paper paper = copy80();
  constexpr double viscosity = 1.81e-5, seconds = 0.5;  // [Pa s]
  for (const double length : {0.1, 0.4})
    for (const double speed : {1.0, 5.0}) {
      Sheet sheet = test::hex_sheet(length, 0.1, 4);
      sheet.v = Points3::Zero(sheet.x.rows(), 3);
      sheet.v.col(0).setConstant(speed);
      ElasticOptions options;
      options.inertia = Inertia::dynamic;
      options.air.density = density;
      Elastic elastic(paper, options);
      elastic.set_mesh(sheet);
      for (int k = 0; k < 96 * seconds; ++k) elastic.step(sheet, {}, dt);
      // m dv/dt = -rho/2 A C_f v^2 with C_f = 2.656 sqrt(nu/(v l)):  v^-1/2 = v0^-1/2 + k t/2
      const double k =
          0.5 * density * 2.656 * std::sqrt(viscosity / (density * length)) / paper.area_density;
      const double root = 1 / std::sqrt(speed) + k * seconds / 2;
      const double expected = 1 / (root * root);
      EXPECT_NEAR(sheet.v.col(0).mean(), expected, 0.01 * (speed - expected))
          << length << " m, " << speed << " m/s";
    }
}

TEST(AirDragTest, FrictionOnASheetThatFallsLevelIsThatOfItsWholeSpeed) {
  // its small motion sideways would have a far thicker boundary layer
  constexpr double side = 0.2, fall = 1, sideways = 0.01;  // [m], [m/s]
  Sheet sheet = test::hex_sheet(side, side, 4);
  sheet.v = Points3::Zero(sheet.x.rows(), 3);
  sheet.v.col(0).setConstant(sideways);
  sheet.v.col(2).setConstant(-fall);
  Air air;
  air.density = density;
  const AirDrag drag(air, sheet, dt, dt);
  const double push = 1e-6;  // [m]
  Points3 ahead = sheet.x + dt * sheet.v, behind = ahead;
  ahead.col(0).array() += push;
  behind.col(0).array() -= push;
  const double force = (drag.energy(ahead) - drag.energy(behind)) / (2 * push);
  const double friction = 2.656 / std::sqrt(density * fall * side / 1.81e-5);
  const double expected = density / 2 * side * side * fall * friction * sideways;
  EXPECT_NEAR(force, expected, 0.01 * expected);
}

/// [rad] from the vertical: angle at which a stiff strip of 0.1 m that hangs from its upper edge
/// rests in a horizontal wind.
double angle_in_wind(const Paper& paper, double speed) {
  Sheet sheet = test::hex_sheet(0.1, 0.03, 6);
  for (int v = 0; v < sheet.x.rows(); ++v)
    sheet.x.row(v) << 1e-4 * sheet.pattern(v, 0), sheet.pattern(v, 1), -sheet.pattern(v, 0);
  sheet.v = Points3::Zero(sheet.x.rows(), 3);
  PositionConstraints held;
  for (int v = 0; v < sheet.x.rows(); ++v)
    if (sheet.pattern(v, 0) < 1e-9) held.push_back({v, sheet.x.row(v).transpose()});
  ElasticOptions options;
  options.inertia = Inertia::dynamic;
  options.forces.gravity = g;
  options.air = {density, {steady({speed, 0, 0})}};
  Elastic elastic(paper, options);
  elastic.set_mesh(sheet);
  for (int k = 0; k < 400; ++k) elastic.step(sheet, {held}, 1 / 48.0);
  Vector3d end = Vector3d::Zero();
  int n = 0;
  for (int v = 0; v < sheet.x.rows(); ++v)
    if (sheet.pattern(v, 0) > 0.1 - 1e-9) {
      end += sheet.x.row(v).transpose();
      ++n;
    }
  return std::atan2(end.x() / n, -end.z() / n);
}

TEST(AirDragTest, AStripInWindStandsOffAtTheAngleOfClosedForm) {
  Paper card = copy80();
  card.bending_stiffness *= 1000;  // it stays straight
  for (const double speed : {0.5, 1.0, 2.0}) {
    // moments about the edge: weight at the middle, pressure at 1/4 + sin(alpha)/4 of the depth,
    // alpha = 90 degrees - theta:  tan(theta) = rho C_d v^2/(2 m g) (1 + cos(theta))/2
    const double ratio = density * across * speed * speed / (2 * card.area_density * g);
    double theta = 0;
    for (int k = 0; k < 100; ++k) theta = std::atan(ratio * (1 + std::cos(theta)) / 2);
    EXPECT_NEAR(angle_in_wind(card, speed), theta, 0.02 * theta) << speed << " m/s";
  }
}

/// [s] until a sheet of A4 that is let go at 25 degrees has fallen by a metre.
double time_of_a_metre(double air, double& turned) {
  const Paper paper = copy80();
  Sheet sheet = test::hex_sheet(0.297, 0.21, 5);
  const double tilt = 25 * M_PI / 180;
  for (int v = 0; v < sheet.x.rows(); ++v)
    sheet.x.row(v) << std::cos(tilt) * sheet.pattern(v, 0), sheet.pattern(v, 1),
        -std::sin(tilt) * sheet.pattern(v, 0);
  sheet.v = Points3::Zero(sheet.x.rows(), 3);
  ElasticOptions options;
  options.inertia = Inertia::dynamic;
  options.forces.gravity = g;
  options.air.density = air;
  Elastic elastic(paper, options);
  elastic.set_mesh(sheet);
  const double from = sheet.x.col(2).mean();
  turned = 0;
  for (int k = 1; k < 400; ++k) {
    elastic.step(sheet, {}, dt);
    const Vector3d a = sheet.x.row(sheet.triangles(0, 0)), b = sheet.x.row(sheet.triangles(0, 1)),
                   c = sheet.x.row(sheet.triangles(0, 2)), n = (b - a).cross(c - a).normalized();
    const double angle = std::atan2(n.x(), n.z());
    turned = std::max(turned, std::abs(angle - tilt));
    if (from - sheet.x.col(2).mean() >= 1) return k * dt;
  }
  return 400 * dt;
}

TEST(AirDragTest, ASheetLetGoAtAnAngleFluttersAndTakesTwiceTheTimeOfAVacuum) {
  double turned_in_air, turned;
  const double air = time_of_a_metre(density, turned_in_air), vacuum = time_of_a_metre(0, turned);
  EXPECT_NEAR(vacuum, std::sqrt(2 / g), 0.03);  // damped, and in steps
  EXPECT_GT(air, 2 * vacuum);
  EXPECT_LT(turned, 0.01);
  EXPECT_GT(turned_in_air, 0.5);  // [rad]
}

TEST(AirTest, AWindFollowsItsKeysAndItsGustsTravelWithIt) {
  Wind keyed{"wind", Points3(2, 3), 0, 0};
  keyed.velocity << 2, 0, 0, 0, 4, 0;
  Air air{density, {keyed}, 24};
  EXPECT_LT((air_velocity(air, 0.5 / 24, {}) - Vector3d(1, 2, 0)).norm(), 1e-12);
  EXPECT_LT((air_velocity(air, 9, {}) - Vector3d(0, 4, 0)).norm(), 1e-12);
  EXPECT_LT((air_velocity(air, -1, {}) - Vector3d(2, 0, 0)).norm(), 1e-12);

  Wind gusty = steady({2, 0, 0});
  gusty.gust = 0.3;
  air.winds = {gusty};
  double sum = 0, squares = 0;
  constexpr int samples = 20000;
  for (int k = 0; k < samples; ++k) {
    const double v = air_velocity(air, 0.01 * k, Vector3d::Zero()).x();
    sum += v / samples;
    squares += v * v / samples;
  }
  EXPECT_NEAR(sum, 2, 0.02);
  EXPECT_NEAR(std::sqrt(squares - sum * sum), 0.6, 0.02);
  // half a metre downwind a quarter of a second later
  EXPECT_NEAR(air_velocity(air, 1, {0, 0, 0}).x(), air_velocity(air, 1.25, {0.5, 0, 0}).x(), 1e-9);
  gusty.seed = 1;
  EXPECT_NE(air_velocity(air, 1, {0, 0, 0}), air_velocity({density, {gusty}}, 1, {0, 0, 0}));
}

}  // namespace
}  // namespace paperbake
