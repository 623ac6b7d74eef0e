#include "core/step1_elastic/elastic_energy.h"

#include "tests/test_meshes.h"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <numeric>

namespace paperbake {
namespace {

/// A rolled, twisted and slightly stretched sheet with creases: nothing in it is symmetric or flat.
Sheet crumpled() {
  Sheet sheet = test::hex_sheet(0.1, 0.07, 5, 0.2, 3);
  test::roll(sheet, 0.04);
  for (int v = 0; v < sheet.x.rows(); ++v) {
    const double a = sheet.pattern(v, 0), b = sheet.pattern(v, 1);
    sheet.x.row(v) += Eigen::RowVector3d(0.03 * b * std::sin(40 * a), 0.02 * a, 0.004 * std::sin(70 * b + 30 * a));
  }
  return sheet;
}

Points3 some_plastic_curvature(const Sheet& sheet) {
  Points3 plastic(sheet.triangles.rows(), 3);
  for (int t = 0; t < plastic.rows(); ++t) plastic.row(t) << 10 * std::sin(t), 5 * std::cos(2 * t), -8 * std::sin(3 * t);
  return plastic;
}

/// The matrix as the solver sees it, column by column.
Eigen::MatrixXd dense_hessian(ElasticEnergy& energy, const Points3& x, HessianForm form) {
  const int n = static_cast<int>(x.rows());
  BlockCholesky matrix(n, energy.coupled_vertices());
  std::vector<int> block_of(n);
  std::iota(block_of.begin(), block_of.end(), 0);
  energy.bind(matrix, block_of);
  matrix.set_zero();
  Points3 gradient;
  energy.hessian(x, form, gradient, matrix);
  return matrix.dense();
}

TEST(ElasticEnergy, GradientAgreesWithCentralDifferencesOnACrumpledPlasticSheet) {
  const Sheet sheet = crumpled();
  ElasticEnergy energy(Paper{}, sheet.pattern, sheet.triangles);
  energy.plastic_curvature = some_plastic_curvature(sheet);
  Points3 gradient;
  energy.gradient(sheet.x, gradient);
  ASSERT_GT(gradient.norm(), 1.0);
  Points3 x = sheet.x, numeric(x.rows(), 3);
  const double h = 1e-7;
  for (int k = 0; k < x.size(); ++k) {
    const double at = x.data()[k];
    x.data()[k] = at + h;
    const double up = energy.energy(x);
    x.data()[k] = at - h;
    numeric.data()[k] = (up - energy.energy(x)) / (2 * h);
    x.data()[k] = at;
  }
  EXPECT_LT((gradient - numeric).norm() / gradient.norm(), 1e-7);
}

TEST(ElasticEnergy, SecondDerivativeAgreesWithCentralDifferencesOfTheGradient) {
  const Sheet sheet = crumpled();
  ElasticEnergy energy(Paper{}, sheet.pattern, sheet.triangles);
  energy.plastic_curvature = some_plastic_curvature(sheet);
  const Eigen::MatrixXd hessian = dense_hessian(energy, sheet.x, HessianForm::exact);
  ASSERT_GT(hessian.norm(), 1.0);
  Eigen::MatrixXd numeric(sheet.x.size(), sheet.x.size());
  Points3 x = sheet.x, up, down;
  const double h = 1e-7;
  for (int k = 0; k < x.size(); ++k) {
    const double at = x.data()[k];
    x.data()[k] = at + h;
    energy.gradient(x, up);
    x.data()[k] = at - h;
    energy.gradient(x, down);
    x.data()[k] = at;
    for (int j = 0; j < x.size(); ++j) numeric(j, k) = (up.data()[j] - down.data()[j]) / (2 * h);
  }
  EXPECT_LT((hessian - numeric).norm() / hessian.norm(), 1e-7);
}

TEST(ElasticEnergy, SecondDerivativeIsRightRoundAVertexOfValenceThree) {
  // both wings across the two inner edges of a corner triangle are then one and the same vertex
  Points2 p(4, 2);
  p << 0, 0, 0.1, 0, 0.03, 0.09, 0.04, 0.03;
  Triangles t(3, 3);
  t << 0, 1, 3, 1, 2, 3, 2, 0, 3;
  Sheet sheet = test::flat_sheet(p, t);
  sheet.x(3, 2) = 0.02;
  ElasticEnergy energy(Paper{}, sheet.pattern, sheet.triangles);
  const Eigen::MatrixXd hessian = dense_hessian(energy, sheet.x, HessianForm::exact);
  Points3 x = sheet.x, up, down;
  const double h = 1e-7;
  for (int k = 0; k < x.size(); ++k) {
    const double at = x.data()[k];
    x.data()[k] = at + h;
    energy.gradient(x, up);
    x.data()[k] = at - h;
    energy.gradient(x, down);
    x.data()[k] = at;
    for (int j = 0; j < x.size(); ++j)
      EXPECT_NEAR(hessian(j, k), (up.data()[j] - down.data()[j]) / (2 * h), 1e-6 * hessian.norm());
  }
}

TEST(ElasticEnergy, ProjectedFormHasNoNegativeEigenvalueWhereTheExactOneHas) {
  const Sheet sheet = crumpled();
  ElasticEnergy energy(Paper{}, sheet.pattern, sheet.triangles);
  const auto lowest = [&](HessianForm form) {
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense_hessian(energy, sheet.x, form)).eigenvalues()[0];
  };
  EXPECT_LT(lowest(HessianForm::exact), -1.0);
  EXPECT_GT(lowest(HessianForm::projected), -1e-6);  // rounding of eigenvalues up to 1e6 N/m
}

TEST(ElasticEnergy, AnglesArePositiveWhereTheSheetBulgesToItsNormal) {
  Sheet sheet = test::strip_sheet(0.1, 0.05, 10);
  test::roll(sheet, 0.05);
  const Hinges hinges = find_hinges(sheet.triangles);
  double turn = 0;
  for (const Hinge& hinge : hinges.hinges) turn += fold_angle(sheet.x, hinge);
  EXPECT_NEAR(turn, 0.1 / 0.05 * 9 / 10, 1e-9);  // 10 chords of an arc of 2 rad turn 9 times
}

/// Bending energy of a cylinder, without the last cells beside the cut ends, over its exact value D/2 A/R^2.
double cylinder_ratio(Sheet sheet, double length) {
  const Paper paper;
  test::roll(sheet, 0.05);
  const ElasticEnergy energy(paper, sheet.pattern, sheet.triangles);
  const Hinges& hinges = energy.hinges();
  double sum = 0, area = 0;
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    double x = 0;
    for (int i = 0; i < 3; ++i) x += sheet.pattern(sheet.triangles(t, i), 0) / 3;
    if (x < 0.15 * length || x > 0.85 * length) continue;
    Vector3d theta;
    std::array<double, 3> shared{0, 0, 0};
    for (int i = 0; i < 3; ++i)
      if (const int h = hinges.of_triangle[t][i]; h >= 0)
        for (int side : hinges.hinges[h].triangles) shared[i] += rest_triangle(sheet.pattern, sheet.triangles.row(side)).area;
    const RestBending rest = rest_bending(paper, sheet.pattern, sheet.triangles.row(t), shared, 1);
    for (int i = 0; i < 3; ++i)
      theta[i] = hinges.of_triangle[t][i] < 0 ? 0 : fold_angle(sheet.x, hinges.hinges[hinges.of_triangle[t][i]]);
    sum += bending_energy(rest, theta, Vector3d::Zero());
    area += rest.area;
  }
  return sum / (0.5 * paper.bending_stiffness * area / (0.05 * 0.05));
}

TEST(ElasticEnergy, CylinderHasItsExactEnergyOnAnyKindOfMesh) {
  EXPECT_NEAR(cylinder_ratio(test::hex_sheet(0.1, 0.1, 14), 0.1), 1, 0.1);
  EXPECT_NEAR(cylinder_ratio(test::hex_sheet(0.1, 0.1, 14, 0.2), 0.1), 1, 0.1);
  EXPECT_NEAR(cylinder_ratio(test::strip_sheet(0.1, 0.1, 20), 0.1), 1, 0.01);
}

}  // namespace
}  // namespace paperbake
