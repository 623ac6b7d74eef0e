#include "core/step1_elastic/energies/elastic_energy.h"

#include "core/geometry/pattern_mesh.h"
#include "core/geometry/prescribed_creases.h"
#include "tests/core/test_meshes.h"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace paperbake {
namespace {

/// A rolled, twisted and slightly stretched sheet with creases: nothing in it is symmetric or flat.
Sheet crumpled() {
  Sheet sheet = test::hex_sheet(0.1, 0.07, 5, 0.2, 3);
  test::roll(sheet, 0.04);
  for (int v = 0; v < sheet.x.rows(); ++v) {
    const double a = sheet.pattern(v, 0), b = sheet.pattern(v, 1);
    sheet.x.row(v) += Eigen::RowVector3d(0.03 * b * std::sin(40 * a), 0.02 * a,
                                         0.004 * std::sin(70 * b + 30 * a));
  }
  return sheet;
}

/// About half of the triangles of crumpled() yield: the first yield is at 22 1/m.
Paper soft_paper() {
  Paper paper;
  paper.yield_strain = 0.001;
  paper.grain_ratio = 2.2;
  paper.grain_angle = 0.4;
  return paper;
}

PlasticMemory some_memory(const Sheet& sheet) {
  const int n = static_cast<int>(sheet.triangles.rows());
  PlasticMemory memory(n);
  for (int t = 0; t < n; ++t) {
    memory.curvature.row(t) << 10 * std::sin(t), 5 * std::cos(2 * t), -8 * std::sin(3 * t);
    memory.hardening[t] = 10 + 10 * std::cos(5 * t);
  }
  return memory;
}

std::vector<char> border_of(const Sheet& sheet, const Hinges& hinges) {
  std::vector<char> border(sheet.pattern.rows(), 0);
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i)
      if (hinges.of_triangle[t][i] < 0)
        border[sheet.triangles(t, (i + 1) % 3)] = border[sheet.triangles(t, (i + 2) % 3)] = 1;
  return border;
}

/// Fraction of the triangles that yield.
double yielding(const ElasticEnergy& energy, const Sheet& sheet) {
  return (energy.gained(sheet.x).hardening.array() > 0).cast<double>().mean();
}

/// The matrix as the solver sees it, as a dense matrix.
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

