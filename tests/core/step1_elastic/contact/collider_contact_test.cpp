#include "core/step1_elastic/contact/collider_contact.h"

#include "core/step1_elastic/elastic.h"
#include "tests/core/collider_meshes.h"
#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace paperbake {
namespace {

using test::all;
using test::ball;
using test::bin;
using test::box;
using test::ground;
using test::hex_sheet;

constexpr double g = 9.81;

Triangles one_triangle() {
  Triangles one(1, 3);
  one << 0, 1, 2;
  return one;
}

StepInput resting(const Colliders& colliders) {
  return {{}, {shapes_at(colliders, 0), shapes_at(colliders, 0)}};
}

TEST(ColliderContactTest, BarrierSlopesAreDerivativesAndTheLawContinuesInside) {
  for (const double d : {4.9e-4, 3e-4, 1.01e-4, 9.9e-5, 1e-5, -1e-4, -2e-3}) {
    const double e = 1e-9,
                 rise = (collider_barrier(d + e).value - collider_barrier(d - e).value) / (2 * e),
                 bend = (collider_barrier(d + e).slope - collider_barrier(d - e).slope) / (2 * e);
    EXPECT_NEAR(rise, collider_barrier(d).slope, 1e-5 * std::abs(collider_barrier(d).slope)) << d;
    EXPECT_NEAR(bend, collider_barrier(d).second, 1e-5 * collider_barrier(d).second) << d;
  }
  EXPECT_EQ(collider_barrier(collider_dhat).slope, 0);
  EXPECT_LT(collider_barrier(-1e-4).slope, -1.5);  // [N] more than paper presses on one vertex
}

/// Energy of a sheet of one triangle at a collider without friction.
double energy_of_one(ColliderMesh mesh, const Points3& y) {
  mesh.friction = 0;
  const auto colliders = all({mesh});
  ColliderContact contact(colliders, one_triangle(), 3);
  contact.begin(y, {shapes_at(*colliders, 0), shapes_at(*colliders, 0)}, {});
  return contact.energy(y);
}

TEST(ColliderContactTest, ALargeTriangleFeelsEveryCornerOfAFineBall) {
  const ColliderMesh mesh = ball(0.05, 20, 40);
  Points3 y(3, 3);
  y << -0.2, -0.15, 0, 0.2, -0.15, 0, 0, 0.3, 0;
  for (const double height : {1e-4, 3e-4}) {
    y.col(2).setConstant(0.05 + height);
    double expected = 0;
    int felt = 0;
    for (int v = 0; v < mesh.x.rows(); ++v)
      if (const double distance = y(0, 2) - mesh.x(v, 2); distance < collider_dhat) {
        expected += collider_barrier(distance).value;
        ++felt;
      }
    EXPECT_GT(felt, 20);
    EXPECT_NEAR(energy_of_one(mesh, y), expected, 1e-9 * expected) << height;
  }
}

TEST(ColliderContactTest, AnEdgeFeelsEveryPieceOfARidgeItCrosses) {
  // a roof whose ridge, along y, is cut into short pieces, and a triangle with one edge across it
  constexpr int pieces = 40;
  constexpr double piece = 1e-4, height = 2e-4;
  ColliderMesh roof{"roof", Points3(3 * (pieces + 1), 3), Triangles(4 * pieces, 3), {}};
  for (int k = 0; k <= pieces; ++k)
    for (int side = -1; side <= 1; ++side)
      roof.x.row(3 * k + side + 1) << 0.02 * side, piece * (k - pieces / 2 + 0.5),
          -0.02 * std::abs(side);
  for (int k = 0; k < pieces; ++k)
    for (int i = 0; i < 2; ++i) {
      const int a = 3 * k + i, b = a + 1, c = b + 3, d = a + 3;
      roof.triangles.row(4 * k + 2 * i) << a, b, c;
      roof.triangles.row(4 * k + 2 * i + 1) << a, c, d;
    }
  Points3 y(3, 3);
  y << -0.01, 0, height, 0.01, 0, height, 0, 0.2, height;
  double expected = 0;
  const auto add = [&](double beside) {
    const double distance = std::hypot(height, std::max(0.0, beside));
    if (distance < collider_dhat) expected += collider_barrier(distance).value;
  };
  for (int k = 0; k <= pieces; ++k) {
    const double at = roof.x(3 * k + 1, 1);
    add(-at);                                                  // a corner and the triangle
    if (k < pieces) add(std::max(at, -roof.x(3 * k + 4, 1)));  // a piece and the edge
  }
  // the triangle's other edges are too far away, but for the corners at which they begin
  EXPECT_NEAR(energy_of_one(roof, y), expected, 1e-9 * expected);
}

TEST(ColliderContactTest, AnEdgeFeelsASurfaceThatIsSoFineThatEachOfItsEdgesIsNearlyFlat) {
  // a trough turned over, of a radius of 50 mm, in strips of 0.2 mm, below the middle of an edge
  constexpr int strips = 100;
  constexpr double step = 2e-4, radius = 0.05, height = 1e-4;
  ColliderMesh trough{"trough", Points3(2 * (strips + 1), 3), Triangles(2 * strips, 3), {}};
  for (int k = 0; k <= strips; ++k)
    for (int end = 0; end < 2; ++end) {
      const double x = step * (k - strips / 2);
      trough.x.row(2 * k + end) << x, 0.02 * (end - 0.5), -x * x / (2 * radius);
    }
  for (int k = 0; k < strips; ++k) {
    trough.triangles.row(2 * k) << 2 * k, 2 * k + 2, 2 * k + 3;
    trough.triangles.row(2 * k + 1) << 2 * k, 2 * k + 3, 2 * k + 1;
  }
  Points3 y(3, 3);
  y << -0.02, 0, height, 0.02, 0, height, 0, 0.2, 0.05;
  double expected = 0;  // of the strips' edges
  for (int k = 0; k <= strips; ++k) expected += collider_barrier(height - trough.x(2 * k, 2)).value;
  EXPECT_NEAR(energy_of_one(trough, y), expected, 1e-9 * expected);
}

/// A sheet of a few triangles near a box, rumpled so that faces, edges and corners of both are
/// within dhat.
struct Near {
  std::shared_ptr<const Colliders> colliders = all({box({-0.01, -0.01, -0.02}, {0.012, 0.013, 0})});
  Sheet sheet = hex_sheet(0.04, 0.04, 5, 0.2, 3);
  ColliderContact contact{colliders, sheet.triangles, static_cast<int>(sheet.x.rows())};

