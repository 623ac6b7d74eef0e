#include "core/geometry/curvature.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>

namespace paperbake {
namespace {

/// Regular grid over side x side [m], its cells split along alternating diagonals, in the plane
/// z = 0.
Sheet flat_grid(double side, int cells) {
  Sheet sheet;
  const int n = cells + 1;
  sheet.pattern.resize(n * n, 2);
  sheet.triangles.resize(2 * cells * cells, 3);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) sheet.pattern.row(j * n + i) << side * i / cells, side * j / cells;
  for (int j = 0, t = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i, t += 2) {
      const int a = j * n + i, b = a + 1, c = b + n, d = a + n;
      if ((i + j) % 2) {
        sheet.triangles.row(t) << a, b, c;
        sheet.triangles.row(t + 1) << a, c, d;
      } else {
        sheet.triangles.row(t) << a, b, d;
        sheet.triangles.row(t + 1) << b, c, d;
      }
    }
  sheet.x = Points3::Zero(n * n, 3);
  sheet.x.leftCols<2>() = sheet.pattern;
  sheet.v = Points3::Zero(n * n, 3);
  return sheet;
}

/// Rolls the sheet into a cylinder of curvature k [1/m] whose rulings have an angle of `angle`
/// [rad] to the pattern's y axis. k > 0: the middle rises towards +z, the counter-clockwise normal.
void roll(Sheet& sheet, double k, double angle) {
  const Vector2d across(std::cos(angle), std::sin(angle)), along(-std::sin(angle), std::cos(angle));
  const Vector2d middle =
      0.5 * (sheet.pattern.colwise().minCoeff() + sheet.pattern.colwise().maxCoeff());
  for (int v = 0; v < sheet.pattern.rows(); ++v) {
    const Vector2d p = sheet.pattern.row(v).transpose() - middle;
    const double s = p.dot(across), t = p.dot(along);
    const Vector2d flat = across * (std::sin(k * s) / k) + along * t;
    sheet.x.row(v) << flat.x(), flat.y(), (std::cos(k * s) - 1) / k;
  }
}

/// Vertices whose one-ring has no border edge: at least two cells from the border of a
/// flat_grid(side, cells).
std::vector<int> inner_vertices(int cells) {
  std::vector<int> inner;
  for (int j = 2; j <= cells - 2; ++j)
    for (int i = 2; i <= cells - 2; ++i) inner.push_back(j * (cells + 1) + i);
  return inner;
}

TEST(CurvatureTest, CylinderHasOneOverItsRadiusAcrossAndZeroAlong) {
  for (const double k : {20.0, -20.0})  // bulging towards the normal, then away from it
    for (const double angle : {0.0, 0.6}) {
      Sheet sheet = flat_grid(0.1, 24);
      roll(sheet, k, angle);
      const Points3 S = vertex_curvature(sheet);
      // the mean over all inner vertices is exact up to the turning angle of one edge; single
      // vertices of this grid have an uneven ring and errors of a few percent
      Vector3d mean = Vector3d::Zero();
      for (const int v : inner_vertices(24))
        mean += S.row(v).transpose() / inner_vertices(24).size();
      const Principal p = principal_curvature(mean);
      EXPECT_NEAR(p.k1, k, 0.02 * std::abs(k)) << "angle " << angle;
      EXPECT_NEAR(p.k2, 0, 0.02 * std::abs(k)) << "angle " << angle;
      EXPECT_NEAR(std::abs(p.across.dot(Vector2d(std::cos(angle), std::sin(angle)))), 1, 1e-3);
      for (const int v : inner_vertices(24))
        EXPECT_NEAR(principal_curvature(S.row(v).transpose()).k1, k, 0.08 * std::abs(k));
    }
}

TEST(CurvatureTest, FoldIsSpreadOverTheAreaOfTheRing) {
  // folded by theta along the middle line x = 2h of four cells; the ring is complete, and every
  // term of the formula is computed by hand
  Sheet sheet = flat_grid(0.04, 4);
  const double h = 0.01, theta = 0.3;
  const int centre = 12;
  for (int v = 0; v < 25; ++v) {
    const double s = sheet.pattern(v, 0) - 2 * h;
    if (s > 1e-9)
      sheet.x.row(v) << 2 * h + s * std::cos(theta), sheet.pattern(v, 1), -s * std::sin(theta);
  }
  const Points3 S = vertex_curvature(sheet);
  // both halves of the fold are spokes of the centre; its ring has 4 or 8 triangles, depending on
  // the diagonals
  double ring = 0;
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    if ((sheet.triangles.row(t).array() == centre).any()) ring += 0.5 * h * h;
  EXPECT_NEAR(S(centre, 0), theta * 2 * h / ring, 1e-9);
  EXPECT_NEAR(S(centre, 1), 0, 1e-9);
  EXPECT_NEAR(S(centre, 2), 0, 1e-9);
}

TEST(CurvatureTest, BorderVerticesSeeTheBendingAcrossTheBorder) {
  const double k = 20;
  Sheet sheet = flat_grid(0.1, 20);
  // the borders x = 0 and x = 0.1 are rulings: half of each ring there is missing with its folds
  roll(sheet, k, 0);
  const Points3 S = vertex_curvature(sheet);
  for (int j = 1; j < 20; ++j)
    for (const int i : {0, 1, 19, 20}) EXPECT_NEAR(S(j * 21 + i, 0), k, 0.15 * k) << i << " " << j;
}

TEST(CurvatureTest, RingsOfObtuseTrianglesAreKnown) {
  // Narrow triangles, and a vertex far from the middle of its ring: some tensors show a cylinder
  // that bends in two directions.
  constexpr int cells = 8, n = cells + 1, moved = 4 * n + 5;
  constexpr double k = 20;  // [1/m]
  Sheet sheet = flat_grid(0.1, cells);
  sheet.pattern.col(0) *= 0.15;
  sheet.pattern(moved, 1) += 0.8 * 0.1 / cells;
  roll(sheet, k, 0.5);
  const Hinges hinges = find_hinges(sheet.triangles);
  const std::vector<char> obtuse = obtuse_rings(sheet.pattern, sheet.triangles, hinges);
  EXPECT_TRUE(obtuse[moved]);
  const Points3 curvature = vertex_curvature(sheet);
  bool shows_two = false;
  for (int v = 0; v < n * n; ++v) {
    const int i = v % n, j = v / n;
    if (i == 0 || j == 0 || i == cells || j == cells) {
      EXPECT_FALSE(obtuse[v]) << "a border cuts ring " << v;
      continue;
    }
    const Principal bend = principal_curvature(curvature.row(v));
    if (obtuse[v])
      shows_two |= std::abs(bend.k2) > 0.2 * k;
    else
      EXPECT_LT(std::abs(bend.k2), 0.2 * k) << v;
  }
  EXPECT_TRUE(shows_two) << "that is why they are left out";
  sheet.pattern(moved, 1) -= 0.8 * 0.1 / cells;
  for (const char one : obtuse_rings(sheet.pattern, sheet.triangles, hinges)) EXPECT_FALSE(one);
}

TEST(CurvatureTest, RigidMotionDoesNotChangeTheCurvature) {
  Sheet sheet = flat_grid(0.1, 8);
  roll(sheet, 15, 0.4);
  const Points3 before = vertex_curvature(sheet);
  ASSERT_GT(before.norm(), 100);
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(1.1, Vector3d(1, 2, -0.5).normalized()).toRotationMatrix();
  sheet.x = (sheet.x * R.transpose()).rowwise() + Eigen::RowVector3d(3, -2, 5);
  EXPECT_LT((vertex_curvature(sheet) - before).norm(), 1e-9 * before.norm());
}

TEST(CurvatureTest, PrincipalCurvaturesRebuildTheTensorWithTheLargerFirst) {
  for (const Vector3d& tensor : {Vector3d(3, 1, -8), Vector3d(5, -2, 1), Vector3d(-4, 0, -4),
                                 Vector3d(0, 7, 0), Vector3d(2, 0, 6)}) {
    const Principal p = principal_curvature(tensor);
    EXPECT_GE(std::abs(p.k1), std::abs(p.k2));
    const Vector2d across = p.across, along(-across.y(), across.x());
    const Eigen::Matrix2d M = p.k1 * across * across.transpose() + p.k2 * along * along.transpose();
    EXPECT_NEAR(M(0, 0), tensor[0], 1e-12);
    EXPECT_NEAR(M(0, 1), tensor[1], 1e-12);
    EXPECT_NEAR(M(1, 1), tensor[2], 1e-12);
  }
}

}  // namespace
}  // namespace paperbake