TEST(ElasticEnergyTest, GradientMatchesCentralDifferencesWhereOnlySomeTrianglesYield) {
  const Sheet sheet = crumpled();
  ElasticEnergy energy(soft_paper(), sheet.pattern, sheet.triangles);
  energy.memory = some_memory(sheet);
  ASSERT_NEAR(yielding(energy, sheet), 0.5, 0.3);
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

TEST(ElasticEnergyTest, HessianMatchesCentralDifferencesOfTheGradient) {
  const Sheet sheet = crumpled();
  ElasticEnergy energy(soft_paper(), sheet.pattern, sheet.triangles);
  energy.memory = some_memory(sheet);
  ASSERT_NEAR(yielding(energy, sheet), 0.5, 0.3);
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

TEST(ElasticEnergyTest, PaperThatNeverYieldsHasTheElasticEnergyToTheLastBit) {
  const Sheet sheet = crumpled();
  Paper paper;
  ElasticEnergy without(paper, sheet.pattern, sheet.triangles);
  paper.yield_strain = std::numeric_limits<double>::infinity();
  ElasticEnergy with(paper, sheet.pattern, sheet.triangles);
  const int n = static_cast<int>(sheet.triangles.rows());
  with.memory = PlasticMemory(n);
  with.memory.hardening = some_memory(sheet).hardening;
  ASSERT_GT(without.parts(sheet.x).bending, 1e-4);
  EXPECT_EQ(with.energy(sheet.x), without.energy(sheet.x));
  EXPECT_EQ(dense_hessian(with, sheet.x, HessianForm::exact),
            dense_hessian(without, sheet.x, HessianForm::exact));
}

/// An inner triangle with a plastic state, and angles that bend it from there.
struct OneTriangle {
  RestBending rest;
  Vector3d theta{0.3, -0.1, 0.2};
  PlasticState past{{3, 2, -1}, 50};
  OneTriangle() {
    Points2 p(3, 2);
    p << 0, 0, 0.01, 0.001, 0.004, 0.008;
    rest = rest_bending(Paper{}, p, {0, 1, 2}, {8e-5, 7e-5, 9e-5}, 1);
    origin = rest.operator_of_theta.inverse() * past.curvature;
    theta /= std::sqrt(2 * bending_energy(rest, theta) / (rest.rigidity * rest.area));
  }
  Vector3d origin;  // S' = 0
  Vector3d angles(double q) const { return origin + q * theta; }
};

TEST(ElasticEnergyTest, EnergyAndMomentAreContinuousWhereATriangleYields) {
  const OneTriangle t;
  Vector3d below, at, above;
  const double d = 1e-9 * t.past.yield;
  const double lower = bending_energy(t.rest, t.angles(t.past.yield - d), t.past, &below);
  const double upper = bending_energy(t.rest, t.angles(t.past.yield + d), t.past, &above);
  bending_energy(t.rest, t.angles(t.past.yield), t.past, &at);
  EXPECT_NEAR(upper / lower, 1, 1e-8);  // 2 * 2e-9 is the slope
  EXPECT_LT((above - below).norm(), 1e-8 * at.norm());
  // beyond yield the other branch holds: the slope of the moment falls to eta
  Matrix3d soft, stiff;
  bending_energy(t.rest, t.angles(t.past.yield - d), t.past, nullptr, &stiff);
  bending_energy(t.rest, t.angles(t.past.yield + d), t.past, nullptr, &soft);
  EXPECT_NEAR(t.theta.dot(soft * t.theta) / t.theta.dot(stiff * t.theta), t.rest.hardening, 1e-6);
}

TEST(ElasticEnergyTest, TangentOfAYieldingTriangleHasNoNegativeEigenvalue) {
  OneTriangle t;
  for (const double eta : {0.0, 0.3}) {
    t.rest.hardening = eta;
    Matrix3d tangent;
    bending_energy(t.rest, t.angles(3 * t.past.yield), t.past, nullptr, &tangent);
    const Vector3d values = Eigen::SelfAdjointEigenSolver<Matrix3d>(tangent).eigenvalues();
    ASSERT_GT(values[2], 1e-6);
    EXPECT_GT(values[0], -1e-12 * values[2]) << eta;
  }
}

TEST(ElasticEnergyTest, CommittingThePlasticIncrementLeavesTheMomentUnchanged) {
  const OneTriangle t;
  const Vector3d angles = t.angles(3 * t.past.yield);
  Vector3d during, after;
  bending_energy(t.rest, angles, t.past, &during);
  const PlasticGain gain = plastic_gain(t.rest, angles, t.past);
  ASSERT_NEAR(gain.hardening, 0.7 * 2 * t.past.yield, 1e-9 * t.past.yield);  // (1-eta)(q - q_y)
  const PlasticState next{t.past.curvature + gain.curvature,
                          t.past.yield + 0.3 / 0.7 * gain.hardening};
  bending_energy(t.rest, angles, next, &after);
  EXPECT_LT((after - during).norm(), 1e-12 * during.norm());
  EXPECT_LT(plastic_gain(t.rest, angles, next).hardening, 1e-12 * gain.hardening);
}

TEST(ElasticEnergyTest, SheetInItsPlasticShapeIsAtRestUpToItsBorders) {
  // the last triangles have no angle to determine the curvature across the border: they must not
  // take it from Sp either
  Sheet sheet = test::strip_sheet(0.03, 0.015, 40);
  ElasticEnergy energy(Paper{}, sheet.pattern, sheet.triangles);
  energy.memory = PlasticMemory(80);
  energy.memory.curvature.col(0).setConstant(200);
  const double flat = energy.parts(sheet.x).bending;
  ASSERT_GT(flat, 1e-4);
  ASSERT_GT(energy.gained(sheet.x).hardening.maxCoeff(), 60);
  test::roll(sheet, 1 / 200.0);
  EXPECT_LT(energy.parts(sheet.x).bending, 1e-12 * flat);
  EXPECT_EQ(energy.gained(sheet.x).hardening.maxCoeff(), 0);
}

TEST(ElasticEnergyTest, HessianIsCorrectAroundAVertexOfValenceThree) {
  // the wings across the two inner edges of a corner triangle are then the same vertex
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

TEST(ElasticEnergyTest, ProjectedFormHasNoNegativeEigenvalueWhereTheExactOneHas) {
  const Sheet sheet = crumpled();
  ElasticEnergy energy(Paper{}, sheet.pattern, sheet.triangles);
  const auto lowest = [&](HessianForm form) {
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense_hessian(energy, sheet.x, form))
        .eigenvalues()[0];
  };
  EXPECT_LT(lowest(HessianForm::exact), -1.0);
  EXPECT_GT(lowest(HessianForm::projected), -1e-6);  // rounding of eigenvalues up to 1e6 N/m
}

TEST(ElasticEnergyTest, AnglesArePositiveWhereTheSheetBulgesTowardsItsNormal) {
  Sheet sheet = test::strip_sheet(0.1, 0.05, 10);
  test::roll(sheet, 0.05);
  const Hinges hinges = find_hinges(sheet.triangles);
  double turn = 0;
  for (const Hinge& hinge : hinges.hinges) turn += dihedral_angle(sheet.x, hinge);
  EXPECT_NEAR(turn, 0.1 / 0.05 * 9 / 10, 1e-9);  // 10 chords of an arc of 2 rad turn 9 times
}

/// Bending energy of a cylinder without the last cells beside the cut ends, over its exact value
/// D/2 A/R^2.
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
        for (int side : hinges.hinges[h].triangles)
          shared[i] += rest_triangle(sheet.pattern, sheet.triangles.row(side)).area;
    const RestBending rest = rest_bending(paper, sheet.pattern, sheet.triangles.row(t), shared, 1);
    for (int i = 0; i < 3; ++i)
      theta[i] = hinges.of_triangle[t][i] < 0
                     ? 0
                     : dihedral_angle(sheet.x, hinges.hinges[hinges.of_triangle[t][i]]);
    sum += bending_energy(rest, theta);
    area += rest.area;
  }
  return sum / (0.5 * paper.bending_stiffness * area / (0.05 * 0.05));
}