  explicit Near(double height) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> rumple(-1e-4, 1e-4);
    for (int v = 0; v < sheet.x.rows(); ++v) {
      sheet.x.row(v) += Eigen::RowVector3d(-0.02 + rumple(random), -0.02 + rumple(random),
                                           height + rumple(random));
      sheet.x(v, 2) -= 6 * sheet.x.row(v).head<2>().squaredNorm() * 0.05;
    }
    contact.begin(sheet.x, {shapes_at(*colliders, 0), shapes_at(*colliders, 0)}, {});
  }
};

TEST(ColliderContactTest, ContactGradientIsTheDerivativeOfTheEnergyOutsideAndInside) {
  for (const double height : {3e-4, 1e-4, -5e-5}) {
    Near near(height);
    Points3 y = near.sheet.x;
    y.col(0).array() += 3e-6;  // it slides, so that friction takes part
    Points3 gradient = Points3::Zero(y.rows(), 3);
    near.contact.differentiate(y, std::vector<int>(y.rows(), 0), gradient, nullptr);
    ASSERT_GT(gradient.norm(), 1e-2);
    std::mt19937 random(2);
    std::uniform_real_distribution<double> any(-1, 1);
    for (int trial = 0; trial < 5; ++trial) {
      const Points3 way = Points3::NullaryExpr(y.rows(), 3, [&] { return any(random); });
      const double e = 1e-9,
                   rise = (near.contact.energy(y + e * way) - near.contact.energy(y - e * way)) /
                          (2 * e);
      EXPECT_NEAR(rise, gradient.cwiseProduct(way).sum(), 1e-4 * gradient.norm()) << height;
    }
  }
}

