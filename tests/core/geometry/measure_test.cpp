#include "core/geometry/measure.h"
#include "core/geometry/intersections.h"

#include "tests/core/test_meshes.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <gtest/gtest.h>

namespace paperbake {
namespace {

using test::flat_sheet;
using test::hex_sheet;
using test::roll;
using test::strip_sheet;

constexpr double exact = 1e-12;  // a few hundred operations on numbers near 1 in double precision

/// Equilateral triangles with edge h, rolled to a radius of 5 cm.
Sheet rolled(double h) {
  const int columns = static_cast<int>(std::lround(0.1 / h));
  Sheet sheet = hex_sheet(0.1, 0.1 * std::sqrt(0.75), columns);
  roll(sheet, 0.05);
  return sheet;
}

// ---- lengths
// -------------------------------------------------------------------------------------------------

// an exact roll: only chords err
TEST(LengthDistortionTest, OfARolledSheetFallsWithTheSquareOfTheEdge) {
  const auto largest = [](double h) { return length_distortion(rolled(h)).largest; };
  const auto mean = [](double h) { return length_distortion(rolled(h)).mean; };
  EXPECT_NEAR(test::order(largest, 0.005, 0.0025), 2, 0.05);
  // finer: the half edges at the border are fewer
  EXPECT_NEAR(test::order(mean, 0.0025, 0.00125), 2, 0.05);
  // of an edge across: (h/R)^2/24, the next term is 1e-3 of it
  EXPECT_NEAR(largest(0.005), 0.01 / 24, 0.01 * 0.01 / 24);
}

TEST(LengthDistortionTest, OfAStretchedSheetIsItsStretch) {
  for (const double stretch : {0.03, -0.03}) {
    Sheet sheet = hex_sheet(0.1, 0.1, 8, 0.2);
    sheet.x *= 1 + stretch;
    EXPECT_NEAR(length_distortion(sheet).mean, 0.03, exact);
    EXPECT_NEAR(length_distortion(sheet).largest, 0.03, exact);
  }
}

TEST(LengthDistortionTest, CountsEveryEdgeOnce) {
  // a square of two triangles, five edges; the diagonal 0-3 belongs to both
  Sheet sheet = strip_sheet(0.1, 0.1, 1);
  sheet.x.row(0) << 0.1, 0, 0.1;  // 0-2 and 0-3 keep their lengths, 0-1 grows by sqrt 3
  EXPECT_NEAR(length_distortion(sheet).largest, std::sqrt(3.0) - 1, exact);
  EXPECT_NEAR(length_distortion(sheet).mean, (std::sqrt(3.0) - 1) / 5, exact);
  EXPECT_LT((length_distortion(sheet).where - Vector2d(0, 0.05)).norm(), exact);
}

TEST(LengthDistortionTest, NamesTheWorstPlaceOnThePattern) {
  Sheet sheet = hex_sheet(0.1, 0.1, 10);
  roll(sheet, 0.05);
  int spot = 0;
  for (int v = 0; v < sheet.x.rows(); ++v)
    if ((sheet.pattern.row(v) - Eigen::RowVector2d(0.06, 0.04)).norm() <
        (sheet.pattern.row(spot) - Eigen::RowVector2d(0.06, 0.04)).norm())
      spot = v;
  sheet.x.row(spot).z() += 0.02;  // ten times what the chords of the roll do
  const LengthDistortion distortion = length_distortion(sheet);
  EXPECT_GT(distortion.largest, 0.1);
  // half an edge of 0.01 away
  EXPECT_LT((distortion.where.transpose() - sheet.pattern.row(spot)).norm(), 0.006);
}

TEST(LengthDistortionTest, IsZeroOnAFlatSheet) {
  EXPECT_LT(length_distortion(hex_sheet(0.1, 0.1, 8, 0.2)).largest, exact);
}

// ---- angles
// -------------------------------------------------------------------------------------------------

/// A flat disc as pattern, `parts` triangles round its middle, and in space the cone that a disc
/// makes from which a wedge was cut: every triangle keeps its sides at the apex and has (2 pi -
/// wedge)/parts there.
Sheet cone(double wedge, int parts) {
  Points2 p(parts + 1, 2);
  Triangles t(parts, 3);
  p.row(0) << 0, 0;
  const double facet = (2 * M_PI - wedge) / parts;
  // of half the opening angle
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

TEST(AngleDefectTest, OfAConeIsItsWedge) {
  for (const double wedge : {1e-4, 0.3, 2.0})
    for (const int parts : {5, 24})
      EXPECT_NEAR(angle_defect_max(cone(wedge, parts)), wedge, exact) << "wedge " << wedge;
}

TEST(AngleDefectTest, OfASaddleCountsToo) {
  // flat; every other rim point goes up, the rest down: more than 360 degrees of paper
  Sheet sheet = cone(0, 8);
  for (int v = 1; v <= 8; ++v) sheet.x(v, 2) = v % 2 ? 0.01 : -0.01;
  const Vector3d a = sheet.x.row(1), b = sheet.x.row(2);
  EXPECT_NEAR(angle_defect_max(sheet), 8 * std::acos(a.dot(b) / a.norm() / b.norm()) - 2 * M_PI,
              exact);
  EXPECT_GT(angle_defect_max(sheet), 0.1);
}

TEST(AngleDefectTest, IsZeroOnAFlatSheetAndOnOneFoldedAlongItsEdges) {
  Sheet sheet = hex_sheet(0.1, 0.1, 8, 0.2);
  EXPECT_LT(angle_defect_max(sheet), exact);
  sheet = cone(0, 8);  // folded along the diameter 1-5, with the apex on the fold
  for (int v : {2, 3, 4}) sheet.x.row(v) << sheet.pattern(v, 0), 0, sheet.pattern(v, 1);
  EXPECT_LT(angle_defect_max(sheet), exact);
}

TEST(AngleDefectTest, PassesSingularPointsBy) {
  Sheet sheet = cone(0.3, 12);
  sheet.singular = {{{0.02, 0.01}, 1, "elsewhere"}};
  EXPECT_NEAR(angle_defect_max(sheet), 0.3, exact);
  sheet.singular.push_back({{0, 0}, 2, "the apex"});
  EXPECT_EQ(angle_defect_max(sheet), 0);
}

TEST(AngleDefectTest, PassesTheBorderBy) {
  Sheet sheet = strip_sheet(0.1, 0.1, 8);  // border vertices only, with 90 and 180 degrees of paper
  for (int v = 0; v < sheet.x.rows(); ++v) sheet.x(v, 2) = 0.01 * (v % 3);
  EXPECT_EQ(angle_defect_max(sheet), 0);
}

TEST(VertexNormalsTest, OnACylinderPointAwayFromItsAxis) {
  const double h = 0.0025, R = 0.05;
  const Sheet sheet = rolled(h);
  const Points3 normals = vertex_normals(sheet.x, sheet.triangles);
  for (int v = 0; v < sheet.x.rows(); ++v) {
    const double s = sheet.pattern(v, 0), angle = s / R;
    const Vector3d outwards(std::sin(angle), 0, std::cos(angle));
    EXPECT_NEAR(normals.row(v).norm(), 1, exact);
    // inside the fans are even up to the half triangles beside the border; on the border a facet
    // turns by h/2R at most
    const bool border = s < 0.6 * h || s > 0.1 - 0.6 * h || sheet.pattern(v, 1) < 1e-9 ||
                        sheet.pattern(v, 1) > 0.1 * std::sqrt(0.75) - 1e-9;
    const double error = (normals.row(v).transpose() - outwards).norm();
    EXPECT_LT(error, border ? 0.5 * h / R : h / R * h / R) << sheet.pattern.row(v);
  }
}

TEST(VertexNormalsTest, TurnWithTheSheet) {
  const Sheet sheet = rolled(0.01);
  const Eigen::Matrix3d R =
      Eigen::AngleAxisd(1.1, Vector3d(1, 2, -0.5).normalized()).toRotationMatrix();
  const Points3 turned = (sheet.x * R.transpose()).rowwise() + Eigen::RowVector3d(3, -2, 5);
  EXPECT_LT((vertex_normals(turned, sheet.triangles) -
             vertex_normals(sheet.x, sheet.triangles) * R.transpose())
                .norm(),
            1e-11);
}

TEST(VertexNormalsTest, WeighTrianglesByTheirAngle) {
  // a corner of a cube, one of its faces cut in two: every face still has 90 degrees
  Points3 x(5, 3);
  x << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1;
  Triangles t(4, 3);
  t << 0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 1;
  EXPECT_LT((vertex_normals(x, t).row(0) - Eigen::RowVector3d(1, 1, 1).normalized()).norm(), exact);
}

TEST(VertexNormalsTest, OfATriangleFoldedShutUponItselfAreUnit) {
  Points3 x(4, 3);
  x << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0;
  Triangles t(2, 3);
  t << 0, 1, 2, 1, 0, 3;
  const Points3 normals = vertex_normals(x, t);
  for (int v = 0; v < 4; ++v) EXPECT_NEAR(normals.row(v).norm(), 1, exact);
  EXPECT_NEAR(normals(2, 2), 1, exact);
  EXPECT_NEAR(normals(3, 2), -1, exact);
}

TEST(MeasureTest, LargestStretchIsThatOfTheLongestEdgeAndNothingForASheetThatIsOnlyCompressed) {
  Sheet sheet = test::strip_sheet(0.1, 0.02, 5);
  sheet.x.col(0) *= 0.9;
  EXPECT_EQ(largest_stretch(sheet), 0);
  sheet.x.col(1) *= 1.03;
  // the edges across; the diagonals are shorter than they were
  EXPECT_NEAR(largest_stretch(sheet), 0.03, 1e-12);
}

// ---- crossings
// -------------------------------------------------------------------------------------------------

/// Separate triangles: rows of x, three by three.
Sheet soup(const Points3& x) {
  Sheet sheet;
  sheet.x = x;
  sheet.pattern = x.leftCols<2>();
  sheet.triangles.resize(x.rows() / 3, 3);
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    sheet.triangles.row(t) << 3 * t, 3 * t + 1, 3 * t + 2;
  return sheet;
}

/// A strip along the curve (x(s), z(s)).
Sheet strip_along(int cells, const std::function<Vector2d(double)>& curve) {
  Sheet sheet = strip_sheet(0.3, 0.03, cells);
  for (int v = 0; v < sheet.x.rows(); ++v) {
    const Vector2d p = curve(sheet.pattern(v, 0) / 0.3);
    sheet.x.row(v) << p.x(), sheet.pattern(v, 1), p.y();
  }
  return sheet;
}

TEST(CrossingsTest, NoneInAFlatOrRolledSheet) {
  Sheet sheet = hex_sheet(0.1, 0.1, 12, 0.2);
  EXPECT_EQ(crossings(sheet), 0);
  roll(sheet, 0.03);
  EXPECT_EQ(crossings(sheet), 0);
}

TEST(CrossingsTest, NoneInAStripFoldedOverWithAGap) {
  const Sheet sheet = strip_along(
      2, [](double t) { return t < 0.6 ? Vector2d(0.3 * t, 0) : Vector2d(0.01, 1e-6); });
  ASSERT_LT(sheet.x.col(0).maxCoeff(), 0.16);
  EXPECT_EQ(crossings(sheet), 0);
}

TEST(CrossingsTest, NoneInARollOfSeveralTurnsWhoseTurnsKeepApart) {
  const auto spiral = [](double t) {
    return Vector2d((0.01 + 0.003 * t) * std::cos(18 * t), (0.01 + 0.003 * t) * std::sin(18 * t));
  };
  EXPECT_EQ(crossings(strip_along(200, spiral)), 0);
}

TEST(CrossingsTest, TwoTrianglesThatPierceAreOne) {
  Points3 x(6, 3);
  x << 0, 0, 0, 1, 0, 0, 0, 1, 0, /**/ 0.2, 0.2, -1, 0.3, 0.3, 1, 2, 2, 1;
  EXPECT_EQ(crossings(soup(x)), 1);
  x.bottomRows(3).rowwise() += Eigen::RowVector3d(2, 0, 0);
  EXPECT_EQ(crossings(soup(x)), 0);
}

TEST(CrossingsTest, NeighboursOnlyTouch) {
  Points3 x(5, 3);
  x << 0, 0, 0, 1, 0, 0, 0, 1, 0, -1, 0, 1, 0, -1, 1;
  Sheet sheet = soup(x.topRows(3));
  sheet.x = x;
  sheet.triangles.resize(2, 3);
  sheet.triangles << 0, 1, 2, 0, 3, 4;  // one vertex in common
  EXPECT_EQ(crossings(sheet), 0);
  sheet.triangles << 0, 1, 2, 1, 0, 4;  // an edge in common
  EXPECT_EQ(crossings(sheet), 0);
}

TEST(CrossingsTest, TwoTrianglesRoundOneVertexMayStillPassThroughEachOther) {
  Points3 x(5, 3);
  x << 0, 0, 0, 1, 0, 0, 0, 1, 0, /**/ 0.2, 0.2, -0.5, 0.4, 0.4, 0.5;
  Sheet sheet = soup(x.topRows(3));
  sheet.x = x;
  sheet.triangles.resize(2, 3);
  sheet.triangles << 0, 1, 2, 0, 3, 4;  // the edge 3-4 goes through 0-1-2
  EXPECT_EQ(crossings(sheet), 1);
}

TEST(CrossingsTest, AStripThatPassesThroughItselfCrossesInThreePairs) {
  // a loop whose two legs cross within one cell each; two triangles of each, and of the four pairs
  // one lies apart: the diagonals of the cells cut the line of the crossing at different places
  const auto loop = [](double t) {
    return Vector2d(0.1 * (t + 0.4 * std::sin(2 * M_PI * (t + 0.013))),
                    0.05 * std::cos(2 * M_PI * t));
  };
  EXPECT_EQ(crossings(strip_along(41, loop)), 3);
}

/// What CGAL's own search finds in the same triangles.
int cgal_crossings(const Sheet& sheet) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  CGAL::Surface_mesh<Kernel::Point_3> mesh;
  std::vector<CGAL::SM_Vertex_index> vertices;
  for (int v = 0; v < sheet.x.rows(); ++v)
    vertices.push_back(mesh.add_vertex({sheet.x(v, 0), sheet.x(v, 1), sheet.x(v, 2)}));
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    mesh.add_face(vertices[sheet.triangles(t, 0)], vertices[sheet.triangles(t, 1)],
                  vertices[sheet.triangles(t, 2)]);
  std::vector<std::pair<CGAL::SM_Face_index, CGAL::SM_Face_index>> pairs;
  CGAL::Polygon_mesh_processing::self_intersections(mesh, std::back_inserter(pairs));
  return static_cast<int>(pairs.size());
}

TEST(CrossingsTest, AgreeWithTheSearchOfCgalOnRandomTriangles) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(0, 1), size(-0.3, 0.3);
  int found = 0;
  for (int k = 0; k < 300; ++k) {
    Points3 x(3 * 20, 3);
    for (int t = 0; t < 20; ++t) {
      const Eigen::RowVector3d centre(place(random), place(random), place(random));
      for (int i = 0; i < 3; ++i)
        x.row(3 * t + i) = centre + Eigen::RowVector3d(size(random), size(random), size(random));
    }
    const Sheet sheet = soup(x);
    const int expected = cgal_crossings(sheet);
    EXPECT_EQ(crossings(sheet), expected) << "soup " << k;
    found += expected;
  }
  EXPECT_GT(found, 1000);
}

TEST(CrossingsTest, AgreeWithTheSearchOfCgalOnCrumpledSheets) {
  int found = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    Sheet sheet = hex_sheet(0.1, 0.1, 8);
    std::mt19937 random(seed);
    // up to twice the edge
    std::uniform_real_distribution<double> uniform(-0.0005 * seed, 0.0005 * seed);
    for (int k = 0; k < sheet.x.size(); ++k) sheet.x.data()[k] += uniform(random);
    const int expected = cgal_crossings(sheet);
    EXPECT_EQ(crossings(sheet), expected) << "seed " << seed;
    found += expected;
  }
  EXPECT_GT(found, 1000);
}

}  // namespace
}  // namespace paperbake