TEST(ElasticEnergyTest, CylinderHasItsExactEnergyOnAnyKindOfMesh) {
  EXPECT_NEAR(cylinder_ratio(test::hex_sheet(0.1, 0.1, 14), 0.1), 1, 0.1);
  EXPECT_NEAR(cylinder_ratio(test::hex_sheet(0.1, 0.1, 14, 0.2), 0.1), 1, 0.1);
  EXPECT_NEAR(cylinder_ratio(test::strip_sheet(0.1, 0.1, 20), 0.1), 1, 0.01);
}

/// A sheet that is bent, sheared and stretched everywhere.
Sheet bent_sheet() {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 6, 0.2);
  test::roll(sheet, 0.05);
  sheet.x.col(1) *= 1.02;
  return sheet;
}

TEST(ElasticEnergyTest, PredictedStressMatchesTheStressAfterTheMoveToFirstOrder) {
  const Sheet sheet = bent_sheet();
  const ElasticEnergy energy(Paper{}, sheet.pattern, sheet.triangles);
  Points3 move(sheet.x.rows(), 3);
  for (int v = 0; v < move.rows(); ++v)
    move.row(v) << std::sin(50 * sheet.x(v, 1)), std::cos(40 * sheet.x(v, 0)),
        std::sin(70 * sheet.x(v, 0));
  const auto error = [&](double step) {  // [N/m] largest difference over the triangles
    const MembraneStress predicted = energy.stress(sheet.x, step * move),
                         there = energy.stress(sheet.x + step * move, 0 * move);
    double most = 0;
    for (std::size_t t = 0; t < there.size(); ++t)
      most = std::max(most, (predicted[t] - there[t]).norm());
    return most;
  };
  ASSERT_GT(energy.stress(sheet.x, 0 * move)[0].norm(), 1000);  // 2 % of 3.6e5 N/m
  // the error is of second order
  EXPECT_NEAR(error(1e-5) / error(5e-6), 4, 0.01);
}

TEST(ElasticEnergyTest, PaperIsStifferAlongItsGrain) {
  Sheet sheet = test::hex_sheet(0.1, 0.07, 8);
  test::roll(sheet, 0.03);  // along u
  Paper paper;
  const double even = ElasticEnergy(paper, sheet.pattern, sheet.triangles).parts(sheet.x).bending;
  paper.grain_ratio = 2.25;
  const auto share = [&](double angle) {
    paper.grain_angle = angle;
    return ElasticEnergy(paper, sheet.pattern, sheet.triangles).parts(sheet.x).bending / even;
  };
  // orthotropic plate, bent to a cylinder across the angle: D11 cos^4 + 2 (D12 + 2 D66) cos^2 sin^2
  // + D22 sin^4, D12 + 2 D66 = D
  EXPECT_NEAR(share(0), 1.5, 3e-3);
  EXPECT_NEAR(share(M_PI / 2), 1 / 1.5, 3e-3);
  EXPECT_NEAR(share(M_PI / 4), (1.5 + 2 + 1 / 1.5) / 4, 3e-3);
  EXPECT_NEAR(share(-M_PI / 4), share(M_PI / 4), 3e-3);
}

