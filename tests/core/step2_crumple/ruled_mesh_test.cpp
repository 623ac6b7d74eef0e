#include "core/step2_crumple/ruled_mesh.h"
#include "core/model/segment2.h"

#include "core/geometry/hinges.h"
#include "core/geometry/pattern_mesh.h"
#include "core/step2_crumple/remesh_schedule.h"
#include "tests/core/test_cones.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <set>

namespace paperbake {
namespace {

struct Quality {
  double area = 0, min_altitude = 1;
  long euler = 0;
};
Quality quality(const RuledMesh& mesh) {
  Quality q;
  std::set<std::pair<int, int>> edges;
  for (int t = 0; t < mesh.triangles.rows(); ++t) {
    const Vector2d a = mesh.pattern.row(mesh.triangles(t, 0)),
                   b = mesh.pattern.row(mesh.triangles(t, 1)),
                   c = mesh.pattern.row(mesh.triangles(t, 2));
    q.area += 0.5 * cross(b - a, c - a);
    q.min_altitude =
        std::min(q.min_altitude,
                 cross(b - a, c - a) / std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()}));
    for (int i = 0; i < 3; ++i)
      edges.insert(std::minmax(mesh.triangles(t, i), mesh.triangles(t, (i + 1) % 3)));
  }
  q.euler = mesh.pattern.rows() - static_cast<long>(edges.size()) + mesh.triangles.rows();
  return q;
}

/// Fraction of the length of a ruling that is covered by edges of the mesh, within `beside` [m].
double covered(const RuledMesh& mesh, const Ruling& r, double beside) {
  std::set<std::pair<int, int>> edges;
  for (int t = 0; t < mesh.triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i)
      edges.insert(std::minmax(mesh.triangles(t, i), mesh.triangles(t, (i + 1) % 3)));
  const Vector2d d = (r.b - r.a).normalized();
  double sum = 0;
  for (const auto& [i, j] : edges) {
    const Vector2d p = mesh.pattern.row(i).transpose() - r.a,
                   q = mesh.pattern.row(j).transpose() - r.a;
    if (std::abs(cross(d, p)) < beside && std::abs(cross(d, q)) < beside)
      sum += std::abs((q - p).dot(d));
  }
  return sum / r.length();
}

struct Ruled {
  BaseMesh base;
  std::vector<Vector2d> required;
  std::vector<Ruling> rulings;
  std::optional<RuledMesh> mesh;
};

/// The ruled mesh of a sheet rolled to radius R [m], with a row of required points along its left
/// border, one inside, and a singular point.
Ruled rule(double R, const RulingOptions& options = {}) {
  Ruled ruled;
  const Pattern pattern = test::rectangle(0.1, 0.1);
  for (int i = 0; i <= 5; ++i) ruled.required.emplace_back(0, 0.02 * i);
  ruled.required.emplace_back(0.0521, 0.0437);
  const PatternMesh first = mesh_pattern_with(pattern, 90, ruled.required);
  ruled.base = base_mesh(first.vertices, first.triangles);
  Sheet sheet = test::hex_sheet(0.1, 0.1, 20);
  test::roll(sheet, R);
  const BendingField field(sheet, vertex_curvature(sheet));
  Regions regions(pattern, options);
  regions.update(field);
  ruled.rulings = place_rulings(ruled.base.polygons, field, regions, {}, ruled.base.h, options);
  ruled.mesh = ruled_mesh(ruled.base, ruled.required, {{0.03, 0.06}}, ruled.rulings, {}, options);
  return ruled;
}

TEST(RuledMeshTest, BaseMeshKnowsItsCornersHolesAndInnerPoints) {
  Pattern pattern = test::rectangle(0.1, 0.08);
  pattern.holes.push_back({{0.04, 0.03}, {0.04, 0.05}, {0.06, 0.05}, {0.06, 0.03}});
  const PatternMesh mesh = mesh_pattern(pattern, 0.01, {});
  const BaseMesh base = base_mesh(mesh.vertices, mesh.triangles);
  EXPECT_EQ(base.polygons.outline.size(), 4u);
  ASSERT_EQ(base.polygons.holes.size(), 1u);
  EXPECT_EQ(base.polygons.holes[0].size(), 4u);
  EXPECT_NEAR(area(base.polygons), 0.1 * 0.08 - 0.02 * 0.02, 1e-15);
  EXPECT_GT(base.inner.size(), 20u);
  for (const Vector2d& p : base.inner)
    EXPECT_GT((nearest_border_point(pattern, p) - p).norm(), 1e-3);
}

