#include "core/render/crease_memory.h"

#include "core/geometry/measure.h"
#include "core/render/creased_normals.h"
#include "core/render/curved_surface.h"
#include "core/render/render_mesh.h"
#include "core/render/shot_record.h"
#include "tests/core/test_meshes.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

constexpr double width = 0.03, middle = 0.05;  // [m]

/// Folds a sheet along x = middle. turn  [rad]
void fold(Sheet& sheet, double turn) {
  for (int v = 0; v < sheet.x.rows(); ++v) {
    const double s = sheet.pattern(v, 0) - middle, beyond = std::max(s, 0.0);
    sheet.x.row(v) << middle + std::min(s, 0.0) + beyond * std::cos(turn), sheet.pattern(v, 1),
        beyond * std::sin(turn);
  }
}

/// A sheet with one edge along the fold, or with two.
Sheet crumpled_sheet(int singular_points, bool divided = false) {
  Sheet sheet = test::strip_sheet(2 * middle, width, 4);
  if (divided) {  // vertices 4 and 5 are the ends of the edge, 3 and 6 what it is opposite of
    sheet.pattern.conservativeResize(sheet.pattern.rows() + 1, 2);
    const int half = static_cast<int>(sheet.pattern.rows()) - 1;
    sheet.pattern.row(half) << middle, width / 2;
    Triangles all(sheet.triangles.rows() + 2, 3);
    int n = 0;
    for (int t = 0; t < sheet.triangles.rows(); ++t) {
      const Eigen::RowVector3i corners = sheet.triangles.row(t);
      if (!(corners.array() == 4).any() || !(corners.array() == 5).any()) {
        all.row(n++) = corners;
        continue;
      }
      for (const int end : {4, 5})
        all.row(n++) = (corners.array() == end).select(Eigen::RowVector3i::Constant(half), corners);
    }
    sheet = test::flat_sheet(sheet.pattern, all);
  }
  sheet.singular.resize(singular_points);
  return sheet;
}

void record(ShotRecord& shot, Sheet sheet, double turn) {
  fold(sheet, turn);
  AnimatedFrame frame;
  frame.sheet = &sheet;
  shot.add(frame);
}

double bulge(const ShotRecord& shot, int frame) {
  return curve(shot.sheet(shot.frames()[frame]), {}).bulge.cwiseAbs().maxCoeff();
}

TEST(CreaseMemoryTest, AnEdgeOfACrumpledSheetThatWasACreaseStaysOneWhenItOpens) {
  for (const int points : {2, points_of_a_crumple}) {
    ShotRecord shot;
    record(shot, crumpled_sheet(points), 0.3);  // never more than that: smooth
    record(shot, crumpled_sheet(points), 1.2);
    record(shot, crumpled_sheet(points), 0.3);
    record(shot, crumpled_sheet(points, true), 0.2);
    EXPECT_TRUE(shot.frames()[0].remembered.empty());
    EXPECT_TRUE(shot.frames()[1].remembered.empty())
        << "it is a crease, and need not be remembered";
    EXPECT_GT(bulge(shot, 0), 1e-4);
    if (points < points_of_a_crumple) {
      EXPECT_TRUE(shot.frames()[2].remembered.empty()) << "a bend of smooth paper";
      EXPECT_GT(bulge(shot, 2), 1e-4);
      continue;
    }
    ASSERT_EQ(shot.frames()[2].remembered.size(), 1U);
    EXPECT_EQ(shot.frames()[2].remembered[0].share, 1);
    EXPECT_EQ(shot.frames()[3].remembered.size(), 2U) << "both halves of the edge";
    for (const int k : {2, 3}) EXPECT_LT(bulge(shot, k), 1e-8) << "flat on both sides, in 32 bits";
  }
}