TEST(ElasticEnergyTest, PaperWithAGrainKeepsTheCurvatureItWasBentTo) {
  Sheet sheet = test::hex_sheet(0.1, 0.07, 8);
  test::roll(sheet, 0.003);  // 333 1/m
  Paper paper;
  paper.grain_ratio = 2.25;
  paper.grain_angle = 0.3;
  paper.hardening = 0;
  ElasticEnergy energy(paper, sheet.pattern, sheet.triangles);
  energy.memory = PlasticMemory(static_cast<int>(sheet.triangles.rows()));
  const PlasticMemory first = energy.gained(sheet.x);
  energy.memory.curvature = first.curvature;
  energy.memory.hardening = first.hardening;
  EXPECT_LT(energy.gained(sheet.x).curvature.cwiseAbs().maxCoeff(),
            1e-6 * first.curvature.cwiseAbs().maxCoeff());
}

TEST(ElasticEnergyTest, GivingThePresentStressGivesTheExactHessian) {
  const Sheet sheet = bent_sheet();
  ElasticEnergy energy(Paper{}, sheet.pattern, sheet.triangles);
  const int n = static_cast<int>(sheet.x.rows());
  std::vector<int> block_of(n);
  std::iota(block_of.begin(), block_of.end(), 0);
  const MembraneStress own = energy.stress(sheet.x, Points3::Zero(n, 3)),
                       none(own.size(), Eigen::Matrix2d::Zero());
  const auto second_derivative = [&](const MembraneStress* stress) {
    BlockCholesky matrix(n, energy.coupled_vertices());
    energy.bind(matrix, block_of);
    Points3 gradient;
    energy.hessian(sheet.x, HessianForm::exact, gradient, matrix, stress);
    return matrix.dense();
  };
  const Eigen::MatrixXd exact = second_derivative(nullptr);
  EXPECT_LT((second_derivative(&own) - exact).norm(), 1e-12 * exact.norm());
  EXPECT_GT((second_derivative(&none) - exact).norm(), 1e-4 * exact.norm());
}

/// crumpled() with creases on a third of its hinges: by turns free ones, ones that are pressed, and
/// ones that are not folded yet.
Sheet creased() {
  Sheet sheet = crumpled();
  const std::vector<Hinge> hinges = find_hinges(sheet.triangles).hinges;
  for (std::size_t h = 0; h < hinges.size(); h += 3) {
    const Vector2d a = sheet.pattern.row(hinges[h].vertices[0]),
                   b = sheet.pattern.row(hinges[h].vertices[1]);
    const bool folded = h % 9 != 6;
    const double rest = std::sin(static_cast<double>(h));
    sheet.prescribed_creases.push_back({{a, b}, 0, false});
    sheet.crease_edges.push_back({a, b, folded ? rest : 0, folded, {}});
    if (h % 9 == 3) sheet.crease_edges.back().pressed = 2.5 * std::cos(static_cast<double>(h));
  }
  return sheet;
}

/// With its creases as the sheet has them.
ElasticEnergy energy_of_creased(const Sheet& sheet, const Paper& paper = soft_paper()) {
  ElasticEnergy energy(paper, sheet.pattern, sheet.triangles, {}, sheet.prescribed_creases);
  energy.load_creases(sheet);
  return energy;
}

TEST(ElasticEnergyTest, HandsThatPressAShareOfTheWayLeaveTheAngleOfTheSheetAlone) {
  const Sheet sheet = creased();
  ElasticEnergy energy = energy_of_creased(sheet);
  const auto bending = [&] { return energy.parts(sheet.x).bending; };
  const double whole = bending();
  std::vector<double> of_share;
  for (const double share : {0.0, 0.5, 1.0}) {
    energy.load_creases(sheet);
    energy.press(sheet.x, share);
    of_share.push_back(bending());
    for (const CreaseEdge& edge : energy.creases_left(energy.dihedral_angles(sheet.x)))
      EXPECT_EQ(edge.pressed, crease_edge(sheet, {{edge.a, edge.b}}, edge.a, edge.b).pressed);
  }
  EXPECT_EQ(of_share[2], whole);
  // the energy of pressing is a parabola in the angle that is left
  EXPECT_NEAR(of_share[1] - of_share[0], 0.25 * (whole - of_share[0]), 1e-12 * whole);
  EXPECT_GT(whole, 1.01 * of_share[0]);
}

