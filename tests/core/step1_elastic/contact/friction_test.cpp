// Coulomb friction between layers of paper.

#include "core/step1_elastic/contact/friction.h"
#include "core/step1_elastic/contact/sheet_contact.h"
#include "core/step1_elastic/elastic.h"
#include "tests/core/test_meshes.h"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <numeric>

namespace paperbake {
namespace {

constexpr double g = 9.81, dhat = 1e-3, dt = 1 / 96.0;

TEST(FrictionTest, MollifierHasTheRightDerivativesAndFullFrictionBeyondEpsilon) {
  const double epsilon = 1e-6;
  for (const double y : {1e-7, 5e-7, 9.9e-7, 1.01e-6, 1e-5}) {
    const double e = 1e-11;
    EXPECT_NEAR(
        (friction_mollifier(y + e, epsilon).value - friction_mollifier(y - e, epsilon).value) /
            (2 * e),
        friction_mollifier(y, epsilon).slope, 1e-5)
        << y;
    EXPECT_NEAR(
        (friction_mollifier(y + e, epsilon).slope - friction_mollifier(y - e, epsilon).slope) /
            (2 * e),
        friction_mollifier(y, epsilon).second, 1e-4 / epsilon)
        << y;
  }
  EXPECT_EQ(friction_mollifier(2e-6, epsilon).slope, 1);
}

/// One sheet over another, and the effect of their contact when they move from `start`.
struct Layers {
  Points2 pattern;
  Triangles triangles;
  Points3 start;
  std::vector<int> of_vertex;
  std::vector<std::pair<int, int>> all;
  std::vector<int> blocks;

  Layers(const Sheet& low, const Sheet& high)
      : pattern(low.x.rows() + high.x.rows(), 2),
        triangles(low.triangles.rows() + high.triangles.rows(), 3),
        start(pattern.rows(), 3),
        of_vertex(pattern.rows(), 0),
        blocks(pattern.rows()) {
    const int n = static_cast<int>(low.x.rows());
    pattern << low.pattern, high.pattern;
    triangles << low.triangles, (high.triangles.array() + n).matrix();
    start << low.x, high.x;
    std::fill(of_vertex.begin() + n, of_vertex.end(), 1);
    std::iota(blocks.begin(), blocks.end(), 0);
    for (int i = 0; i < start.rows(); ++i)
      for (int j = 0; j < i; ++j) all.emplace_back(i, j);
  }

