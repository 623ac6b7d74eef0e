#include "core/animation/animate.h"
#include "core/animation/motion_measures.h"
#include "core/geometry/collider_facing.h"
#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/methods/fem.h"
#include "core/methods/hybrid.h"
#include "core/step1_elastic/contact/collider_contact.h"
#include "tests/core/test_meshes.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace paperbake {
namespace {

using test::bare_handle;
using test::blank_shot;
using test::hex_sheet;
using test::rectangle;

constexpr double g = 9.81, pi = M_PI;

ColliderMesh ground(double half = 0.5, double friction = 0.4) {
  ColliderMesh mesh{"ground", Points3(4, 3), Triangles(2, 3), {}, friction};
  mesh.x << -half, -half, 0, half, -half, 0, half, half, 0, -half, half, 0;
  mesh.triangles << 0, 1, 2, 0, 2, 3;
  return mesh;
}

/// A box whose triangles face outwards or, when `inside_out`, inwards.
ColliderMesh box(const Vector3d& low, const Vector3d& high, bool inside_out = false) {
  ColliderMesh mesh{"box", Points3(8, 3), Triangles(12, 3), {}};
  for (int v = 0; v < 8; ++v)
    mesh.x.row(v) << (v & 1 ? high : low).x(), (v & 2 ? high : low).y(), (v & 4 ? high : low).z();
  mesh.triangles << 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6,
      0, 6, 2, 1, 3, 7, 1, 7, 5;
  if (inside_out) mesh.triangles.col(1).swap(mesh.triangles.col(2));
  return mesh;
}

std::shared_ptr<const Colliders> all(const std::vector<ColliderMesh>& meshes) {
  return std::make_shared<const Colliders>(meshes.begin(), meshes.end());
}

StepInput resting(const Colliders& colliders) {
  return {{}, {shapes_at(colliders, 0), shapes_at(colliders, 0)}};
}

TEST(ColliderTest, BarrierSlopesAreDerivativesAndTheLawContinuesInside) {
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

TEST(ColliderTest, ClosedMeshKnowsItsInsideForEitherOrientation) {
  for (const bool inside_out : {false, true}) {
    const Collider collider(box({0, 0, 0}, {0.1, 0.1, 0.1}, inside_out));
    ASSERT_TRUE(collider.closed());
    EXPECT_NEAR(collider.nearest({0.05, 0.05, 0.103}, 0.1, 1).distance, 0.003, 1e-12);
    EXPECT_NEAR(collider.nearest({0.05, 0.05, 0.098}, 0.1, 1).distance, -0.002, 1e-12);
    // near an edge
    EXPECT_NEAR(collider.nearest({0.103, 0.05, 0.104}, 0.1, 1).distance, 0.005, 1e-12);
    // and near a corner
    EXPECT_NEAR(collider.nearest({0.1, 0.1, 0.1 + 0.002}, 0.1, 1).distance, 0.002, 1e-12);
  }
  EXPECT_FALSE(Collider(ground()).closed());
}

TEST(ColliderTest, ASheetThatBeginsInAClosedMeshStaysInsideUnlessTheMeshSaysOtherwise) {
  using Side = ColliderMesh::PaperSide;
  Points3 inner(3, 3), half(3, 3);
  inner << 0.4, 0.4, 0.5, 0.6, 0.4, 0.5, 0.5, 0.6, 0.5;
  half << 0.4, 0.4, 0.5, 0.6, 0.4, 0.5, 0.5, 1.6, 0.5;
  for (const bool inside_out : {false, true}) {
    std::vector<ColliderMesh> cage{box({0, 0, 0}, {1, 1, 1}, inside_out)};
    face_the_sheet(cage, half, Points3(0, 3));
    EXPECT_EQ(cage[0].paper_side, Side::outside);
    cage[0].paper_side = Side::automatic;
    face_the_sheet(cage, inner, Points3(0, 3));
    EXPECT_EQ(cage[0].paper_side, Side::inside);
    const Collider hollow(cage[0]);
    EXPECT_TRUE(hollow.closed());
    EXPECT_NEAR(hollow.nearest({0.5, 0.5, 0.9}, 2, 1).distance, 0.1, 1e-12);
    EXPECT_NEAR(hollow.nearest({0.5, 0.5, 1.2}, 2, 1).distance, -0.2, 1e-12);
    EXPECT_LT(hollow.nearest({0.5, 0.5, 0.9}, 2, 1).normal.z(), -0.99);
    EXPECT_EQ(Collider(hollow, hollow.mesh().x).mesh().paper_side, Side::inside);
    cage[0].paper_side = Side::outside;
    face_the_sheet(cage, inner, Points3(0, 3));
    EXPECT_EQ(cage[0].paper_side, Side::outside);
  }
}

TEST(ColliderTest, OpenMeshFacesTheSheetAndUpwardsWhereTheSheetLiesInIt) {
  for (const double height : {0.01, -0.01, 0.0}) {
    std::vector<ColliderMesh> meshes{ground()};
    Points3 x(3, 3);
    x << 0, 0, height, 0.1, 0, height, 0, 0.1, height;
    meshes[0].triangles.col(1).swap(meshes[0].triangles.col(2));
    face_the_sheet(meshes, x, Points3(0, 3));
    EXPECT_EQ(Collider(meshes[0]).nearest({0.01, 0.02, 0.001}, 1, 1).distance > 0, height >= 0)
        << height;
  }
}

TEST(ColliderTest, AnOpenMeshFacesASheetThatBeginsBesideItAsIfItWentOn) {
  // of a table that ends at x = -1: 3 mm below its level, above it, and on both sides of it
  for (const double height : {-0.003, 0.003, 0.0})
    for (const bool turned : {false, true}) {
      std::vector<ColliderMesh> meshes{ground()};
      const double edge = meshes[0].x.col(0).maxCoeff();
      Points3 x(3, 3);
      x << edge, 0, height, edge + 0.1, 0, height - 0.001, edge, 0.1, height + 0.001;
      if (turned) meshes[0].triangles.col(1).swap(meshes[0].triangles.col(2));
      face_the_sheet(meshes, x, Points3(0, 3));
      const Collider facing(meshes[0]);
      EXPECT_EQ(facing.nearest({0.01, 0.02, 0.001}, 1, 1).distance > 0, height >= 0) << height;
      // and a handle that is keyed to go over it or under it knows better
      Points3 keyed(1, 3);
      keyed << 0.01, 0.02, -height;
      face_the_sheet(meshes, x, keyed);
      EXPECT_EQ(Collider(meshes[0]).nearest({0.01, 0.02, 0.001}, 1, 1).distance > 0, height <= 0);
    }
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

TEST(ColliderTest, ContactGradientIsTheDerivativeOfTheEnergyOutsideAndInside) {
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

TEST(ColliderTest, ContactDoesNotPushAHandThatLiesOnTheCollider) {
  const auto colliders = all({ground()});
  Points3 x(3, 3);
  x << 0, 0, 1e-4, 0.01, 0, 1e-3, 0, 0.01, 1e-3;
  Triangles one(1, 3);
  one << 0, 1, 2;
  ColliderContact contact(colliders, one, 3);
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

TEST(ColliderTest, UnconvergedElasticStepReportsASnapInProgress) {
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

TEST(ColliderTest, ContactHessianIsExactOnAPlane) {
  const auto colliders = all({ground()});
  Points3 x(3, 3);
  x << 0, 0, 3e-4, 0.01, 0, 2e-4, 0, 0.01, 5e-5;
  Triangles one(1, 3);
  one << 0, 1, 2;
  ColliderContact contact(colliders, one, 3);
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

/// A sheet on a table: its corner is lifted, then the handle goes 10 mm into the wood and 30 mm
/// along it.
TEST(ColliderTest, ColliderStopsTheHandleWhichIsJammedWhenHard) {
  for (const double stiffness : {0.0, 5000.0}) {
    const int frames = 24;
    Shot shot = blank_shot(rectangle(0.1, 0.1));
    shot.start.x.col(2).array() += 6e-4;
    Handle handle = bare_handle("handle", {0, 0}, frames);
    handle.stiffness = stiffness;
    for (int f = 0; f < frames; ++f)
      handle.keyed.row(f) << 0.03 * f / (frames - 1), 0,
          f < 8 ? 6e-4 + 0.02 * f / 8 : 0.02 - 0.03 * std::min(1.0, (f - 8) / 8.0);
    shot.handles = {handle};
    shot.colliders = all({box({-0.2, -0.2, -0.05}, {0.3, 0.3, 0})});
    AnimateOptions options;
    options.elastic.forces.gravity = g;
    options.elastic.inertia = Inertia::dynamic;
    options.last_frame = frames;
    double lowest = 1, off = 0, along = 0;
    HandleFrame::State last = HandleFrame::free;
    animate(shot, fem(150), options, [&](const AnimatedFrame& frame) {
      lowest = std::min(lowest, frame.sheet->x.col(2).minCoeff());
      EXPECT_LT(frame.statistics.inside_colliders, 1e-4);
      last = frame.handles[0].state;
      off = (frame.handles[0].at - frame.handles[0].keyed).norm();
      along = frame.handles[0].at.x();
      return true;
    });
    EXPECT_GT(lowest, -1e-4);
    EXPECT_NEAR(off, 0.01, 1e-3);
    EXPECT_NEAR(along, 0.03, 1e-3);  // it slides along the table
    EXPECT_EQ(last, stiffness > 0 ? HandleFrame::soft : HandleFrame::jammed);
  }
}

/// A tube of `sides` facets along y over [0, length].
ColliderMesh tube(const Vector2d& centre_xz, double radius, double length, int sides) {
  ColliderMesh mesh{"tube", Points3(2 * sides + 2, 3), Triangles(4 * sides, 3), {}};
  const int end = 2 * sides;  // the middle of its cap at y = 0; end + 1: at y = length
  mesh.x.row(end) << centre_xz.x(), 0, centre_xz.y();
  mesh.x.row(end + 1) << centre_xz.x(), length, centre_xz.y();
  for (int i = 0; i < sides; ++i) {
    const double angle = 2 * pi * i / sides;
    for (int k = 0; k < 2; ++k)
      mesh.x.row(2 * i + k) << centre_xz.x() + radius * std::cos(angle), k * length,
          centre_xz.y() + radius * std::sin(angle);
    const int a = 2 * i, b = 2 * ((i + 1) % sides);
    mesh.triangles.middleRows(4 * i, 4) << a, a + 1, b + 1, a, b + 1, b, end, a, b, end + 1, b + 1,
        a + 1;
  }
  return mesh;
}

/// Three hands hold the left border of a sheet and three lead the right one round a tube, farther
/// than the paper reaches.
Shot pulled_round_a_tube(int frames, double way_radius, double handle_radius) {
  const double width = 0.3, height = 0.2, above = 0.034, at = 0.25, grip = width - 0.002;
  Shot shot = blank_shot(rectangle(width, height));
  shot.colliders = all({tube({at, above}, 0.03, height, 48)});
  for (const double y : {0.01, 0.1, 0.19}) {
    shot.handles.push_back(bare_handle("handle_left", {width - grip, y}, frames));
    shot.handles.push_back(bare_handle("handle_right", {grip, y}, frames));
    for (int f = 0; f < frames; ++f) {
      const double angle = 1.3 * pi * f / 59,
                   straight = std::max(0.0, grip - at - way_radius * angle);
      shot.handles.back().keyed.row(f)
          << at + way_radius * std::sin(angle) + straight * std::cos(angle),
          y, above - way_radius * std::cos(angle) + straight * std::sin(angle) - 0.001;
    }
  }
  for (Handle& handle : shot.handles) handle.radius = handle_radius;
  return shot;
}

// The steps with hard handles are unfinished there: with them, edges were off by up to 49 % in half
// of these shots.
TEST(ColliderTest, HandsThatPullPaperTautRoundATubeGiveWayAndThePaperStaysWhole) {
  AnimateOptions options;
  options.last_frame = 36;
  for (const double way_radius : {0.032, 0.0325, 0.033})
    for (const double handle_radius : {0.002, 0.005}) {
      const Shot shot = pulled_round_a_tube(options.last_frame, way_radius, handle_radius);
      double stretch = 0;
      bool gave_way = false;
      animate(shot, hybrid(shot.pattern, shot.paper, 120, {}, 0, 0), options,
              [&](const AnimatedFrame& frame) {
                stretch = std::max(stretch, length_distortion(*frame.sheet).largest);
                gave_way |= frame.handles.back().state == HandleFrame::jammed;
                return true;
              });
      EXPECT_LT(stretch, 0.03) << way_radius << " " << handle_radius;
      EXPECT_TRUE(gave_way) << way_radius << " " << handle_radius;
    }
}

TEST(ColliderTest, MovingBoxPushesTheSheetWhichStaysWhereItWasLeft) {
  const int frames = 30;
  Shot shot = blank_shot(rectangle(0.05, 0.05));
  shot.start.x.col(2).array() += 6e-4;
  ColliderMesh pusher = box({-0.03, 0.01, 1e-4}, {-0.005, 0.04, 0.02});
  for (int f = 0; f < frames; ++f) {
    pusher.frames.push_back(pusher.x);
    pusher.frames.back().col(0).array() += 0.03 * std::min(1.0, f / 20.0);
  }
  shot.colliders = all({ground(), pusher});
  AnimateOptions options;
  options.elastic.forces.gravity = g;
  options.elastic.inertia = Inertia::dynamic;
  options.last_frame = frames;
  animate(shot, fem(60), options, [&](const AnimatedFrame& frame) {
    EXPECT_LT(frame.statistics.inside_colliders, 1e-4);
    if (frame.frame > 24) {
      EXPECT_NEAR(frame.sheet->x.col(0).minCoeff(), 0.025, 1e-3);
    }
    return true;
  });
}

TEST(ColliderTest, AFrameGoesOnFromTheShapesOfTheFrameBefore) {
  ColliderMesh moving = box({-0.01, -0.01, 0}, {0.01, 0.01, 0.02});
  for (const double height : {0.0, 0.003, 0.003, 0.004}) {
    moving.frames.push_back(moving.x);
    moving.frames.back().col(2).array() += height;
  }
  const auto colliders = all({ground(), moving});
  ColliderShapes before = shapes_at(*colliders, 0);
  for (int row = 1; row < 6; ++row) {
    const ColliderMotion motion = motion_to(*colliders, row, before),
                         anew = motion_to(*colliders, row);
    EXPECT_EQ(motion.from, before);
    EXPECT_EQ(motion.to[0], motion.from[0]) << "the ground stands still";
    EXPECT_EQ(motion.to[1] == motion.from[1], row == 2 || row > 3) << row;
    EXPECT_EQ(motion.to[1]->mesh().x, anew.to[1]->mesh().x);
    EXPECT_EQ(farthest_move(*colliders, row), farthest_move(anew.from, anew.to));
    EXPECT_NEAR(farthest_move(*colliders, row), row == 1 ? 0.003 : row == 3 ? 0.001 : 0, 1e-15);
    before = motion.to;
  }
}

TEST(ColliderTest, ARigidMotionCarriesPointsAlong) {
  const Collider from(box({-0.02, -0.01, 0}, {0.02, 0.01, 0.03}));
  const Eigen::Isometry3d motion = Eigen::Translation3d(0.01, -0.02, 0.005) *
                                   Eigen::AngleAxisd(0.4, Vector3d(1, 2, -1).normalized());
  Points3 x = from.mesh().x;
  for (int v = 0; v < x.rows(); ++v) x.row(v) = (motion * Vector3d(x.row(v))).transpose();
  const Collider to(from, x);
  for (const Vector3d& p : {Vector3d(0.001, 0.002, 0.031), Vector3d(0.022, 0.013, -0.004),
                            Vector3d(0.01, 0.004, 0.029)})
    EXPECT_LT((carried(from, to, p, farthest_move(from, to) + 1e-3, 1) - motion * p).norm(), 1e-9);
  const Vector3d far(0.2, 0, 0);  // the box moves by less than its distance
  EXPECT_EQ(carried(from, to, far, farthest_move(from, to) + 1e-3, 1), far);
}

/// A sheet of 10 cm held at its corners, at a height [m].
Shot held_over(double height, int frames, double stiffness) {
  Shot shot = blank_shot(rectangle(0.1, 0.1));
  shot.start.x.col(2).array() += height;
  for (const Vector2d& corner :
       {Vector2d(0, 0), Vector2d(0.1, 0), Vector2d(0, 0.1), Vector2d(0.1, 0.1)}) {
    shot.handles.push_back(bare_handle("corner", corner, frames));
    shot.handles.back().keyed.col(2).setConstant(height);
    shot.handles.back().stiffness = stiffness;
  }
  return shot;
}

TEST(ColliderTest, AColliderThatGrowsLiftsTheSheet) {
  const int frames = 20;
  Shot shot = held_over(0.012, frames, 20);
  ColliderMesh balloon = box({0.03, 0.03, -0.01}, {0.07, 0.07, 0.01});
  const Points3 x = balloon.x;
  for (int f = 0; f < frames; ++f) {  // it grows upwards, to a height of 4 cm
    balloon.frames.push_back(x);
    for (int v = 0; v < x.rows(); ++v)
      if (x(v, 2) > 0) balloon.frames.back()(v, 2) += 0.03 * f / (frames - 1);
  }
  shot.colliders = all({balloon});
  AnimateOptions options;
  options.last_frame = frames;
  double highest = 0;
  animate(shot, fem(60), options, [&](const AnimatedFrame& frame) {
    EXPECT_LT(frame.statistics.inside_colliders, 1e-4) << frame.frame;
    highest = frame.sheet->x.col(2).maxCoeff();
    return true;
  });
  EXPECT_GT(highest, 0.0395);
  EXPECT_LT(highest, 0.045);
}

TEST(ColliderTest, ARodThinnerThanTheTrianglesDoesNotPassThrough) {
  const int frames = 12;
  Shot shot = held_over(0, frames, 20);
  ColliderMesh rod = box({0.048, 0.03, 0.003}, {0.052, 0.07, 0.1});  // 4 mm, upright
  const Points3 x = rod.x;
  for (int f = 0; f < frames; ++f)  // down at 0.2 m/s
    rod.frames.push_back(x.rowwise() - Eigen::RowVector3d(0, 0, 0.2 / 24 * std::min(f, 6)));
  shot.colliders = all({rod});
  AnimateOptions options;
  options.last_frame = frames;
  animate(shot, fem(60), options, [&](const AnimatedFrame& frame) {
    EXPECT_LT(frame.statistics.inside_colliders, 1e-4) << frame.frame;
    if (frame.frame == frames) {
      EXPECT_LT(frame.sheet->x.col(2).minCoeff(), -0.0465);
    }
    return true;
  });
}

/// What squeezes is what deforms: a cage that shrinks does, one that goes elsewhere as it is does
/// not.
TEST(ColliderTest, ASheetIsSqueezedByCollidersThatMoveRelativeToEachOther) {
  const Colliders cage{Collider(box({-0.06, -0.06, -0.06}, {0.06, 0.06, 0.06}, true))};
  const ColliderShapes from = shapes_at(cage, 0);
  Points3 x(4, 3);  // on two opposite sides, within the reach of the barrier
  x << -0.0598, 0, 0, -0.0598, 0.01, 0, 0.0598, 0, 0, 0.0598, 0.01, 0;
  const auto moved = [&](const Points3& to) -> ColliderShapes {
    return {std::make_shared<const Collider>(*from[0], to)};
  };
  const Points3& now = from[0]->mesh().x;
  EXPECT_EQ(squeeze(x, {from, from}), 0);
  EXPECT_LT(squeeze(x, {from, moved(now.rowwise() + Eigen::RowVector3d(0.01, 0, 0))}), 1e-9);
  EXPECT_NEAR(squeeze(x, {from, moved(0.9 * now)}), 0.006, 3e-4);
}

TEST(ColliderTest, ACageThatShrinksKeepsTheSheetInsideAndWhole) {
  const int frames = 30;
  Shot shot = blank_shot(rectangle(0.1, 0.1));
  shot.start.x.rowwise() -= Eigen::RowVector3d(0.05, 0.05, 0);
  ColliderMesh cage = box({-0.06, -0.06, -0.06}, {0.06, 0.06, 0.06});
  const Points3 x = cage.x;
  for (int f = 0; f < frames; ++f) cage.frames.push_back(x * (1 - 0.3 * f / (frames - 1)));
  shot.colliders = facing_colliders({cage}, shot.start.x, {});
  AnimateOptions options;
  options.last_frame = frames;
  animate(shot, fem(60), options, [&](const AnimatedFrame& frame) {
    const double half = 0.06 * (1 - 0.3 * (frame.frame - 1) / (frames - 1));
    EXPECT_LT(frame.sheet->x.cwiseAbs().maxCoeff(), half + 5e-5) << frame.frame;
    EXPECT_LT(frame.statistics.inside_colliders, 5e-5) << frame.frame;
    EXPECT_LT(length_distortion(*frame.sheet).largest, 0.01) << frame.frame;
    return true;
  });
}

/// A cage that shrinks to where the coarse mesh cannot fold any more leaves the sheet behind, whole
/// and not entangled, says so, and finds it again when it opens.
TEST(ColliderTest, ACageThatShrinksTooFarLeavesTheSheetBehindWhole) {
  const int frames = 33;
  Shot shot = blank_shot(rectangle(0.1, 0.1));
  shot.start.x.rowwise() -= Eigen::RowVector3d(0.05, 0.05, 0);
  ColliderMesh cage = box({-0.06, -0.06, -0.06}, {0.06, 0.06, 0.06});
  const Points3 x = cage.x;
  const auto size = [](int frame) { return 1 - 0.7 * std::min(frame - 1, 33 - frame) / 16; };
  for (int f = 1; f <= frames; ++f) cage.frames.push_back(x * size(f));
  shot.colliders = facing_colliders({cage}, shot.start.x, {});
  AnimateOptions options;
  options.last_frame = frames;
  int jammed = 0;
  animate(shot, fem(60), options, [&](const AnimatedFrame& frame) {
    EXPECT_LT(length_distortion(*frame.sheet).largest, 0.0201) << frame.frame;
    EXPECT_EQ(crossings(*frame.sheet), 0) << frame.frame;
    const bool told = frame.note.find("jammed") != std::string::npos;
    jammed += told;
    EXPECT_EQ(told, frame.statistics.inside_colliders > 1e-4) << frame.frame;
    EXPECT_TRUE(!told || !frame.statistics.converged) << frame.frame;
    EXPECT_FALSE(told && frame.frame == frames);
    return true;
  });
  EXPECT_GT(jammed, 0);
}

/// A bin without a lid: four walls from z = -0.1 to 0 round a square of this half width.
ColliderMesh bin(double half) {
  ColliderMesh mesh{"bin", Points3(8, 3), Triangles(10, 3), {}};
  for (int k = 0; k < 4; ++k) {
    const double x = k == 0 || k == 3 ? -half : half, y = k < 2 ? -half : half;
    mesh.x.row(k) << x, y, -0.1;
    mesh.x.row(4 + k) << x, y, 0;
    const int next = (k + 1) % 4;
    mesh.triangles.row(2 * k) << k, next, 4 + next;
    mesh.triangles.row(2 * k + 1) << k, 4 + next, 4 + k;
  }
  mesh.triangles.row(8) << 0, 2, 1;
  mesh.triangles.row(9) << 0, 3, 2;
  return mesh;
}

TEST(ColliderTest, PushOutKnowsWhoHasComeOverTheRimOfABin) {
  // the front is outside; facets are above the rim, and the smooth surface hangs below it
  const auto colliders = all({bin(0.05)});
  Points3 facets(3, 3), x(3, 3);
  facets << 0.0485, 0, 1e-4, 0.0515, 0, 1e-4, 0.051, 0, -0.01;
  x << 0.0485, 0, -3e-4, 0.0515, 0, -3e-4, 0.0499, 0, -0.01;
  const Points3 before = x;
  push_out(shapes_at(*colliders, 0), facets, 0, x);
  EXPECT_EQ(x.topRows(2), before.topRows(2));  // on either side of the wall, over its rim
  EXPECT_NEAR(x(2, 0), 0.05, 1e-12);           // through the wall
}

TEST(ColliderTest, ASheetLevelWithTheRimOfABinLeavesItsFrontInside) {
  // three quarters of its vertices are beside the mouth: beyond the border there is no front
  std::vector<ColliderMesh> meshes{bin(0.05)};
  Sheet sheet = hex_sheet(0.2, 0.2, 60);
  sheet.x.rowwise() -= Eigen::RowVector3d(0.1, 0.1, -1e-3);
  face_the_sheet(meshes, sheet.x, Points3(0, 3));
  EXPECT_GT(Collider(meshes[0]).nearest({0, 0, -0.05}, 1, 1).distance, 0);
}

TEST(ColliderClearanceTest, AnEdgeThatHangsOverARimIsLiftedOntoIt) {
  const auto colliders = all({bin(0.05)});
  Points3 outside(3, 3);
  outside << 0.045, -0.002, 2e-4, 0.055, -0.002, 2e-4, 0.05, 0.01, 2e-4;
  Triangles one(1, 3);
  one << 0, 1, 2;
  Points3 x = outside;
  x.col(2).array() -= 5e-4;  // 0.3 mm below the rim
  ColliderClearance clearance(colliders, shapes_at(*colliders, 0), one, outside);
  EXPECT_LT(clearance.begins_inside(), 1e-9);
  for (int k = 0; k < 20; ++k) clearance.push_out({0, 0, 0}, x);
  EXPECT_GT(0.5 * (x(0, 2) + x(1, 2)), -1e-6);
  EXPECT_LT((x - outside).rowwise().norm().maxCoeff(), 1e-3);
  // a sheet that the wall has been through begins inside
  outside.col(2).array() -= 8e-4;
  EXPECT_NEAR(ColliderClearance(colliders, shapes_at(*colliders, 0), one, outside).begins_inside(),
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
  Triangles one(1, 3);
  one << 0, 1, 2;
  Points3 x = outside;
  x.col(2).array() -= 5e-4;
  ColliderClearance clearance(colliders, shapes_at(*colliders, 0), one, outside);
  for (int k = 0; k < 20; ++k) clearance.push_out({0, 0, 0}, x);
  EXPECT_NEAR(x.col(2).mean(), 0, 1e-6);  // above the corner
}

TEST(ColliderTest, PushOutMovesOnlyWhatIsInsideTheGround) {
  const auto colliders = all({ground()});
  Points3 facets(2, 3), x(2, 3);
  facets << 0, 0, 1e-4, 0.01, 0, 2e-3;
  x << 0, 0, -1e-3, 0.01, 0, 1e-3;
  EXPECT_NEAR(push_out(shapes_at(*colliders, 0), facets, 0, x), 1e-3, 1e-12);
  EXPECT_NEAR(x(0, 2), 0, 1e-12);
  EXPECT_EQ(x(1, 2), 1e-3);
}

}  // namespace
}  // namespace paperbake