TEST(ColliderContactTest, PaperJustBelowTheTipOfAPointedColliderIsNotInsideIt) {
  // the top rises by 3 to the corner (0.1, 0.1, 0); the walls below that corner are vertical
  ColliderMesh pointed = box({0, 0, -0.8}, {0.1, 0.1, 0});
  pointed.x(4, 2) = -0.6;
  pointed.x(5, 2) = pointed.x(6, 2) = -0.3;
  const auto colliders = all({pointed});
  const ColliderShapes at = shapes_at(*colliders, 0);
  ColliderContact contact(colliders, one_triangle(), 3);
  // the border runs beside the corner, with more than dhat to the top
  const double beside = 4 * collider_dhat;
  ASSERT_LT(beside, colliders->front().depth()) << "so deep paper counts as inside";
  Points3 y(3, 3);
  const double lean = 1e-4;  // [m] so that it is beyond the planes of both walls
  y << 0.08, 0.1 - beside + lean, 1e-4, 0.12, 0.1 - beside - lean, 1e-4, 0.1, 0.05, 1e-4;
  contact.begin(y, {at, at}, {});
  for (const double z : {1e-4, 1e-6, -1e-6, -1e-4}) {
    y.col(2).setConstant(z);
    EXPECT_EQ(contact.energy(y), 0) << z;
    EXPECT_EQ(contact.inside(y), 0) << z;
  }
  y.col(2).setConstant(-3 * beside - 2e-3);  // below the top at the border
  EXPECT_GT(contact.inside(y), 5e-4);
}

TEST(ColliderContactTest, ContactDoesNotPushAHandThatLiesOnTheCollider) {
  const auto colliders = all({ground()});
  Points3 x(3, 3);
  x << 0, 0, 1e-4, 0.01, 0, 1e-3, 0, 0.01, 1e-3;
  ColliderContact contact(colliders, one_triangle(), 3);
  const ColliderShapes at = shapes_at(*colliders, 0);
  const auto push = [&](const PositionConstraints& pulled, double height) {
    contact.begin(x, {at, at}, {}, pulled);
    Points3 y = x, gradient = Points3::Zero(3, 3);
    y(0, 2) = height;
    contact.differentiate(y, {0, 1, 2}, gradient, nullptr);
    return -gradient(0, 2);
  };
  const PositionConstraints hand{{0, x.row(0)}};
  EXPECT_GT(push({}, 1e-4), 0.3);  // the push that a handle gives way to
  EXPECT_EQ(push(hand, 1e-4), 0);
  EXPECT_GT(push(hand, -1e-4), 0.01);  // but it must not be pressed in
}

TEST(ColliderContactTest, UnconvergedElasticStepReportsASnapInProgress) {
  Sheet sheet = hex_sheet(0.1, 0.1, 8);
  sheet.x.col(2).array() += 4e-4;
  StepInput held = resting(*all({ground()}));
  held.constraints = {{0, sheet.x.row(0) + Eigen::RowVector3d(0.002, 0.002, 0.01)}};
  for (const int most : {1, 60}) {
    ElasticOptions options;
    options.forces.gravity = g;
    options.max_iterations = most;
    options.colliders = all({ground()});
    Elastic elastic(Paper{}, options);
    elastic.set_mesh(sheet);
    Sheet moved = sheet;
    const ElasticReport report = elastic.step(moved, held, 1 / 24.0);
    EXPECT_EQ(report.converged, most == 60);
    EXPECT_EQ(report.snap_in_progress, most == 1);
  }
}

TEST(ColliderContactTest, ContactHessianIsExactOnAPlane) {
  const auto colliders = all({ground()});
  Points3 x(3, 3);
  x << 0, 0, 3e-4, 0.01, 0, 2e-4, 0, 0.01, 5e-5;
  ColliderContact contact(colliders, one_triangle(), 3);
  contact.begin(x, {shapes_at(*colliders, 0), shapes_at(*colliders, 0)}, {});
  x.col(0).array() += 1e-6;  // within the static range of the friction mollifier
  x.col(1).array() += 2e-6;
  const std::vector<int> blocks{0, 1, 2};
  BlockCholesky matrix(3, {{0, 1}, {0, 2}, {1, 2}});
  matrix.set_zero();
  Points3 gradient = Points3::Zero(3, 3);
  contact.differentiate(x, blocks, gradient, &matrix);
  const Eigen::MatrixXd second = matrix.dense();
  ASSERT_GT(second.norm(), 1);
  for (int k = 0; k < 9; ++k) {
    const double e = 1e-10;
    Points3 up = Points3::Zero(3, 3), down = up, a = x, b = x;
    a.data()[k] += e;
    b.data()[k] -= e;
    contact.differentiate(a, blocks, up, nullptr);
    contact.differentiate(b, blocks, down, nullptr);
    for (int i = 0; i < 9; ++i)
      EXPECT_NEAR((up.data()[i] - down.data()[i]) / (2 * e), second(i, k), 1e-4 * second.norm());
  }
}

