#include "core/render/shape_fit.h"

#include "core/geometry/measure.h"
#include "tests/core/test_meshes.h"

#include <Eigen/SparseCholesky>
#include <gtest/gtest.h>

#include <cmath>

namespace paperbake {
namespace {

ShapeFitOptions smooth_over(double length) {
  ShapeFitOptions options;
  options.length = length;
  return options;
}

/// The curvature tensors of a sheet rolled by test::roll.
Points3 rolled(const Sheet& sheet, double R) {
  Points3 curvature = Points3::Zero(sheet.x.rows(), 3);
  curvature.col(0).setConstant(1 / R);
  return curvature;
}

TEST(ShapeFitTest, ColumnCholeskySolvesThreeColumnsLikeADenseSolver) {
  const int n = 60;
  Eigen::MatrixXd dense = Eigen::MatrixXd::Identity(n, n);
  for (int k = 0; k < 400; ++k) {
    const int i = 7 * k % n, j = (13 * k + 5) % n;
    Eigen::VectorXd e = Eigen::VectorXd::Zero(n);
    e[i] += 1;
    e[j] -= 0.5;
    dense += e * e.transpose();
  }
  Points3 b(n, 3);
  for (int i = 0; i < n; ++i) b.row(i) << std::sin(i), std::cos(3 * i), i % 7;
  const Eigen::MatrixXd lower = dense.triangularView<Eigen::Lower>();
  const Points3 x = ColumnCholesky(lower.sparseView()).solve(b),
                wanted = dense.llt().solve(Eigen::MatrixXd(b));
  ASSERT_GT(wanted.norm(), 1);
  EXPECT_LT((x - wanted).norm(), 1e-5 * wanted.norm());  // the factor has 32-bit numbers
}

TEST(ShapeFitTest, LeavesACylinderWhereItIs) {
  const double R = 0.03;
  Sheet sheet = test::hex_sheet(0.1, 0.06, 50, 0.1);
  test::roll(sheet, R);
  ShapeFit solve(sheet.pattern, sheet.triangles, smooth_over(0.006));
  solve.hold({});
  const Points3 x = solve(sheet.x, rolled(sheet, R));
  // at the border quadratic bending has no moment; elsewhere only the chords of the mesh remain
  EXPECT_LT((x - sheet.x).rowwise().norm().maxCoeff(), 1e-5);
  // Inside, the bending of a cylinder is at rest whatever curvature is aimed at; at its border it
  // would unroll.
  const Points3 flattened = solve(sheet.x, Points3::Zero(sheet.x.rows(), 3));
  EXPECT_GT((flattened - sheet.x).rowwise().norm().maxCoeff(), 2e-5)
      << "the curvature that is aimed at does matter";
}

TEST(ShapeFitTest, RemovesStretch) {
  Sheet sheet = test::hex_sheet(0.1, 0.06, 50, 0.1);
  test::roll(sheet, 0.03);
  sheet.x *= 1.005;
  ShapeFit solve(sheet.pattern, sheet.triangles, smooth_over(0.006));
  solve.hold({});
  const double before = length_distortion(sheet).mean;
  ASSERT_GT(before, 0.0045);
  sheet.x = solve(sheet.x, rolled(sheet, 0.03));
  // stretch of the whole sheet is what the position term resists most
  EXPECT_LT(length_distortion(sheet).mean, 0.12 * before);
}

TEST(ShapeFitTest, RemovesRipples) {
  Sheet sheet = test::hex_sheet(0.1, 0.06, 50, 0.1);
  test::roll(sheet, 0.03);
  const Points3 smooth = vertex_normals(sheet.x, sheet.triangles);
  for (int v = 0; v < sheet.x.rows(); ++v)  // waves of 12 mm
    sheet.x(v, 2) +=
        1e-4 * std::sin(500 * sheet.pattern(v, 0)) * std::sin(500 * sheet.pattern(v, 1));
  ShapeFit solve(sheet.pattern, sheet.triangles, smooth_over(0.006));
  solve.hold({});
  const auto roughness = [&](const Points3& x) {
    return (vertex_normals(x, sheet.triangles) - smooth).rowwise().norm().mean();
  };
  const double rough = roughness(sheet.x);
  ASSERT_GT(rough, 0.01);
  EXPECT_LT(roughness(solve(sheet.x, rolled(sheet, 0.03))), 0.2 * rough);
}

TEST(ShapeFitTest, KeepsAFoldSharp) {
  Sheet sheet = test::hex_sheet(0.1, 0.06, 50);
  for (int v = 0; v < sheet.x.rows(); ++v) {
    const double s = sheet.pattern(v, 0) - 0.05;
    sheet.x.row(v) << std::min(s, 0.0), sheet.pattern(v, 1), -std::max(s, 0.0);
  }
  ASSERT_LT((sheet.pattern.col(0).array() - 0.05).abs().minCoeff(), 1e-12);
  ShapeFit solve(sheet.pattern, sheet.triangles, smooth_over(0.006));
  solve.hold({});
  const Points3 x = solve(sheet.x, Points3::Zero(sheet.x.rows(), 3));
  // Every other row of this mesh has its vertices beside the fold, so that the fold is a saw of one
  // edge (2 mm), and a little of that is smoothed. Rounded over 6 mm it would be a millimetre away.
  EXPECT_LT((x - sheet.x).rowwise().norm().maxCoeff(), 3e-4);
  // the same edges are rounded where paper has no creases
  ShapeFitOptions smooth = smooth_over(0.006);
  smooth.may_crease = false;
  ShapeFit round(sheet.pattern, sheet.triangles, smooth);
  round.hold({});
  EXPECT_GT(
      (round(sheet.x, Points3::Zero(sheet.x.rows(), 3)) - sheet.x).rowwise().norm().maxCoeff(),
      1e-3);
}

TEST(ShapeFitTest, KeepsAShallowFoldSharpWhereItIsACreaseAtLeast) {
  constexpr double turn = 0.3;  // [rad]
  Sheet sheet = test::strip_sheet(0.1, 0.004, 50);
  for (int v = 0; v < sheet.x.rows(); ++v) {
    const double s = sheet.pattern(v, 0) - 0.05, beyond = std::max(s, 0.0);
    sheet.x.row(v) << std::min(s, 0.0) + beyond * std::cos(turn), sheet.pattern(v, 1),
        beyond * std::sin(turn);
  }
  const std::pair<int, int> first{0, 1}, middle{51, 50};
  ShapeFit solve(sheet.pattern, sheet.triangles, smooth_over(0.006), {}, {first, middle});
  solve.hold({});
  const auto moved = [&](const std::vector<double>& least) {
    const Points3 x = solve(sheet.x, Points3::Zero(sheet.x.rows(), 3), least);
    return (x - sheet.x).rowwise().norm().maxCoeff();
  };
  EXPECT_GT(moved({}), 1e-4) << "it is rounded";
  EXPECT_EQ(moved({0, 0}), moved({}));
  EXPECT_LT(moved({0, 1}), 1e-6);
  EXPECT_LT(moved({0, 0.5}), 0.6 * moved({}));
}

TEST(ShapeFitTest, HeldVerticesStayToTheLastBit) {
  Sheet sheet = test::hex_sheet(0.1, 0.06, 20);
  test::roll(sheet, 0.03);
  sheet.x(5, 2) += 1e-3;
  sheet.x(40, 2) -= 1e-3;
  ShapeFit solve(sheet.pattern, sheet.triangles, smooth_over(0.006));
  solve.hold({5, 40});
  const Points3 x = solve(sheet.x, rolled(sheet, 0.03));
  EXPECT_EQ(Vector3d(x.row(5)), Vector3d(sheet.x.row(5)));
  EXPECT_EQ(Vector3d(x.row(40)), Vector3d(sheet.x.row(40)));
  solve.hold({});
  EXPECT_GT((solve(sheet.x, rolled(sheet, 0.03)).row(5) - sheet.x.row(5)).norm(), 1e-4);
}

TEST(ShapeFitTest, GivesTheSameResultTwice) {
  Sheet sheet = test::hex_sheet(0.1, 0.06, 20, 0.2);
  test::roll(sheet, 0.03);
  sheet.x(5, 2) += 1e-3;
  const auto answer = [&] {
    ShapeFit solve(sheet.pattern, sheet.triangles, smooth_over(0.006));
    solve.hold({7});
    return solve(sheet.x, rolled(sheet, 0.03));
  };
  EXPECT_EQ(answer(), answer());
}

}  // namespace
}  // namespace paperbake