  SheetContact contact(double mu_low, double mu_high) const {
    SheetContact contact(pattern, triangles,
                         {of_vertex, Eigen::MatrixXd::Constant(2, 2, dhat), {}, {mu_low, mu_high}});
    contact.begin(start, {});
    return contact;
  }
  /// [N] What friction adds to the forces at y.
  Points3 friction_at(const Points3& y, double mu_low = 0.4, double mu_high = 0.4) const {
    Points3 with = Points3::Zero(y.rows(), 3), without = with;
    contact(mu_low, mu_high).differentiate(y, with, nullptr);
    contact(0, 0).differentiate(y, without, nullptr);
    return with - without;
  }
  Points3 turned(const Vector3d& by) const {
    return start * Eigen::AngleAxisd(by.norm(), by.normalized()).toRotationMatrix().transpose();
  }
};

/// Two rumpled sheets.
Layers rumpled() {
  Sheet low = test::hex_sheet(0.1, 0.1, 6, 0.2, 1), high = test::hex_sheet(0.08, 0.08, 5, 0.2, 2);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> noise(-1e-4, 1e-4);
  high.x.col(2).array() += 6e-4;
  for (Sheet* s : {&low, &high})
    for (int v = 0; v < s->x.rows(); ++v)
      s->x.row(v) += Eigen::RowVector3d(0.1 * noise(random), 0.1 * noise(random), noise(random));
  return {low, high};
}

Sheet triangle(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  Sheet sheet = test::flat_sheet((Points2(3, 2) << 0, 0, 1, 0, 0, 1).finished(),
                                 (Triangles(1, 3) << 0, 1, 2).finished());
  sheet.x << a.transpose(), b.transpose(), c.transpose();
  return sheet;
}

/// A corner of a triangle over the inside of another triangle; and an edge across the ridge of a
/// roof.
std::vector<Layers> single_pairs() {
  const Sheet low = triangle({-0.05, -0.04, 0}, {0.06, -0.05, 0}, {0.01, 0.07, 0}),
              roof = triangle({-0.05, 0, 0}, {0.05, 0, 0}, {0, 0.01, -0.05});
  return {{low, triangle({0.004, 0.003, 6e-4}, {0.02, 0.03, 0.05}, {-0.02, 0.02, 0.05})},
          {roof, triangle({0.01, -0.05, 6e-4}, {0.02, 0.04, 6e-4}, {0.02, 0.01, 0.05})}};
}

TEST(FrictionTest, GradientAndHessianMatchTheEnergyAndTheHessianIsNeverIndefinite) {
  const Layers layers = rumpled();
  SheetContact contact = layers.contact(0.4, 0.3);
  BlockCholesky matrix(static_cast<int>(layers.start.rows()), layers.all);
  contact.bind(matrix, layers.blocks);
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const auto any = [&] {
    return Points3(Points3::NullaryExpr(layers.start.rows(), 3, [&] { return normal(random); }));
  };
  const Points3 y = layers.start + 0.4 * sticking_shear * any();  // some stick, some slide
  const auto differentiated = [&](const Points3& at) {
    Points3 gradient = Points3::Zero(y.rows(), 3);
    matrix.set_zero();
    contact.differentiate(at, gradient, &matrix);
    return gradient;
  };
  const Points3 gradient = differentiated(y);
  const Eigen::MatrixXd second = matrix.dense();
  ASSERT_GT(layers.friction_at(y).norm(), 0.1);
  SheetContact smooth = layers.contact(0, 0);
  smooth.bind(matrix, layers.blocks);
  matrix.set_zero();
  Points3 unused = Points3::Zero(y.rows(), 3);
  smooth.differentiate(y, unused, &matrix);
  const Eigen::MatrixXd of_friction = second - matrix.dense();
  contact.bind(matrix, layers.blocks);
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(of_friction).eigenvalues().minCoeff(),
            -1e-10 * of_friction.norm());
  for (int k = 0; k < 5; ++k) {
    const Points3 way = any();
    const double e = 1e-10;
    EXPECT_NEAR((contact.energy(y + e * way) - contact.energy(y - e * way)) / (2 * e),
                gradient.cwiseProduct(way).sum(), 1e-4 * gradient.norm());
    const auto rubbing = [&](const Points3& at) {
      return Points3(layers.friction_at(at, 0.4, 0.3));
    };
    const Points3 change = (rubbing(y + e * way) - rubbing(y - e * way)) / (2 * e);
    const Eigen::VectorXd told =
        of_friction * Eigen::Map<const Eigen::VectorXd>(way.data(), way.size());
    EXPECT_LT((Eigen::Map<const Eigen::VectorXd>(change.data(), change.size()) - told).norm(),
              1e-3 * told.norm());
  }
}

TEST(FrictionTest, ForcesAndTorquesOfAPairCancelAndSlidingMeetsFullFriction) {
  for (const Layers& layers : single_pairs()) {
    const SheetContact contact = layers.contact(0.4, 0.4);
    ASSERT_EQ(contact.touching(layers.start), 1);
    Points3 y = layers.start, pressed = Points3::Zero(6, 3);
    y.bottomRows(3).rowwise() += sticking_shear * Eigen::RowVector3d(1, 0.3, 0);
    layers.contact(0, 0).differentiate(layers.start, pressed, nullptr);
    const Points3 force = layers.friction_at(y);
    EXPECT_NEAR(force.bottomRows(3).colwise().sum().norm(),
                0.4 * pressed.bottomRows(3).colwise().sum().norm(), 1e-9);
    EXPECT_LT(force.colwise().sum().norm(), 1e-12 * force.norm());
    Eigen::RowVector3d turn = Eigen::RowVector3d::Zero();
    for (int v = 0; v < 6; ++v) turn += layers.start.row(v).cross(force.row(v));
    EXPECT_LT(turn.norm(), 1e-12 * force.norm());
  }
}

TEST(FrictionTest, RigidMotionMeetsNoFrictionAndZeroOnEitherSheetGivesZero) {
  for (const Layers& layers : single_pairs())
    for (const Vector3d& by : {Vector3d(0.2, 0, 0), Vector3d(0, -0.2, 0), Vector3d(0, 0, 1)}) {
      const Points3 y = layers.turned(by).rowwise() + Eigen::RowVector3d(0.1, 0.2, 0.3);
      EXPECT_LT(layers.friction_at(y).norm(), 1e-9) << by.transpose();
    }
  const Layers layers = rumpled();
  Points3 y = layers.start;
  y.bottomRows(36).col(0).array() += 1e-4;
  const double whole = layers.friction_at(y, 0.4, 0.4).norm();
  ASSERT_GT(whole, 0.1);
  EXPECT_EQ(layers.friction_at(y, 0.4, 0).norm(), 0);
  EXPECT_NEAR(layers.friction_at(y, 0.4, 0.1).norm(), 0.5 * whole, 1e-9);
}

/// A leaf lying on a sheet of this slope that is held everywhere. To be stepped.
struct Leaf {
  Sheet low = test::hex_sheet(0.12, 0.09, 9, 0.2, 1), leaf = test::hex_sheet(0.05, 0.05, 5, 0.2, 2);
  Eigen::Matrix3d turn;
  StepInput everywhere, own;
  Elastic of_low, of_leaf;

