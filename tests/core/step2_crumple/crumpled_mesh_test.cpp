#include "core/step2_crumple/crumpled_mesh.h"

#include "core/geometry/curvature.h"
#include "core/geometry/pattern_mesh.h"
#include "core/geometry/point_location.h"
#include "core/model/error.h"
#include "core/model/serializer.h"
#include "core/step2_crumple/vertex_moves.h"
#include "tests/core/geometry/sound_mesh.h"
#include "tests/core/test_meshes.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

constexpr double side = 0.1;  // [m]

/// An inner vertex near (u, v). [m]
int vertex_near(const Sheet& sheet, double u, double v) {
  int best = 0;
  (sheet.pattern.rowwise() - Eigen::RowVector2d(u, v)).rowwise().squaredNorm().minCoeff(&best);
  return best;
}

constexpr double height = 0.006;  // [m] of the tip

/// A flat sheet with three singular points near its border and a blunt tip at one of its vertices,
/// from which six folds run: three up and three down.
struct Tip {
  Sheet sheet = test::hex_sheet(side, side, 7);
  int vertex;
  Tip() : vertex(vertex_near(sheet, 0.05, 0.05)) {
    sheet.v = Points3::Zero(sheet.x.rows(), 3);
    for (const Vector2d& p : {Vector2d(0.02, 0.02), Vector2d(0.08, 0.02), Vector2d(0.02, 0.08)})
      sheet.singular.push_back(
          {sheet.pattern.row(vertex_near(sheet, p.x(), p.y())).transpose(), 1, "test"});
    sheet.x(vertex, 2) = height;
  }
};

LocalEnergies stored_in(const Sheet& sheet, const Vector2d& force) {
  LocalEnergies stored{Eigen::VectorXd::Zero(sheet.triangles.rows()),
                       Eigen::VectorXd::Constant(sheet.triangles.rows(), 1e-6),
                       Points2::Zero(sheet.pattern.rows(), 2)};
  stored.configurational_force.rowwise() = force.transpose();
  return stored;
}

CrumpledMesh mesh_of() { return {test::rectangle(side, side), Paper{}, CrumpleOptions{}, 1, 0}; }

TEST(CrumpledMeshTest, AVertexWhereFoldsMeetBecomesAPointAfterTheSameWayInAnyNumberOfSteps) {
  const std::vector<char> fixed;
  const auto travel_to_birth = [&](double travel) {
    CrumpledMesh crumpled = mesh_of();
    Tip tip;
    for (int step = 1; step <= 100; ++step) {
      Sheet now = tip.sheet;
      const LocalEnergies stored = stored_in(now, {0, 0});
      if (crumpled.step(now, {fixed, stored, travel, step}).births > 0) {
        // the sharpest comes first: the tip
        const Vector2d p = now.singular[tip.sheet.singular.size()].pattern;
        EXPECT_LT((now.pattern.rowwise() - p.transpose()).rowwise().norm().minCoeff(), 1e-12);
        EXPECT_LT((p - Vector2d(tip.sheet.pattern.row(tip.vertex))).norm(), 0.02);
        return step * travel;
      }
    }
    return 0.0;
  };
  const double travel = travel_to_birth(0.0005);
  EXPECT_GT(travel, 0);
  EXPECT_NEAR(travel_to_birth(0.00025), travel, 0.0003);
  EXPECT_NEAR(travel_to_birth(0.001), travel, 0.001);
}

TEST(CrumpledMeshTest, ASheetWithoutFoldsBearsNothing) {
  Tip tip;
  tip.sheet.x.col(2).setZero();
  CrumpledMesh crumpled = mesh_of();
  const LocalEnergies stored = stored_in(tip.sheet, {1, 0});
  for (int step = 1; step <= 20; ++step) {
    Sheet now = tip.sheet;
    const CrumpleReport report = crumpled.step(now, {{}, stored, 0.004, step});
    EXPECT_EQ(report.births, 0);
    EXPECT_EQ(report.moves, 0);  // no fold ends anywhere
  }
}