TEST(RuledMeshTest, CoversThePatternWithTheRequiredPointsFirst) {
  for (double R : {0.03, 0.06, 0.15}) {
    const Ruled ruled = rule(R);
    ASSERT_TRUE(ruled.mesh) << R;
    const Quality q = quality(*ruled.mesh);
    EXPECT_NEAR(q.area, 0.01, 1e-14);
    EXPECT_EQ(q.euler, 1);
    EXPECT_GT(q.min_altitude, 0.03 * ruled.base.h);
    for (std::size_t i = 0; i < ruled.required.size(); ++i)
      EXPECT_TRUE(ruled.mesh->pattern.row(i).transpose() == ruled.required[i]);
    // the singular point is a vertex
    EXPECT_TRUE((ruled.mesh->pattern.rowwise() - Eigen::RowVector2d(0.03, 0.06))
                    .rowwise()
                    .norm()
                    .minCoeff() == 0);
  }
}

TEST(RuledMeshTest, EdgesFollowTheRulings) {
  const Ruled ruled = rule(0.06);
  ASSERT_TRUE(ruled.mesh);
  ASSERT_GE(ruled.rulings.size(), 10u);
  int whole = 0;
  for (const Ruling& r : ruled.rulings)
    whole += covered(*ruled.mesh, r, RulingOptions{}.merge_distance * ruled.base.h) > 0.99;
  EXPECT_EQ(whole, int(ruled.rulings.size()));
}

TEST(RuledMeshTest, PointsBesideTheBorderDoNotForbidRulings) {
  // the rim of a finger that holds a corner of the sheet is nearer to the border than any other
  // vertex
  const std::vector<Vector2d> required{{0.01, 0.01}, {0.015, 0.0006}, {0.005, 0.0006}};
  const PatternMesh first = mesh_pattern_with(test::rectangle(0.2, 0.2), 120, required);
  const BaseMesh base = base_mesh(first.vertices, first.triangles);
  ASSERT_LT(base.least_altitude, 0.03 * base.h) << "a needle that no mesh can do without";
  const RulingOptions options;
  const Ruling ruling{{0.1, 0}, {0.1, 0.2}};
  const auto mesh = ruled_mesh(base, required, {}, {ruling}, {}, options);
  ASSERT_TRUE(mesh);
  EXPECT_NEAR(covered(*mesh, ruling, 1e-9), 1, 1e-9);
  // a worse one is still refused
  std::vector<Vector2d> worse = required;
  worse.emplace_back(0.1, 0.1999);
  EXPECT_FALSE(ruled_mesh(base, worse, {}, {{{0, 0.1}, {0.2, 0.1}}}, {}, options));
}

TEST(RuledMeshTest, OneOfTwoRulingsThatCrossIsLeftOut) {
  Ruled ruled = rule(0.06);
  const std::vector<Ruling> crossed{{{0.02, 0.0}, {0.08, 0.1}, 10, 0},
                                    {{0.08, 0.0}, {0.02, 0.1}, 10, 0}};
  const auto mesh = ruled_mesh(ruled.base, {}, {}, crossed, {}, {});
  ASSERT_TRUE(mesh);
  EXPECT_NEAR(quality(*mesh).area, 0.01, 1e-14);
  EXPECT_GT(covered(*mesh, crossed[0], 1e-9), 0.99);
  EXPECT_LT(covered(*mesh, crossed[1], 1e-9), 0.6);
}

TEST(RuledMeshTest, RulingThatEndsInTheMiddleOfAnotherMakesNoSliver) {
  Ruled ruled = rule(0.06);
  const double h = ruled.base.h;
  const std::vector<Ruling> tee{{{0.02, 0.0}, {0.02, 0.1}, 10, 0},
                                {{0.02 + 0.1 * h, 0.05}, {0.1, 0.055}, 10, 0}};
  const auto mesh = ruled_mesh(ruled.base, {}, {}, tee, {}, {});
  ASSERT_TRUE(mesh);
  EXPECT_GT(quality(*mesh).min_altitude, 0.09 * h);
  EXPECT_GT(covered(*mesh, tee[0], 0.2 * h), 0.99);
}

TEST(RuledMeshTest, OptionsSetTheVerticesOfTheMesh) {
  const auto vertices = [](const RulingOptions& options) {
    return rule(0.06, options).mesh->pattern.rows();
  };
  RulingOptions longer, merging;
  longer.along_most = 4;
  merging.merge_distance = 0.35;
  EXPECT_LT(vertices(longer), 0.8 * vertices({}));
  EXPECT_NE(vertices(merging), vertices({}));
}