TEST(ElasticEnergyTest, DerivativesMatchCentralDifferencesWhereCreasesYieldAndArePressed) {
  const Sheet sheet = creased();
  ElasticEnergy energy = energy_of_creased(sheet);
  energy.memory = some_memory(sheet);
  int free = 0, pressed = 0, unfolded = 0, yielded = 0;
  const std::vector<CreaseEdge> left = energy.creases_left(energy.dihedral_angles(sheet.x));
  ASSERT_EQ(left.size(), sheet.crease_edges.size());
  for (std::size_t e = 0; e < left.size(); ++e) {
    const CreaseEdge& edge = sheet.crease_edges[e];
    ++(edge.pressed ? pressed : edge.folded ? free : unfolded);
    yielded += edge.folded && !edge.pressed && left[e].rest_angle != edge.rest_angle;
  }
  ASSERT_GT(pressed, 5);
  ASSERT_GT(unfolded, 5);
  ASSERT_GT(yielded, 2);
  ASSERT_LT(yielded, free) << "some of them turn elastically";
  Points3 gradient, none;
  energy.gradient(sheet.x, gradient);
  ElasticEnergy without(soft_paper(), sheet.pattern, sheet.triangles);
  without.memory = energy.memory;
  without.gradient(sheet.x, none);
  ASSERT_GT((gradient - none).norm(), 1e-2) << "creases contribute";
  const Eigen::MatrixXd hessian = dense_hessian(energy, sheet.x, HessianForm::exact);
  Eigen::MatrixXd second(sheet.x.size(), sheet.x.size());
  Points3 x = sheet.x, numeric(x.rows(), 3), up, down;
  const double h = 1e-7;
  for (int k = 0; k < x.size(); ++k) {
    const double at = x.data()[k];
    x.data()[k] = at + h;
    const double above = energy.energy(x);
    energy.gradient(x, up);
    x.data()[k] = at - h;
    numeric.data()[k] = (above - energy.energy(x)) / (2 * h);
    energy.gradient(x, down);
    x.data()[k] = at;
    for (int j = 0; j < x.size(); ++j) second(j, k) = (up.data()[j] - down.data()[j]) / (2 * h);
  }
  EXPECT_LT((gradient - numeric).norm() / gradient.norm(), 1e-7);
  EXPECT_LT((hessian - second).norm() / hessian.norm(), 1e-7);
}

TEST(ElasticEnergyTest, ProjectedFormHasNoNegativeEigenvalueWithCreases) {
  const Sheet sheet = creased();
  ElasticEnergy energy = energy_of_creased(sheet);
  const auto lowest = [&](HessianForm form) {
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense_hessian(energy, sheet.x, form))
        .eigenvalues()[0];
  };
  EXPECT_LT(lowest(HessianForm::exact), -1.0);
  EXPECT_GT(lowest(HessianForm::projected), -1e-6);  // rounding of eigenvalues up to 1e6 N/m
}

/// Two flat halves of a strip, turned by this angle [rad] about a crease in its middle.
Sheet turned_halves(double angle, bool folded) {
  Sheet sheet = test::strip_sheet(0.1, 0.05, 10);
  sheet.prescribed_creases = {{{{0.05, 0}, {0.05, 0.05}}, 0, folded}};
  for (int v = 0; v < sheet.x.rows(); ++v)
    if (const double beyond = sheet.pattern(v, 0) - 0.05; beyond > 0)
      sheet.x.row(v) << 0.05 + beyond * std::cos(angle), sheet.pattern(v, 1),
          -beyond * std::sin(angle);
  return sheet;
}