TEST(CrumpledMeshTest, VerticesSlideAlongTheForceAndStayOnTheSurface) {
  Tip tip;
  const Sheet before = tip.sheet;
  CrumpledMesh crumpled = mesh_of();
  const LocalEnergies stored = stored_in(before, {1, 0});
  std::vector<char> fixed(before.pattern.rows(), 0);
  for (int v = 0; v < before.pattern.rows(); ++v)  // the ring of the tip is free
    fixed[v] = (before.pattern.row(v) - before.pattern.row(tip.vertex)).norm() > 0.02;
  const CrumpleReport report = crumpled.step(tip.sheet, {fixed, stored, 0.001, 1});
  ASSERT_EQ(report.births, 0);
  ASSERT_GT(report.moves, 0);
  ASSERT_EQ(tip.sheet.pattern.rows(), before.pattern.rows());
  const VertexRings rings(before.triangles, find_hinges(before.triangles), before.pattern.rows());
  for (int v = 0; v < before.pattern.rows(); ++v) {
    const Eigen::RowVector2d moved = tip.sheet.pattern.row(v) - before.pattern.row(v);
    if (moved.isZero(0)) continue;
    EXPECT_FALSE(rings.border[v] || fixed[v]);
    EXPECT_GT(moved.x(), 0);
    EXPECT_EQ(moved.y(), 0);
    EXPECT_LT(moved.norm(), 0.2 * ring_size(before, rings, v));
    // the surface there is as high as it was, or lower where the vertex has cut the tip off
    EXPECT_LE(tip.sheet.x(v, 2), height);
    EXPECT_GE(tip.sheet.x(v, 2), 0);
  }
  EXPECT_GT(tip.sheet.pattern(tip.vertex, 0), before.pattern(tip.vertex, 0));
  for (const SingularPoint& s : before.singular)
    EXPECT_LT((tip.sheet.pattern.rowwise() - s.pattern.transpose()).rowwise().norm().minCoeff(),
              1e-12);
  test::expect_sound(tip.sheet, side * side);
}

/// Whatever the first mesh, its edges come to the same length. Handles, corners and singular points
/// stay.
TEST(CrumpledMeshTest, EdgesComeToTheLengthOfTheSizeField) {
  const auto settled = [&](double edge) {
    const Pattern square = test::rectangle(side, side);
    const std::vector<Vector2d> points{{0.03, 0.04}, {0.031, 0.04}};
    PatternMesh mesh = mesh_pattern(square, edge, points);
    const int handles = number_points_first(mesh);
    Sheet sheet = test::flat_sheet(mesh.vertices, mesh.triangles);
    sheet.singular = Tip().sheet.singular;
    for (SingularPoint& s : sheet.singular)
      s.pattern = sheet.pattern.row(vertex_near(sheet, s.pattern.x(), s.pattern.y()));
    const std::vector<char> fixed(handles, 1);
    CrumpledMesh crumpled = mesh_of();
    for (int step = 1; step <= 30; ++step) {
      const LocalEnergies stored = stored_in(sheet, {0, 0});
      crumpled.step(sheet, {fixed, stored, 0.004, step});
    }
    for (int k = 0; k < handles; ++k) EXPECT_TRUE(sheet.pattern.row(k) == mesh.vertices.row(k));
    test::expect_sound(sheet, side * side);
    return sheet.triangles.rows();
  };
  const double coarse = settled(0.03), fine = settled(0.006);
  // the meshes that they began with have 25 times as many triangles as each other
  EXPECT_LT(fine, 2 * coarse);
  EXPECT_LT(coarse, 2 * fine);
}

TEST(CrumpledMeshTest, HasNoMoreTrianglesThanItMay) {
  Tip tip;  // its facets are larger than those that the paper would have
  tip.sheet.x.col(2).setZero();
  CrumpleOptions options;
  options.max_triangles = static_cast<int>(tip.sheet.triangles.rows()) + 10;
  const auto settled = [&](const CrumpleOptions& how) {
    CrumpledMesh crumpled(test::rectangle(side, side), Paper{}, how, 1, 0);
    Sheet sheet = tip.sheet;
    for (int step = 1; step <= 10; ++step) {
      // a membrane that stores much asks for finer facets
      LocalEnergies stored = stored_in(sheet, {0, 0});
      stored.membrane.setConstant(1e-4);
      crumpled.step(sheet, {{}, stored, 0.004, step});
    }
    return static_cast<int>(sheet.triangles.rows());
  };
  EXPECT_GT(settled({}), options.max_triangles);
  EXPECT_LE(settled(options), options.max_triangles);
  EXPECT_GT(settled(options), options.max_triangles - 10);
}

