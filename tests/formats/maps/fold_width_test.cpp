// Angles of folds from curvatures do not depend on the mesh.

#include "formats/maps/fold_width.h"

#include "core/geometry/curvature.h"
#include "tests/formats/maps/crease_map_fixture.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

/// A flat grid folded by `angle` [rad] along the column of vertices at x = 0.05. jitter:
/// displacement of inner vertices, in edges
Sheet folded_grid(double edge, double angle, double jitter) {
  Sheet sheet = test::flat_sheet(0.1, 0.1, edge);
  for (int v = 0; v < sheet.pattern.rows(); ++v) {
    Vector2d p = sheet.pattern.row(v);
    const bool border = std::min({p.x(), p.y(), 0.1 - p.x(), 0.1 - p.y()}) < 1e-9,
               is_on_crease = std::abs(p.x() - 0.05) < 1e-9;
    if (!border)
      p += jitter * edge * Vector2d(is_on_crease ? 0 : std::sin(37.0 * v), std::sin(91.0 * v));
    sheet.pattern.row(v) = p;
    const double d = p.x() - 0.05;
    sheet.x.row(v) << (d > 0 ? d * std::cos(angle) : d), p.y(), (d > 0 ? -d * std::sin(angle) : 0);
  }
  return sheet;
}

TEST(FoldWidth, ACreaseHasTheAngleItWasFoldedByWhateverTheMesh) {
  for (const double edge : {0.0025, 0.01, 0.025})
    for (const double jitter : {0.0, 0.2})
      for (const double angle : {1.0, -1.6, 2.8}) {
        const Sheet sheet = folded_grid(edge, angle, jitter);
        double length = 0;  // [m] of the fold
        for (const SharpFold& fold :
             sharp_folds(sheet, find_hinges(sheet.triangles), vertex_curvature(sheet), {})) {
          EXPECT_NEAR(fold.angle, angle, 1e-9) << edge << ' ' << jitter << ' ' << angle;
          EXPECT_EQ(fold.plastic, 0);
          length += std::abs(sheet.pattern(fold.ends[0], 1) - sheet.pattern(fold.ends[1], 1));
          for (const int end : fold.ends) EXPECT_NEAR(sheet.pattern(end, 0), 0.05, 1e-9);
        }
        EXPECT_NEAR(length, 0.1, 1e-9);
        // the paper beside it is flat: what curvature spreads over the one-rings is not a turn, but
        // for what it leaves beyond those that are irregular
        const Points3 smooth = fold_tensors(
            vertex_curvature(sheet), fold_widths(sheet, find_hinges(sheet.triangles), 0.006));
        EXPECT_LT(smooth.cwiseAbs().maxCoeff(), 0.01 * std::abs(angle));
      }
}

TEST(FoldWidth, ACreaseKeepsAsMuchOfItsAngleAsOfItsCurvature) {
  for (const double jitter : {0.0, 0.2}) {
    const Sheet sheet = folded_grid(0.01, 1.0, jitter);
    const Points3 curvature = vertex_curvature(sheet);
    for (const SharpFold& fold :
         sharp_folds(sheet, find_hinges(sheet.triangles), curvature, -0.4 * curvature))
      EXPECT_NEAR(fold.plastic, -0.4, 1e-9);
  }
}

TEST(FoldWidth, RolledPaperTurnsByItsCurvatureWhateverTheMesh) {
  for (const double edge : {0.0025, 0.01}) {
    // dihedral angles of 0.25 rad at most are not creases
    const Sheet sheet = test::rolled(test::flat_sheet(0.1, 0.1, edge), 25);
    EXPECT_TRUE(
        sharp_folds(sheet, find_hinges(sheet.triangles), vertex_curvature(sheet), {}).empty());
    const Eigen::VectorXd width = fold_widths(sheet, find_hinges(sheet.triangles), 0.006);
    EXPECT_EQ(width.minCoeff(), 0.006);
    EXPECT_EQ(width.maxCoeff(), 0.006);
  }
}

TEST(FoldWidth, NoFoldTurnsBeyondShut) {
  Points3 curvature(3, 3);
  curvature << 500, 0, 500, 0, -1000, 0, 20, 0, 0;
  const Points3 folds = fold_tensors(curvature, Eigen::VectorXd::Constant(3, 0.01));
  EXPECT_DOUBLE_EQ(larger_principal(folds(0, 0), folds(0, 1), folds(0, 2)), max_fold_angle);
  EXPECT_DOUBLE_EQ(std::abs(larger_principal(folds(1, 0), folds(1, 1), folds(1, 2))),
                   max_fold_angle);
  EXPECT_DOUBLE_EQ(larger_principal(folds(2, 0), folds(2, 1), folds(2, 2)), 0.2);
}

TEST(FoldWidth, TheLargerPrincipalValueKeepsItsSign) {
  EXPECT_DOUBLE_EQ(larger_principal(3.0, 0.0, -5.0), -5);
  EXPECT_DOUBLE_EQ(larger_principal(2.0, 2.0, -1.0), 3);  // eigenvalues 3, -2
  EXPECT_DOUBLE_EQ(larger_principal(-2.0, 2.0, 1.0), -3);
}

}  // namespace
}  // namespace paperbake