/// Steps a free sheet. returns  [m/s] its mean velocity half way through
Vector3d relax(Sheet& sheet, const std::shared_ptr<const Colliders>& colliders, int steps) {
  ElasticOptions options;
  options.forces.gravity = g;
  options.inertia = Inertia::dynamic;
  options.colliders = colliders;
  options.stop = 1e-7;  // a hundredth of what a sheet slides in one step
  Elastic elastic(Paper{}, options);
  elastic.set_mesh(sheet);
  Vector3d half_way = Vector3d::Zero();
  for (int k = 0; k < steps; ++k) {
    elastic.step(sheet, resting(*colliders), 1 / 96.0);
    if (k + 1 == steps / 2) half_way = sheet.v.colwise().mean();
  }
  return half_way;
}

TEST(ColliderRestTest, FallenSheetRestsWhereTheGroundCarriesItsWeight) {
  Sheet sheet = hex_sheet(0.05, 0.05, 6);
  for (int v = 0; v < sheet.x.rows(); ++v) sheet.x(v, 2) = 0.02 + 0.2 * sheet.x(v, 0);
  relax(sheet, all({ground()}), 60);
  double push = 0;
  for (int v = 0; v < sheet.x.rows(); ++v) push -= collider_barrier(sheet.x(v, 2)).slope;
  const double weight = Paper{}.area_density * 0.05 * 0.05 * g;
  EXPECT_NEAR(push, weight, 0.01 * weight);
  EXPECT_LT(sheet.v.rowwise().norm().maxCoeff(), 1e-3);
  EXPECT_LT(sheet.x.col(2).maxCoeff(), collider_dhat);
  EXPECT_GT(sheet.x.col(2).minCoeff(), 0.95 * collider_dhat);
}

TEST(ColliderRestTest, AskingHowDeepAnotherSheetLiesChangesNothing) {
  const auto colliders = all({ground()});
  ElasticOptions options;
  options.forces.gravity = g;
  options.colliders = colliders;
  Sheet asked = hex_sheet(0.05, 0.05, 6), untouched;
  asked.x.col(2).array() += 2e-4;
  untouched = asked;
  Elastic asks(Paper{}, options), silent(Paper{}, options);
  asks.set_mesh(asked);
  silent.set_mesh(untouched);
  Sheet sunk = asked;
  sunk.x.col(2).array() -= 7e-4;
  sunk.x.col(0).array() += 0.03;
  const Elastic& constant = asks;
  for (int k = 0; k < 5; ++k) {
    EXPECT_NEAR(constant.inside(sunk, shapes_at(*colliders, 0)), 5e-4, 1e-12);
    const ElasticReport a = asks.step(asked, resting(*colliders), 1 / 24.0),
                        b = silent.step(untouched, resting(*colliders), 1 / 24.0);
    ASSERT_GT(a.on_colliders, 0);
    EXPECT_EQ(a.on_colliders, b.on_colliders);
    EXPECT_EQ(a.iterations, b.iterations);
    EXPECT_TRUE(asked.x == untouched.x) << k;  // to the last bit
  }
}

/// Speeds of a sheet on a plane of this slope after an eighth and a quarter of a second. [m/s]
std::pair<double, double> speeds(double slope) {
  const Eigen::AngleAxisd turn(std::atan(slope), Vector3d::UnitY());
  ColliderMesh plane = ground(1, 0.4);
  plane.x = (plane.x * turn.toRotationMatrix().transpose()).eval();
  Sheet sheet = hex_sheet(0.05, 0.05, 5);
  sheet.x.col(2).array() += collider_dhat - 4e-6;
  sheet.x = (sheet.x * turn.toRotationMatrix().transpose()).eval();
  const double half_way = relax(sheet, all({plane}), 24).norm();
  return {half_way, sheet.v.colwise().mean().norm()};
}

