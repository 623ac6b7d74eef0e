#include "core/geometry/measure.h"

#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

namespace paperbake {
namespace {

using test::flat_sheet;
using test::hex_sheet;
using test::roll;
using test::strip_sheet;

constexpr double exact = 1e-12;  // [1] a few hundred operations on numbers near 1

/// A sheet of equilateral triangles with edges of h [m], rolled to a radius of 5 cm.
Sheet rolled(double h) {
  const int columns = static_cast<int>(std::lround(0.1 / h));
  Sheet sheet = hex_sheet(0.1, 0.1 * std::sqrt(0.75), columns);
  roll(sheet, 0.05);
  return sheet;
}

// ---- lengths ----

// the roll is exact: the only error is that of the chords
TEST(MeasureTest, LengthDistortionOfARolledSheetFallsWithTheSquareOfTheEdge) {
  const auto largest = [](double h) { return length_distortion(rolled(h)).largest; };
  const auto mean = [](double h) { return length_distortion(rolled(h)).mean; };
  EXPECT_NEAR(test::order(largest, 0.005, 0.0025), 2, 0.05);
  // on finer meshes, because there the half edges at the border are fewer
  EXPECT_NEAR(test::order(mean, 0.0025, 0.00125), 2, 0.05);
  // for an edge across the rulings (h/R)^2/24; the next term of the series is 1e-3 of it
  EXPECT_NEAR(largest(0.005), 0.01 / 24, 0.01 * 0.01 / 24);
}

TEST(MeasureTest, LengthDistortionOfAStretchedSheetIsItsStretch) {
  for (const double stretch : {0.03, -0.03}) {
    Sheet sheet = hex_sheet(0.1, 0.1, 8, 0.2);
    sheet.x *= 1 + stretch;
    EXPECT_NEAR(length_distortion(sheet).mean, 0.03, exact);
    EXPECT_NEAR(length_distortion(sheet).largest, 0.03, exact);
  }
}

TEST(MeasureTest, LengthDistortionCountsEveryEdgeOnce) {
  // a square of two triangles and five edges; the diagonal 0-3 belongs to both triangles
  Sheet sheet = strip_sheet(0.1, 0.1, 1);
  sheet.x.row(0) << 0.1, 0, 0.1;  // 0-2 and 0-3 keep their lengths, 0-1 grows by sqrt 3
  EXPECT_NEAR(length_distortion(sheet).largest, std::sqrt(3.0) - 1, exact);
  EXPECT_NEAR(length_distortion(sheet).mean, (std::sqrt(3.0) - 1) / 5, exact);
  EXPECT_LT((length_distortion(sheet).where - Vector2d(0, 0.05)).norm(), exact);
}

TEST(MeasureTest, LengthDistortionLocatesTheWorstEdgeOnThePattern) {
  Sheet sheet = hex_sheet(0.1, 0.1, 10);
  roll(sheet, 0.05);
  int spot = 0;
  for (int v = 0; v < sheet.x.rows(); ++v)
    if ((sheet.pattern.row(v) - Eigen::RowVector2d(0.06, 0.04)).norm() <
        (sheet.pattern.row(spot) - Eigen::RowVector2d(0.06, 0.04)).norm())
      spot = v;
  sheet.x.row(spot).z() += 0.02;  // ten times the error of the chords
  const LengthDistortion distortion = length_distortion(sheet);
  EXPECT_GT(distortion.largest, 0.1);
  // half an edge of 10 mm away
  EXPECT_LT((distortion.where.transpose() - sheet.pattern.row(spot)).norm(), 0.006);
}

TEST(MeasureTest, LengthDistortionIsZeroOnAFlatSheet) {
  EXPECT_LT(length_distortion(hex_sheet(0.1, 0.1, 8, 0.2)).largest, exact);
}

// ---- angles ----

/// The cone made from a disc from which a wedge [rad] was cut. The pattern is a whole disc of
/// `parts` triangles around its middle; in space every triangle keeps its two sides at the apex and
/// has an angle of (2 pi - wedge)/parts between them.
Sheet cone(double wedge, int parts) {
  Points2 p(parts + 1, 2);
  Triangles t(parts, 3);
  p.row(0) << 0, 0;
  const double facet = (2 * M_PI - wedge) / parts;
  // sine of half the opening angle
  const double sine = std::sqrt((1 - std::cos(facet)) / (1 - std::cos(2 * M_PI / parts)));
  for (int k = 0; k < parts; ++k) {
    p.row(1 + k) << 0.05 * std::cos(2 * M_PI * k / parts), 0.05 * std::sin(2 * M_PI * k / parts);
    t.row(k) << 0, 1 + k, 1 + (k + 1) % parts;
  }
  Sheet sheet = flat_sheet(std::move(p), std::move(t));
  for (int v = 1; v <= parts; ++v)
    sheet.x.row(v) << sine * sheet.pattern(v, 0), sine * sheet.pattern(v, 1),
        -0.05 * std::sqrt(1 - sine * sine);
  return sheet;
}

TEST(MeasureTest, AngleDefectOfAConeIsItsWedge) {
  for (const double wedge : {1e-4, 0.3, 2.0})
    for (const int parts : {5, 24})
      EXPECT_NEAR(angle_defect_max(cone(wedge, parts)), wedge, exact) << "wedge " << wedge;
}

TEST(MeasureTest, AngleDefectOfASaddleCountsToo) {
  // every other point of the rim moves up and the rest down: more than 360 degrees of paper
  Sheet sheet = cone(0, 8);
  for (int v = 1; v <= 8; ++v) sheet.x(v, 2) = v % 2 ? 0.01 : -0.01;
  const Vector3d a = sheet.x.row(1), b = sheet.x.row(2);
  EXPECT_NEAR(angle_defect_max(sheet), 8 * std::acos(a.dot(b) / a.norm() / b.norm()) - 2 * M_PI,
              exact);
  EXPECT_GT(angle_defect_max(sheet), 0.1);
}

TEST(MeasureTest, AngleDefectIsZeroOnAFlatSheetAndOnOneFoldedAlongItsEdges) {
  Sheet sheet = hex_sheet(0.1, 0.1, 8, 0.2);
  EXPECT_LT(angle_defect_max(sheet), exact);
  sheet = cone(0, 8);  // folded along the diameter 1-5, with the apex on the fold
  for (int v : {2, 3, 4}) sheet.x.row(v) << sheet.pattern(v, 0), 0, sheet.pattern(v, 1);
  EXPECT_LT(angle_defect_max(sheet), exact);
}

TEST(MeasureTest, AngleDefectIgnoresSingularPoints) {
  Sheet sheet = cone(0.3, 12);
  sheet.singular = {{{0.02, 0.01}, 1, "elsewhere"}};
  EXPECT_NEAR(angle_defect_max(sheet), 0.3, exact);
  sheet.singular.push_back({{0, 0}, 2, "the apex"});
  EXPECT_EQ(angle_defect_max(sheet), 0);
}

TEST(MeasureTest, AngleDefectIgnoresTheBorder) {
  Sheet sheet = strip_sheet(0.1, 0.1, 8);  // only border vertices, with 90 and 180 degrees
  for (int v = 0; v < sheet.x.rows(); ++v) sheet.x(v, 2) = 0.01 * (v % 3);
  EXPECT_EQ(angle_defect_max(sheet), 0);
}

TEST(MeasureTest, TriangleNormalIsAUnitVectorOnTheSideFromWhichItIsCounterClockwise) {
  const Vector3d a(1, 2, 3), b(1.1, 2, 3), c(1, 2.2, 3);
  EXPECT_LT((triangle_normal(a, b, c) - Vector3d(0, 0, 1)).norm(), exact);
  EXPECT_LT((triangle_normal(a, c, b) - Vector3d(0, 0, -1)).norm(), exact);
  // a micrometre wide
  EXPECT_LT((triangle_normal(a, b, a + 1e-6 * (c - a)) - Vector3d(0, 0, 1)).norm(), 1e-9);
}

TEST(MeasureTest, TriangleNormalIsZeroWhereThereIsNoArea) {
  const Vector3d a(0.5, 0.25, 2), along(0.5, -1, 0.125), zero = Vector3d::Zero();
  EXPECT_EQ(triangle_normal(a, a, a), zero);
  EXPECT_EQ(triangle_normal(a, a + along, a), zero);
  EXPECT_EQ(triangle_normal(a, a, a + along), zero);
  EXPECT_EQ(triangle_normal(a, a + along, a + 2 * along), zero) << "three points of a line";
  EXPECT_EQ(triangle_normal(a, a + along, a - along), zero);
  // so small that the square of its area is none
  const Vector3d tiny = triangle_normal(zero, Vector3d(1e-100, 0, 0), Vector3d(0, 1e-100, 0));
  EXPECT_TRUE(tiny.allFinite());
  EXPECT_LE(tiny.norm(), 1);
}

TEST(MeasureTest, AngleAboutAnAxisHasItsSign) {
  const Vector3d axis(0, 0, 1), a(2, 0, 0);
  for (const double angle : {-3.0, -0.1, 1e-9, 1.5, 3.1}) {
    const Vector3d b(3 * std::cos(angle), 3 * std::sin(angle), 0);
    EXPECT_NEAR(angle_about(axis, a, b), angle, exact);
    EXPECT_NEAR(angle_about(-axis, a, b), -angle, exact);
  }
  EXPECT_EQ(angle_about(axis, a, a), 0);
}

TEST(MeasureTest, AngleAboutAnAxisIsPiForOppositeVectorsWhateverTheSignsOfZeros) {
  for (const Vector3d& axis : {Vector3d(0, 0, 1), Vector3d(0, 0, -1), Vector3d(-0.0, -0.0, -1),
                               Vector3d(-1, -0.0, 0), Vector3d(0, 1, -0.0), Vector3d(-0.0, -1, 0)})
    for (int k = 0; k < 3; ++k) {
      if (axis[k] != 0) continue;
      const Vector3d a = Vector3d::Unit(k);
      EXPECT_EQ(angle_about(axis, a, -a), M_PI) << axis.transpose() << ", " << k;
      EXPECT_EQ(angle_about(axis, -a, a), M_PI) << axis.transpose() << ", " << k;
    }
}

TEST(MeasureTest, AngleAboutNothingOrOfNothingIsANumber) {
  const Vector3d zero = Vector3d::Zero(), a(1, 0, 0), b(0, 1, 0);
  EXPECT_EQ(angle_about(zero, a, b), 0) << "no axis: between vectors at a right angle";
  EXPECT_EQ(angle_about(zero, a, a), 0);
  EXPECT_EQ(angle_about(zero, a, -a), M_PI);
  EXPECT_EQ(angle_about(b, zero, a), 0);
  EXPECT_EQ(angle_about(b, a, zero), 0);
  EXPECT_EQ(angle_about(zero, zero, zero), 0);
}

TEST(MeasureTest, VertexNormalsOnACylinderPointAwayFromItsAxis) {
  const double h = 0.0025, R = 0.05;
  const Sheet sheet = rolled(h);
  const Points3 normals = vertex_normals(sheet.x, sheet.triangles);
  for (int v = 0; v < sheet.x.rows(); ++v) {
    const double s = sheet.pattern(v, 0), angle = s / R;
    const Vector3d outwards(std::sin(angle), 0, std::cos(angle));
    EXPECT_NEAR(normals.row(v).norm(), 1, exact);
    // inside, the one-rings are even except for the half triangles next to the border; on the
    // border a facet turns by at most h/2R
    const bool border = s < 0.6 * h || s > 0.1 - 0.6 * h || sheet.pattern(v, 1) < 1e-9 ||
                        sheet.pattern(v, 1) > 0.1 * std::sqrt(0.75) - 1e-9;
    const double error = (normals.row(v).transpose() - outwards).norm();
    EXPECT_LT(error, border ? 0.5 * h / R : h / R * h / R) << sheet.pattern.row(v);
  }
}

TEST(MeasureTest, VertexNormalsTurnWithTheSheet) {
  const Sheet sheet = rolled(0.01);
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(1.1, Vector3d(1, 2, -0.5).normalized()).toRotationMatrix();
  const Points3 turned = (sheet.x * R.transpose()).rowwise() + Eigen::RowVector3d(3, -2, 5);
  EXPECT_LT((vertex_normals(turned, sheet.triangles) -
             vertex_normals(sheet.x, sheet.triangles) * R.transpose())
                .norm(),
            1e-11);
}

TEST(MeasureTest, VertexNormalsWeightTrianglesByTheirAngle) {
  // the corner of a cube with one of its faces cut in two: every face still has 90 degrees
  Points3 x(5, 3);
  x << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1;
  Triangles t(4, 3);
  t << 0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 1;
  EXPECT_LT((vertex_normals(x, t).row(0) - Eigen::RowVector3d(1, 1, 1).normalized()).norm(), exact);
}

TEST(MeasureTest, VertexNormalsOfASheetFoldedFlatOntoItselfAreUnit) {
  Points3 x(4, 3);
  x << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0;
  Triangles t(2, 3);
  t << 0, 1, 2, 1, 0, 3;
  const Points3 normals = vertex_normals(x, t);
  for (int v = 0; v < 4; ++v) EXPECT_NEAR(normals.row(v).norm(), 1, exact);
  EXPECT_NEAR(normals(2, 2), 1, exact);
  EXPECT_NEAR(normals(3, 2), -1, exact);
}

TEST(MeasureTest, LargestStretchIsThatOfTheLongestEdgeAndZeroInCompression) {
  Sheet sheet = test::strip_sheet(0.1, 0.02, 5);
  sheet.x.col(0) *= 0.9;
  EXPECT_EQ(largest_stretch(sheet), 0);
  sheet.x.col(1) *= 1.03;
  // the edges across are stretched; the diagonals are shorter than before
  EXPECT_NEAR(largest_stretch(sheet), 0.03, 1e-12);
}

}  // namespace
}  // namespace paperbake