TEST(ElasticEnergyTest, NoMomentOfThePlateCrossesAFoldedCrease) {
  const Paper paper;
  for (const double angle : {-2.0, 0.3, 2.0}) {
    const Sheet folded = turned_halves(angle, true), other = turned_halves(angle, false);
    const ElasticEnergy crease = energy_of_creased(folded, paper),
                        plate = energy_of_creased(other, paper);
    const CreaseResponse alone = turn_crease(crease_law(paper), 0, angle);
    ASSERT_EQ(alone.rest == 0, std::abs(angle) < 0.5) << "elastic, and beyond its yield";
    EXPECT_NEAR(crease.parts(folded.x).bending, 0.05 * alone.energy, 1e-12 * alone.energy);
    // what is not folded bends as paper, by this angle over a width of 10 mm: D/2 (angle/w)^2 w l
    const double bent = 0.5 * paper.bending_stiffness * angle * angle / 0.01 * 0.05;
    EXPECT_NEAR(plate.parts(other.x).bending, bent, 1e-9 * bent);
    // what the crease does to the paper: its moment over 10 mm, to and from the nearest vertices
    Points3 gradient;
    crease.gradient(folded.x, gradient);
    for (int v = 0; v < gradient.rows(); ++v) {
      if (std::abs(folded.pattern(v, 0) - 0.05) > 0.0101) {
        EXPECT_LT(gradient.row(v).norm(), 1e-9) << v;
      }
    }
    const Eigen::RowVector3d beside = gradient.row(8) + gradient.row(9);
    EXPECT_NEAR(beside.norm(), std::abs(0.05 * alone.moment / 0.01), 1e-9);
  }
}

TEST(ElasticEnergyTest, ACreaseThatIsNotFoldedIsTheSamePaperToTheLastBit) {
  const Sheet sheet = turned_halves(0.3, false);
  const ElasticEnergy with = energy_of_creased(sheet),
                      without(soft_paper(), sheet.pattern, sheet.triangles);
  ASSERT_GT(without.parts(sheet.x).bending, 1e-5);
  EXPECT_EQ(with.energy(sheet.x), without.energy(sheet.x));
}

TEST(ElasticEnergyTest, AnExpectedCreaseFoldsWhereThePaperCarriesTheYieldMomentOfACrease) {
  const Paper paper;
  const double width = 0.01;  // of the paper beside the crease, on a mesh of cells of 10 mm
  // the curvature at which a plate with this stiffness carries it
  const double born = crease_law(paper).yield_moment / paper.bending_stiffness * width;
  ASSERT_NEAR(born, 0.6 * 2 * paper.yield_strain / paper.thickness * width, 1e-12);
  for (const double share : {-1.01, -0.99, 0.99, 1.01}) {
    Sheet sheet = turned_halves(share * born, false);
    ElasticEnergy energy = energy_of_creased(sheet, paper);
    sheet.crease_edges = energy.creases_left(energy.dihedral_angles(sheet.x));
    ASSERT_EQ(sheet.crease_edges.size(), 1u);
    EXPECT_EQ(sheet.crease_edges[0].folded, std::abs(share) > 1) << share;
    // both triangles beside it are to lose what has curled them, once
    EXPECT_EQ(energy.load_creases(sheet).size(), std::abs(share) > 1 ? 2u : 0u);
    EXPECT_EQ(energy.load_creases(sheet).size(), 0u);
    EXPECT_EQ(is_folded(sheet, 10, 11), std::abs(share) > 1);
  }
}

TEST(ElasticEnergyTest, ACreaseThatIsLeftTurnedKeepsItsMoment) {
  const Paper paper;
  Sheet sheet = turned_halves(2.0, true);
  ElasticEnergy energy = energy_of_creased(sheet, paper);
  Points3 during, after;
  energy.gradient(sheet.x, during);
  ASSERT_GT(during.norm(), 1e-2);
  sheet.crease_edges = energy.creases_left(energy.dihedral_angles(sheet.x));
  ASSERT_GT(sheet.crease_edges.at(0).rest_angle, 1.0);
  energy.load_creases(sheet);
  energy.gradient(sheet.x, after);
  EXPECT_LT((after - during).norm(), 1e-12 * during.norm());
  // let go, the halves are in equilibrium at the rest angle
  Sheet sprung = turned_halves(sheet.crease_edges[0].rest_angle, true);
  energy.gradient(sprung.x, after);
  EXPECT_LT(after.norm(), 1e-9 * during.norm());
}