TEST(ColliderRestTest, SheetOnASlopeSticksOrSlidesByCoulombsLaw) {
  EXPECT_LT(speeds(0.3).second, 1e-5);
  EXPECT_LT(speeds(0.38).second, 1e-5);
  const auto [before, after] = speeds(0.6);
  const double angle = std::atan(0.6), damping = -24 * std::log(0.98);
  const double a = g * (std::sin(angle) - 0.4 * std::cos(angle)) - damping * 0.5 * (before + after);
  EXPECT_NEAR((after - before) / 0.125, a, 0.05 * a);
}

// A beam over a support lifts off sqrt(2) L behind the edge, and its tip lies
// q L^4/D (sqrt(2)/12 + 1/8) below it.
TEST(ColliderRestTest, StripOverATableEdgeSagsLikeABeam) {
  const double L = 0.04;
  Sheet sheet = hex_sheet(0.12, 0.02, 24);
  sheet.x.col(0).array() -= 0.12 - L;
  sheet.x.col(2).array() += collider_dhat;
  relax(sheet, all({box({-0.3, -0.1, -0.1}, {0, 0.2, 0})}), 96);
  const double q = Paper{}.area_density * g,
               sag = q * std::pow(L, 4) / Paper{}.bending_stiffness * (std::sqrt(2) / 12 + 0.125);
  double tip = 0, lifted = 0;
  for (int v = 0; v < sheet.x.rows(); ++v) {
    if (sheet.pattern(v, 0) > 0.12 - 1e-9) tip = collider_dhat - sheet.x(v, 2);
    lifted = std::max(lifted, sheet.x(v, 2) - collider_dhat);
  }
  EXPECT_NEAR(tip, sag, 0.1 * sag);  // between a beam and a plate: D and (1 - nu^2) D
  EXPECT_GT(lifted, 1e-5);
}

TEST(ColliderClearanceTest, AnEdgeThatHangsOverARimIsLiftedOntoIt) {
  const auto colliders = all({bin(0.05)});
  Points3 outside(3, 3);
  outside << 0.045, -0.002, 2e-4, 0.055, -0.002, 2e-4, 0.05, 0.01, 2e-4;
  Points3 x = outside;
  x.col(2).array() -= 5e-4;  // 0.3 mm below the rim
  ColliderClearance clearance(colliders, shapes_at(*colliders, 0), one_triangle(), outside);
  EXPECT_LT(clearance.begins_inside(), 1e-9);
  for (int k = 0; k < 20; ++k) clearance.push_out({0, 0, 0}, 0, x);
  EXPECT_GT(0.5 * (x(0, 2) + x(1, 2)), -1e-6);
  EXPECT_LT((x - outside).rowwise().norm().maxCoeff(), 1e-3);
  // a sheet that the wall has been through begins inside
  outside.col(2).array() -= 8e-4;
  EXPECT_NEAR(ColliderClearance(colliders, shapes_at(*colliders, 0), one_triangle(), outside)
                  .begins_inside(),
              6e-4, 1e-9);
}

TEST(ColliderClearanceTest, ATriangleThatHangsOverACornerIsLiftedOntoIt) {
  // a pointed wall, beside which all edges of the triangle pass; its front faces two corners of it
  ColliderMesh wall{"wall", Points3(3, 3), Triangles(1, 3), {}};
  wall.x << 0, 0, 0, -0.02, 0, -0.05, 0.02, 0, -0.05;
  wall.triangles << 0, 1, 2;
  const auto colliders = all({wall});
  Points3 outside(3, 3);
  outside << -0.06, -0.03, 2e-4, 0.06, -0.03, 2e-4, 0, 0.06, 2e-4;
  Points3 x = outside;
  x.col(2).array() -= 5e-4;
  ColliderClearance clearance(colliders, shapes_at(*colliders, 0), one_triangle(), outside);
  for (int k = 0; k < 20; ++k) clearance.push_out({0, 0, 0}, 0, x);
  EXPECT_NEAR(x.col(2).mean(), 0, 1e-6);  // above the corner
}

}  // namespace
}  // namespace paperbake