TEST(RuledMeshTest, AllPointsOfTheBaseMeshStayInAKeepOutDisc) {
  Ruled ruled = rule(0.06);
  const Disc guard{{0.1, 0.05}, 0.03};
  const auto mesh = ruled_mesh(ruled.base, {}, {}, {}, {guard}, {});
  ASSERT_TRUE(mesh);
  int inside = 0;
  for (const Vector2d& p : ruled.base.inner) {
    if ((p - guard.centre).norm() >= guard.radius) continue;
    ++inside;
    EXPECT_LT((mesh->pattern.rowwise() - p.transpose()).rowwise().norm().minCoeff(), 1e-15);
  }
  EXPECT_GE(inside, 3);
}

TEST(RuledMeshTest, SameInputGivesTheSameMesh) {
  const Ruled a = rule(0.045), b = rule(0.045);
  ASSERT_TRUE(a.mesh && b.mesh);
  EXPECT_TRUE(a.mesh->pattern == b.mesh->pattern && a.mesh->triangles == b.mesh->triangles);
}

TEST(RuledMeshTest, MeshFitSeesEdgesAcrossTheRulingsAndLargeFolds) {
  const auto fit = [](int strips, double R) {
    Sheet sheet = test::strip_sheet(0.1, 0.1, strips);
    test::roll(sheet, R);
    const BendingField field(sheet, vertex_curvature(sheet));
    Regions regions(test::rectangle(0.1, 0.1), {});
    regions.update(field);
    return mesh_fit(sheet, field, regions);
  };
  EXPECT_NEAR(fit(20, 0.05).largest_fold, 0.1, 0.01);  // 0.1 m in 20 strips on a radius of 0.05 m
  EXPECT_NEAR(fit(10, 0.05).largest_fold, 0.2, 0.02);
  EXPECT_LT(fit(20, 0.05).misalignment, 0.05);
  Sheet lattice = test::hex_sheet(0.1, 0.1, 8);  // a third of its edges runs across
  test::roll(lattice, 0.05);
  const BendingField field(lattice, vertex_curvature(lattice));
  Regions regions(test::rectangle(0.1, 0.1), {});
  regions.update(field);
  EXPECT_GT(mesh_fit(lattice, field, regions).misalignment, 0.15);
}

TEST(RuledMeshTest, RemeshingBacksOffAfterRejectionsUntilOneIsAccepted) {
  for (const int rate : {1, 2, 5}) {  // waits are times, whatever the frame rate
    const double dt = 1 / (24.0 * rate);
    RemeshSchedule when;
    const MeshFit bad{0.5, 1.0};
    const auto wait = [&](int frame) {
      when.on_proposal_result(false, FrameTime{frame, dt});
      int next = frame;
      while (!when.due(bad, FrameTime{next, dt}, 0.2)) ++next;
      return next - frame;
    };
    EXPECT_TRUE(when.due(bad, FrameTime{1 * rate, dt}, 0.2));
    EXPECT_FALSE(when.due({0.05, 0.1}, FrameTime{1 * rate, dt}, 0.2));
    EXPECT_EQ(wait(1 * rate), 2 * rate);
    EXPECT_EQ(wait(3 * rate), 4 * rate);
    EXPECT_EQ(wait(7 * rate), 8 * rate);
    when.on_proposal_result(true, FrameTime{20 * rate, dt});
    EXPECT_FALSE(when.due(bad, FrameTime{21 * rate, dt}, 0.2));
    EXPECT_TRUE(when.due(bad, FrameTime{22 * rate, dt}, 0.2));
    // a large fold alone waits for four frames,
    EXPECT_FALSE(when.due({0.0, 0.3}, FrameTime{23 * rate, dt}, 0.2));
    EXPECT_TRUE(when.due({0.0, 0.3}, FrameTime{24 * rate, dt}, 0.2));
    // and a slight misalignment for six
    EXPECT_FALSE(when.due({0.2, 0.0}, FrameTime{25 * rate, dt}, 0.2));
    EXPECT_TRUE(when.due({0.2, 0.0}, FrameTime{26 * rate, dt}, 0.2));
    EXPECT_EQ(wait(30 * rate), 2 * rate);
  }
}

TEST(RuledMeshTest, FastSheetIsRemeshedSooner) {
  const MeshFit bad{0.5, 1.0};
  const auto wait = [&](double moved) {
    RemeshSchedule when;
    when.on_proposal_result(true, {0, 1 / 24.0});
    int frame = 1;
    while (!when.due(bad, {frame, 1 / 24.0, moved}, 0.2)) ++frame;
    return frame;
  };
  EXPECT_EQ(wait(0.001), 2);
  EXPECT_EQ(wait(0.02), 2);
  EXPECT_EQ(wait(0.05), 1);
}

}  // namespace
}  // namespace paperbake