/// A sheet that is jammed gets finer facets, without any travel, where its membrane stores what
/// folds would not; one whose membrane stores little is jammed for another reason, and keeps its
/// mesh.
TEST(CrumpledMeshTest, AJammedSheetIsRefinedOnlyWhereItsMeshCannotFold) {
  const auto added = [](double membrane) {
    Tip tip;
    CrumpledMesh crumpled = mesh_of();
    const auto before = tip.sheet.triangles.rows();
    for (int time = 0; time < 4; ++time) {
      LocalEnergies stored = stored_in(tip.sheet, {0, 0});
      stored.membrane = membrane * stored.bending;
      const std::vector<char> fixed(tip.sheet.pattern.rows(), 0);
      crumpled.refine_where_jammed(tip.sheet, fixed, stored);
    }
    test::expect_sound(tip.sheet, side * side);
    return tip.sheet.triangles.rows() - before;
  };
  EXPECT_EQ(added(0.3), 0);
  EXPECT_GT(added(10), 50);
}

TEST(FacetSizesTest, ShrinkWhereTheyAreRefinedAndAreReadBackAsTheyWere) {
  const Paper paper;
  FacetSizes sizes(test::rectangle(side, side), paper);
  const double before = sizes.at({0.05, 0.05}), ridge = ridge_width(paper, side);
  EXPECT_NEAR(before, 6 * ridge, 1e-12);
  sizes.refine({0.05, 0.05}, 0.01, 0.5);
  EXPECT_NEAR(sizes.at({0.05, 0.05}), 0.5 * before, 1e-12);
  EXPECT_EQ(sizes.at({0.08, 0.05}), before);
  for (int k = 0; k < 20; ++k) sizes.refine({0.05, 0.05}, 0.01, 0.5);
  EXPECT_NEAR(sizes.at({0.05, 0.05}), ridge, 1e-12);

  Serializer written;
  sizes.archive(written);
  FacetSizes read(test::rectangle(side, side), paper);
  Serializer bytes(written.bytes());
  read.archive(bytes);
  EXPECT_EQ(read.at({0.05, 0.05}), sizes.at({0.05, 0.05}));
  std::string broken = written.bytes();
  std::fill(broken.begin() + 8, broken.begin() + 16, '\xff');  // the first length is no number
  Serializer wrong(broken);
  EXPECT_THROW(read.archive(wrong), Error);
}

TEST(LastingPlacesTest, AddsUpTheWayForWhichSomethingIsSeen) {
  LastingPlaces places;
  EXPECT_EQ(places.see({{{0, 0}, 0.01}}, 0.25), std::vector<double>{0.25});
  // it has moved a little; another one appears
  EXPECT_EQ(places.see({{{0.005, 0}, 0.01}, {{1, 0}, 0.01}}, 0.5),
            (std::vector<double>{0.75, 0.5}));
  EXPECT_EQ(places.places().size(), 2u);
  // what was not seen for a step is new when it comes back
  EXPECT_EQ(places.see({{{1, 0}, 0.01}}, 1), std::vector<double>{1.5});
  EXPECT_EQ(places.see({{{0.005, 0}, 0.01}}, 1), std::vector<double>{1});
}

TEST(VertexMovesTest, AMoveThatWouldTurnATriangleOverIsCutShort) {
  Tip tip;
  const Sheet before = tip.sheet;
  const VertexRings rings(before.triangles, find_hinges(before.triangles), before.pattern.rows());
  const Vector2d from = before.pattern.row(tip.vertex);
  const double h = ring_size(before, rings, tip.vertex);
  const double part = move_vertex(tip.sheet, rings, tip.vertex, from + Vector2d(1.2 * h, 0));
  EXPECT_LT(part, 1);
  test::expect_sound(tip.sheet, side * side);
  // on the old surface
  const MeshPoint place = PointLocator(before.pattern, before.triangles)
                              .locate(tip.sheet.pattern.row(tip.vertex).transpose());
  EXPECT_LT((interpolate(place, before.triangles, before.x) - Vector3d(tip.sheet.x.row(tip.vertex)))
                .norm(),
            1e-12);
}

}  // namespace
}  // namespace paperbake