  static Paper paper(double mu) {
    Paper paper;
    paper.friction = mu;
    return paper;
  }
  static ElasticOptions options(Inertia inertia, int number) {
    ElasticOptions options;
    options.forces.gravity = g;
    options.inertia = inertia;
    options.stop = 1e-7;  // a hundredth of what it slides in a step
    options.sheet_number = number;
    return options;
  }

  Leaf(double slope, double mu, Inertia inertia)
      : turn(Eigen::AngleAxisd(std::atan(slope), Vector3d::UnitY()).toRotationMatrix().transpose()),
        of_low(paper(mu), options(inertia, 0)),
        of_leaf(paper(mu), options(inertia, 1)) {
    leaf.x.rowwise() += Eigen::RowVector3d(0.02, 0.02, 0.99 * dhat);
    low.x = (low.x * turn).eval();
    leaf.x = (leaf.x * turn).eval();
    for (int v = 0; v < low.x.rows(); ++v) everywhere.constraints.push_back({v, low.x.row(v)});
    of_low.set_mesh(low);
    of_leaf.set_mesh(leaf);
  }

  void step() {
    const Points3 none(0, 3);
    Elastic::step_together({{of_low, low, everywhere, none}, {of_leaf, leaf, own, none}},
                           Eigen::MatrixXd::Constant(2, 2, dhat), dt);
  }
};

/// [m/s] Downhill speeds after an eighth and a quarter of a second.
std::pair<double, double> speeds(double slope, double mu) {
  Leaf leaf(slope, mu, Inertia::dynamic);
  const auto down = [&] { return leaf.leaf.v.colwise().mean().dot(leaf.turn.row(0)); };
  double half_way = 0;
  for (int k = 0; k < 24; ++k) {
    leaf.step();
    if (k == 11) half_way = down();
  }
  return {half_way, down()};
}

TEST(FrictionTest, ALeafSticksBelowItsFrictionAngleAndSlidesAboveItAsCoulombSays) {
  const double damping = -24 * std::log(0.98);
  for (const double slope : {0.3, 0.37, 0.39}) EXPECT_LT(speeds(slope, 0.4).second, 1e-5) << slope;
  for (const double mu : {0.0, 0.4}) {
    const auto [before, after] = speeds(0.6, mu);
    const double angle = std::atan(0.6), a = g * (std::sin(angle) - mu * std::cos(angle)) -
                                             damping * 0.5 * (before + after);
    EXPECT_NEAR((after - before) / 0.125, a, 0.05 * a) << mu;
  }
}

// With friction that begins anew in every step, it would go 1 um each time.
TEST(FrictionTest, ALeafOnASlopeDoesNotCreep) {
  for (const Inertia inertia : {Inertia::dynamic, Inertia::quasi_static}) {
    Leaf leaf(std::tan(20 * M_PI / 180), 0.4, inertia);
    for (int k = 0; k < 48; ++k) leaf.step();
    const Points3 then = leaf.leaf.x;
    for (int k = 0; k < 240; ++k) leaf.step();
    EXPECT_LT((leaf.leaf.x - then).rowwise().norm().maxCoeff(), 1e-6);
  }
}

TEST(FrictionTest, AStepThatIsUndoneLeavesNoShearBehind) {
  Leaf leaf(0.3, 0.4, Inertia::dynamic);
  for (int k = 0; k < 12; ++k) leaf.step();
  const Sheet then = leaf.leaf, low = leaf.low;
  const SolverState state = leaf.of_leaf.state(), of_low = leaf.of_low.state();
  leaf.step();
  const Points3 once = leaf.leaf.x;
  leaf.leaf = then;
  leaf.low = low;
  leaf.of_leaf.restore(state);
  leaf.of_low.restore(of_low);
  leaf.step();
  EXPECT_TRUE(once == leaf.leaf.x);  // to the last bit
}

TEST(FrictionHistoryTest, IsReadAsItWasWritten) {
  FrictionHistory history;
  const TouchingFeatures pair{{0, 1}, {3, 4, 5, 6}}, on_collider{{-1, -2}, {7, -1, -1, 0}};
  history.remember(pair, {1e-6, 2e-6, 3e-6});
  history.remember(on_collider, {-1e-6, 0, 0});
  Serializer written;
  history.archive(written);
  FrictionHistory again;
  Serializer bytes(written.bytes());
  again.archive(bytes);
  EXPECT_EQ(again.shear(pair), Vector3d(1e-6, 2e-6, 3e-6));
  EXPECT_EQ(again.shear(on_collider), Vector3d(-1e-6, 0, 0));
  EXPECT_EQ(again.shear({{0, 1}, {3, 4, 5, 7}}), Vector3d(0, 0, 0));
}

TEST(FrictionTest, ALeafPulledByASoftHandleStartsToSlideAtTheForceOfCoulombsLaw) {
  constexpr double stiffness = 0.5;  // [N/m]
  Leaf leaf(0, 0.4, Inertia::quasi_static);
  const double lag = 0.4 * Paper{}.area_density * 0.05 * 0.05 * g / stiffness;  // [m] 1.4 mm
  int front = 0;
  for (int v = 0; v < leaf.leaf.x.rows(); ++v)
    if ((leaf.leaf.pattern.row(v) - Eigen::RowVector2d(0.05, 0.025)).norm() <
        (leaf.leaf.pattern.row(front) - Eigen::RowVector2d(0.05, 0.025)).norm())
      front = v;
  leaf.own.constraints = {{front, leaf.leaf.x.row(front), stiffness}};
  Vector3d& target = leaf.own.constraints.front().target;
  const Points3 start = leaf.leaf.x;
  for (int k = 1; k <= 60; ++k) {
    target = start.row(front).transpose() + Vector3d(k * 1e-4, 0, 0);
    leaf.step();
    const double gone = (leaf.leaf.x - start).col(0).mean(),
                 behind = target.x() - leaf.leaf.x(front, 0);
    if (k * 1e-4 < 0.9 * lag) {
      EXPECT_LT(gone, sticking_shear) << k;  // it does not creep
    }
    if (k * 1e-4 > 1.5 * lag) {
      EXPECT_NEAR(behind, lag, 0.03 * lag) << k;
    }
  }
}

}  // namespace
}  // namespace paperbake