/// Grain, a plastic past, ridges and yielding are all in it.
TEST(ConfigurationalForceTest, IsTheDerivativeOfTheEnergyByThePattern) {
  const Sheet sheet = crumpled();
  const auto energy_on = [&](const Points2& pattern) {
    ElasticEnergy energy(soft_paper(), pattern, sheet.triangles);
    energy.memory = some_memory(sheet);
    energy.ridges = {Eigen::VectorXd::Constant(sheet.triangles.rows(), 0.5),
                     Eigen::VectorXd::Constant(sheet.triangles.rows(), 1.3)};
    return energy;
  };
  const ElasticEnergy energy = energy_on(sheet.pattern);
  ASSERT_GT(yielding(energy, sheet), 0.3);
  ASSERT_LT(yielding(energy, sheet), 0.9);
  const LocalEnergies local = energy.local_energies(sheet.x);
  EXPECT_NEAR(local.membrane.sum() + local.bending.sum(), energy.energy(sheet.x),
              1e-12 * energy.energy(sheet.x));

  const std::vector<char> border = border_of(sheet, energy.hinges());
  constexpr double step = 1e-7;  // [m]
  const double scale = local.configurational_force.rowwise().norm().maxCoeff();
  int inner = 0;
  for (int v = 0; v < sheet.pattern.rows(); ++v) {
    if (border[v]) continue;
    ++inner;
    for (int axis = 0; axis < 2; ++axis) {
      Points2 ahead = sheet.pattern, behind = sheet.pattern;
      ahead(v, axis) += step;
      behind(v, axis) -= step;
      const double slope =
          (energy_on(ahead).energy(sheet.x) - energy_on(behind).energy(sheet.x)) / (2 * step);
      EXPECT_NEAR(local.configurational_force(v, axis), -slope, 1e-5 * scale) << v << " " << axis;
    }
  }
  EXPECT_GT(inner, 10);
}

/// Through a sheet that is stretched evenly the same momentum flows into each vertex as out of it.
TEST(ConfigurationalForceTest, VanishesWhereTheSheetIsTheSameAllRound) {
  Sheet sheet = test::hex_sheet(0.1, 0.07, 5, 0, 3);
  for (int v = 0; v < sheet.x.rows(); ++v)
    sheet.x.row(v) << 1.01 * sheet.pattern(v, 0), sheet.pattern(v, 1), 0;
  ElasticEnergy energy(Paper{}, sheet.pattern, sheet.triangles);
  const LocalEnergies local = energy.local_energies(sheet.x);
  const double force_on_border = local.configurational_force.rowwise().norm().maxCoeff();
  ASSERT_GT(force_on_border, 0);
  const std::vector<char> border = border_of(sheet, energy.hinges());
  for (int v = 0; v < sheet.pattern.rows(); ++v)
    if (!border[v]) {
      EXPECT_LT(local.configurational_force.row(v).norm(), 1e-9 * force_on_border);
    }
}

TEST(ElasticEnergyTest, TheForceOfACreaseIsTheGradientOfItsEnergy) {
  Pattern pattern{{{0, 0}, {0.1, 0}, {0.1, 0.1}, {0, 0.1}}, {}, {}};
  pattern.prescribed_creases = {{{{0.03, 0}, {0.05, 0.1}}, 0.4}};
  const PatternMesh mesh = mesh_pattern(pattern, 0.03, {});
  Paper paper;
  paper.membrane_stiffness = 1e-3;  // what is left is bending
  const ElasticEnergy energy(paper, mesh.vertices, mesh.triangles, {}, pattern.prescribed_creases),
      plain(paper, mesh.vertices, mesh.triangles);
  Points3 x(mesh.vertices.rows(), 3), gradient;
  for (int v = 0; v < x.rows(); ++v)
    x.row(v) << mesh.vertices.row(v),
        0.01 * std::sin(40 * mesh.vertices(v, 0)) + 0.1 * mesh.vertices(v, 0) * mesh.vertices(v, 1);
  EXPECT_GT(std::abs(energy.energy(x) / plain.energy(x) - 1), 0.01);
  energy.gradient(x, gradient);
  constexpr double step = 1e-7;
  double worst = 0;
  for (int v = 0; v < x.rows(); ++v)
    for (int c = 0; c < 3; ++c) {
      Points3 up = x, down = x;
      up(v, c) += step;
      down(v, c) -= step;
      worst = std::max(
          worst, std::abs((energy.energy(up) - energy.energy(down)) / (2 * step) - gradient(v, c)));
    }
  ASSERT_GT(gradient.norm(), 1e-3);
  EXPECT_LT(worst, 1e-5 * gradient.norm());
}

}  // namespace
}  // namespace paperbake