TEST(CreaseMemoryTest, CreasesOfAnotherMeshAreFoundAlongTheEdge) {
  const RenderMesh mesh =
      mesh_for_render(test::rectangle(2 * middle, width), 0.004,
                      {{}, {{{middle, 0.0}, {middle, width}}, {{0.02, 0.0}, {0.02, width}}}});
  const CreasesOfMesh creases(mesh.pattern, mesh.creases);
  Sheet sheet = crumpled_sheet(points_of_a_crumple);
  EXPECT_TRUE(creases.least_shares(sheet.pattern, {}).empty());
  sheet.remembered = {{5, 4, 0.7}};
  const std::vector<double> shares = creases.least_shares(sheet.pattern, sheet.remembered);
  ASSERT_EQ(shares.size(), mesh.creases.size());
  int along = 0;
  for (std::size_t c = 0; c < shares.size(); ++c) {
    const bool is_there = std::abs(mesh.pattern(mesh.creases[c].first, 0) - middle) < 1e-6;
    EXPECT_EQ(shares[c], is_there ? 0.7 : 0.0);
    along += is_there;
  }
  EXPECT_GT(along, 3);
  EXPECT_LT(along, static_cast<int>(shares.size()));
}

TEST(CreaseMemoryTest, NormalsAreSplitAtACreaseThatIsRememberedHoweverSmallItsAngle) {
  const RenderMesh mesh = mesh_for_render(test::rectangle(2 * middle, width), 0.004,
                                          {{}, {{{middle, 0.0}, {middle, width}}}});
  Sheet sheet = test::flat_sheet(mesh.pattern, mesh.triangles);
  constexpr double turn = 0.2;
  fold(sheet, turn);
  const CreasedNormals creased(mesh.triangles, mesh.creases);
  const auto most_apart = [&](const Points3& normals) {  // [rad] from that of a triangle
    double most = 0;
    for (int t = 0; t < mesh.triangles.rows(); ++t) {
      const auto at = [&](int i) -> Vector3d { return sheet.x.row(mesh.triangles(t, i)); };
      const Vector3d flat = triangle_normal(at(0), at(1), at(2));
      for (int i = 0; i < 3; ++i)
        most = std::max(most, angle_between(flat, normals.row(creased.of_corner()(t, i))));
    }
    return most;
  };
  EXPECT_GT(most_apart(creased.normals(sheet.x)), 0.3 * turn);
  const std::vector<double> whole(mesh.creases.size(), 1.0), half(mesh.creases.size(), 0.5);
  EXPECT_LT(most_apart(creased.normals(sheet.x, whole)), 1e-6);
  const double between = most_apart(creased.normals(sheet.x, half));
  EXPECT_GT(between, 0.1 * turn);
  EXPECT_LT(between, most_apart(creased.normals(sheet.x)));
}

TEST(CreaseMemoryTest, EachCreaseHasItsOwnLeastShare) {
  // three lines, all nearly flat: the paper is smooth along those that are not remembered
  const RenderMesh mesh = mesh_for_render(test::rectangle(2 * middle, width), 0.004,
                                          {{},
                                           {{{0.02, 0.0}, {0.02, width}},
                                            {{middle, 0.0}, {middle, width}},
                                            {{0.08, 0.0}, {0.08, width}}}});
  Sheet sheet = test::flat_sheet(mesh.pattern, mesh.triangles);
  test::roll(sheet, 0.05);
  std::vector<double> least;
  for (const auto& [a, b] : mesh.creases)
    least.push_back(std::abs(mesh.pattern(a, 0) - middle) < 1e-6 &&
                    std::abs(mesh.pattern(b, 0) - middle) < 1e-6);
  ASSERT_EQ(std::count(least.begin(), least.end(), 1.0), static_cast<int>(least.size()) / 3);
  const CreasedNormals creased(mesh.triangles, mesh.creases);
  const Points3 normals = creased.normals(sheet.x, least);
  double split = 0, smooth = 0;  // [rad] between the normals of two corners at one inner vertex
  for (int t = 0; t < mesh.triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i) {
      const int v = mesh.triangles(t, i);
      const Vector2d p = mesh.pattern.row(v);
      if (p.y() < 1e-9 || p.y() > width - 1e-9) continue;
      const double apart = angle_between(normals.row(v), normals.row(creased.of_corner()(t, i)));
      (std::abs(p.x() - middle) < 1e-6 ? split : smooth) =
          std::max(std::abs(p.x() - middle) < 1e-6 ? split : smooth, apart);
    }
  EXPECT_GT(split, 0.02);
  EXPECT_LT(smooth, 1e-7);
}

}  // namespace
}  // namespace paperbake
