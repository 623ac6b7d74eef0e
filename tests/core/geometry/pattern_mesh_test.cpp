#include "core/geometry/pattern_mesh.h"

#include "core/geometry/hinges.h"
#include "core/geometry/prescribed_creases.h"
#include "core/model/error.h"
#include "core/model/segment2.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <set>

namespace paperbake {
namespace {

using test::ell;
using test::rectangle;

std::vector<Vector2d> circle(const Vector2d& centre, double radius, int sides,
                             bool counter_clockwise = true) {
  std::vector<Vector2d> loop;
  for (int k = 0; k < sides; ++k) {
    const double angle = (counter_clockwise ? 2 : -2) * M_PI * k / sides;
    loop.push_back(centre + radius * Vector2d(std::cos(angle), std::sin(angle)));
  }
  return loop;
}

Pattern disc() { return {circle({0.1, 0.1}, 0.1, 64), {}}; }
Pattern holed() {
  return {rectangle(0.2, 0.2).outline,
          {circle({0.11, 0.09}, 0.04, 48, /*counter_clockwise=*/false)}};
}

struct Shape {
  const char* name;
  Pattern pattern;
  int euler;  // Euler characteristic
};
const std::vector<Shape> shapes = {{"square", rectangle(0.1, 0.1), 1},
                                   {"A4", rectangle(0.210, 0.297), 1},
                                   {"strip", rectangle(0.3, 0.03), 1},
                                   {"disc", disc(), 1},
                                   {"L", ell(), 1},
                                   {"square with a round hole", holed(), 0}};
const int counts[] = {100, 150, 300, 600, 1700, 6000};

/// 11 points on each of the borders x = 0 and x = width, like the handles of scene S1.
std::vector<Vector2d> handle_rows(double width, double height) {
  std::vector<Vector2d> points;
  for (int i = 0; i <= 10; ++i)
    for (const double x : {0.0, width}) points.emplace_back(x, height * i / 10);
  return points;
}

double area_of(const PatternMesh& mesh, int t) {
  const Vector2d a = mesh.vertices.row(mesh.triangles(t, 0)),
                 b = mesh.vertices.row(mesh.triangles(t, 1)),
                 c = mesh.vertices.row(mesh.triangles(t, 2));
  return 0.5 * cross(b - a, c - a);
}

double smallest_angle(const PatternMesh& mesh, int t) {
  double least = 180;
  for (int i = 0; i < 3; ++i) {
    const Vector2d a = mesh.vertices.row(mesh.triangles(t, i));
    const Vector2d u = mesh.vertices.row(mesh.triangles(t, (i + 1) % 3)).transpose() - a;
    const Vector2d v = mesh.vertices.row(mesh.triangles(t, (i + 2) % 3)).transpose() - a;
    least = std::min(least, std::acos(u.dot(v) / u.norm() / v.norm()) * 180 / M_PI);
  }
  return least;
}

/// Number of vertices in use - edges + triangles.
int euler_characteristic(const PatternMesh& mesh) {
  std::set<int> vertices;
  std::set<std::pair<int, int>> edges;
  for (int t = 0; t < mesh.triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i) {
      const int a = mesh.triangles(t, i), b = mesh.triangles(t, (i + 1) % 3);
      vertices.insert(a);
      edges.emplace(std::min(a, b), std::max(a, b));
    }
  return static_cast<int>(vertices.size()) - static_cast<int>(edges.size()) +
         static_cast<int>(mesh.triangles.rows());
}

/// Expects what every mesh of a pattern must be: counter-clockwise, of one piece, covering the
/// pattern, and with every vertex in use.
void expect_sound(const PatternMesh& mesh, const Pattern& pattern, int euler,
                  double area_tolerance) {
  double sum = 0;
  std::vector<char> used(mesh.vertices.rows(), 0);
  for (int t = 0; t < mesh.triangles.rows(); ++t) {
    EXPECT_GT(area_of(mesh, t), 0) << "triangle " << t;
    sum += area_of(mesh, t);
    for (int i = 0; i < 3; ++i) used[mesh.triangles(t, i)] = 1;
  }
  EXPECT_NEAR(sum / area(pattern), 1, area_tolerance);
  EXPECT_EQ(euler_characteristic(mesh), euler);
  for (std::size_t v = 0; v < used.size(); ++v)
    EXPECT_TRUE(used[v]) << "no triangle at " << mesh.vertices.row(v);
}

TEST(PatternMeshTest, HasAboutTheRequestedNumberOfTriangles) {
  for (const Shape& shape : shapes)
    for (const int count : counts) {
      // 100 triangles on the strip are 2.4 rows of equilateral triangles, and from two rows to
      // three the number jumps by a half
      const double tolerance = shape.name == std::string("strip") && count == 100 ? 0.2 : 0.1;
      EXPECT_NEAR(mesh_pattern_with(shape.pattern, count, {}).triangles.rows(), count,
                  tolerance * count)
          << shape.name;
    }
}

TEST(PatternMeshTest, CoversThePatternWithCounterClockwiseTriangles) {
  for (const Shape& shape : shapes)
    for (const int count : counts) {
      SCOPED_TRACE(shape.name + (", " + std::to_string(count)));
      // polygons with few corners are kept exactly; round ones are followed within a fiftieth of
      // an edge
      const bool round = shape.pattern.outline.size() > 8 || !shape.pattern.holes.empty();
      expect_sound(mesh_pattern_with(shape.pattern, count, {}), shape.pattern, shape.euler,
                   round ? 0.005 : 1e-12);
    }
}

TEST(PatternMeshTest, EveryRequiredPointIsAVertexAtItsPlace) {
  const std::vector<Vector2d> points = {{0, 0},        {0.2, 0},   {0.05, 0},
                                        {0.2, 0.033},  {0.1, 0.1}, {0.03, 0.17},
                                        {0.031, 0.17}, {0, 0.111}, {0.02, 0.02}};
  for (const int count : counts) {
    const PatternMesh mesh = mesh_pattern_with(ell(), count, points);
    ASSERT_EQ(mesh.point_vertex.size(), points.size());
    for (std::size_t k = 0; k < points.size(); ++k)
      EXPECT_LT((mesh.vertices.row(mesh.point_vertex[k]).transpose() - points[k]).norm(), 1e-12)
          << points[k].transpose();
    expect_sound(mesh, ell(), 1, 1e-12);
  }
}

TEST(PatternMeshTest, RequiredPointOnARoundBorderIsWithinTheBorderTolerance) {
  std::vector<Vector2d> points;
  for (int k = 0; k < 16; ++k)
    points.push_back(0.5 * (disc().outline[4 * k + 1] + disc().outline[4 * k + 2]));
  for (const int count : counts) {
    const PatternMesh mesh = mesh_pattern_with(disc(), count, points);
    const double edge = std::sqrt(area(disc()) / (count * std::sqrt(3.0) / 4));
    for (std::size_t k = 0; k < points.size(); ++k)
      // the number of triangles may be off by 10 %
      EXPECT_LT((mesh.vertices.row(mesh.point_vertex[k]).transpose() - points[k]).norm(),
                edge / 50 * 1.1);
    expect_sound(mesh, disc(), 1, 0.005);
  }
}

TEST(PatternMeshTest, RequiredPointJustInsideARoundBorderIsPartOfTheMesh) {
  // the chord that replaces a piece of the border may cut the point off
  std::vector<Vector2d> points;
  for (int k = 0; k < 64; ++k)
    points.push_back(Vector2d(0.1, 0.1) + 0.998 * (disc().outline[k] - Vector2d(0.1, 0.1)));
  for (const int count : {100, 150, 300, 600}) {
    const PatternMesh mesh =
        mesh_pattern_with(disc(), count, {points[1], points[18], points[35], points[52]});
    SCOPED_TRACE(count);
    expect_sound(mesh, disc(), 1, 0.005);
  }
}

// A round border is followed with chords. Beside one, the end of a crease would be the tip of a
// needle.
TEST(PatternMeshTest, ACreaseThatEndsOnARoundBorderMakesNoNeedle) {
  for (const int from : {1, 2, 3, 4, 5}) {
    Pattern pattern = disc();
    pattern.prescribed_creases.push_back({{pattern.outline[from], pattern.outline[from + 29]}});
    const PatternMesh mesh = mesh_pattern(pattern, 0.03, {});
    expect_sound(mesh, pattern, 1, 0.02);
    for (int t = 0; t < mesh.triangles.rows(); ++t)
      EXPECT_GT(smallest_angle(mesh, t), 15) << "crease from " << from << ", triangle " << t;
  }
}

TEST(PatternMeshTest, ARequiredPointBesideACornerOfTheBorderIsThisCorner) {
  // an edge of a micrometre between them would be off by any percentage
  const Pattern sheet = rectangle(0.1, 0.1);
  for (const double apart : {3e-7, 1e-6, 5e-6}) {
    const PatternMesh mesh =
        mesh_pattern_with(sheet, 120, {Vector2d(0.1 - apart, 0.1), Vector2d(apart, apart)});
    EXPECT_EQ(mesh.vertices.row(mesh.point_vertex[0]), Eigen::RowVector2d(0.1, 0.1));
    EXPECT_EQ(mesh.vertices.row(mesh.point_vertex[1]), Eigen::RowVector2d(0, 0));
    for (int t = 0; t < mesh.triangles.rows(); ++t) EXPECT_GT(smallest_angle(mesh, t), 15) << apart;
  }
}

TEST(PatternMeshTest, AHandleAtTheEndOfACreaseBesideACornerStaysOnTheCrease) {
  Pattern sheet = rectangle(0.1, 0.1);
  const Vector2d end(0.1 - 1e-5, 0.1);
  sheet.prescribed_creases.push_back({{{0.05, 0}, end}});
  const PatternMesh mesh = mesh_pattern_with(sheet, 120, {end});
  EXPECT_LT((mesh.vertices.row(mesh.point_vertex[0]).transpose() - end).norm(), 1e-9);
}

TEST(PatternMeshTest, PointsEqualToFilePrecisionShareAVertex) {
  const std::vector<Vector2d> points = {{0.03, 0.04}, {0.03 + 1e-9, 0.04}, {0.03, 0.04}, {0.07, 0},
                                        {0.07, 1e-9}, {0.1, 0.1 - 1e-9},   {0.1, 0.1}};
  const PatternMesh mesh = mesh_pattern_with(rectangle(0.1, 0.1), 300, points);
  EXPECT_EQ(mesh.point_vertex[0], mesh.point_vertex[1]);
  EXPECT_EQ(mesh.point_vertex[0], mesh.point_vertex[2]);
  EXPECT_EQ(mesh.point_vertex[3], mesh.point_vertex[4]);
  EXPECT_EQ(mesh.point_vertex[5], mesh.point_vertex[6]);
  EXPECT_NE(mesh.point_vertex[0], mesh.point_vertex[3]);
  for (int t = 0; t < mesh.triangles.rows(); ++t) EXPECT_GT(smallest_angle(mesh, t), 5);
}

TEST(PatternMeshTest, TrianglesAreNearlyEquilateralOnPlainShapes) {
  const struct {
    const char* name;
    double width, height;
    bool rows;
  } plain[] = {{"square", 0.1, 0.1, false},
               {"A4", 0.210, 0.297, false},
               {"strip", 0.3, 0.03, false},
               {"square with handle rows", 0.1, 0.1, true},
               {"A4 with handle rows", 0.210, 0.297, true}};
  for (const auto& shape : plain)
    for (const int count : counts) {
      // the handles are closer to each other than the edges of such triangles are long
      if (shape.rows && count < 150) continue;
      const PatternMesh mesh = mesh_pattern_with(
          rectangle(shape.width, shape.height), count,
          shape.rows ? handle_rows(shape.width, shape.height) : std::vector<Vector2d>{});
      double least = 180, mean = 0;
      for (int t = 0; t < mesh.triangles.rows(); ++t) {
        least = std::min(least, smallest_angle(mesh, t));
        mean += smallest_angle(mesh, t) / mesh.triangles.rows();
      }
      EXPECT_GT(least, 15) << shape.name << ", " << count;
      EXPECT_GT(mean, 50) << shape.name << ", " << count;
    }
}

TEST(PatternMeshTest, LatticeAndRoundBorderAreSmoothedTogether) {
  for (const int count : {600, 1700, 6000}) {
    const PatternMesh mesh = mesh_pattern_with(disc(), count, {});
    double least = 180;
    for (int t = 0; t < mesh.triangles.rows(); ++t)
      least = std::min(least, smallest_angle(mesh, t));
    EXPECT_GT(least, 31) << count;  // only 27 to 30 without the smoothing
  }
}

TEST(PatternMeshTest, ShorterEdgesGiveMoreTrianglesOfThatSize) {
  for (const double edge : {0.02, 0.01, 0.004}) {
    const PatternMesh mesh = mesh_pattern(rectangle(0.210, 0.297), edge, {});
    const double expected = 0.210 * 0.297 / (edge * edge * std::sqrt(3.0) / 4);
    // there are whole rows and columns only: half an edge in 0.2 m, twice
    EXPECT_NEAR(mesh.triangles.rows() / expected, 1, 0.12) << edge;
  }
}

TEST(PatternMeshTest, TurnRotatesTheLattice) {
  // fraction of the inner edges that run within 10 degrees of a row of the lattice
  const auto along = [](double turn) {
    const PatternMesh mesh = mesh_pattern(rectangle(0.1, 0.1), 0.004, {}, turn);
    int count = 0, all = 0;
    for (int t = 0; t < mesh.triangles.rows(); ++t)
      for (int i = 0; i < 3; ++i) {
        const Vector2d a = mesh.vertices.row(mesh.triangles(t, i)),
                       b = mesh.vertices.row(mesh.triangles(t, (i + 1) % 3));
        if ((a - Vector2d(0.05, 0.05)).norm() > 0.04) continue;
        // the lattice repeats itself after 60 degrees
        const double angle = std::atan2((b - a).y(), (b - a).x()) * 3;
        ++all;
        count += std::cos(2 * angle - 6 * turn) > std::cos(M_PI / 3);
      }
    return double(count) / all;
  };
  for (const double turn : {0.0, 0.26, M_PI / 6}) EXPECT_GT(along(turn), 0.9) << turn;
}

TEST(PatternMeshTest, VerticesOfRequiredPointsAreRequiredAndNoOthers) {
  PatternMesh mesh;
  EXPECT_TRUE(are_required(mesh).empty()) << "a mesh of nothing";
  mesh.vertices = Points2::Zero(4, 2);
  EXPECT_EQ(are_required(mesh), (std::vector<char>{0, 0, 0, 0})) << "no point is required";
  mesh.point_vertex = {3, 1, 3};
  EXPECT_EQ(are_required(mesh), (std::vector<char>{0, 1, 0, 1})) << "two points share a vertex";
}

TEST(PatternMeshTest, SameInputGivesTheSameMesh) {
  for (const Shape& shape : shapes) {
    const std::vector<Vector2d> points = {{0.01, 0.011}, {0.02, 0.003}};
    const PatternMesh one = mesh_pattern_with(shape.pattern, 700, points),
                      two = mesh_pattern_with(shape.pattern, 700, points);
    ASSERT_EQ(one.vertices.rows(), two.vertices.rows());
    ASSERT_EQ(one.triangles.rows(), two.triangles.rows());
    EXPECT_TRUE(one.vertices == two.vertices) << shape.name;
    EXPECT_TRUE(one.triangles == two.triangles) << shape.name;
  }
}

ErrorCode fault_of(const std::function<void()>& run) {
  try {
    run();
  } catch (const Error& error) {
    EXPECT_NE(error.cause.find("crosses or touches itself"), std::string::npos) << error.what();
    return error.code;
  }
  ADD_FAILURE() << "nothing was thrown";
  return ErrorCode::command;
}

TEST(PatternMeshTest, OutlineThatCrossesItselfIsRejected) {
  const Pattern lopsided{{{0, 0}, {0.2, 0}, {0.05, 0.15}, {0.2, 0.2}, {0, 0.2}, {0.15, 0.05}}, {}};
  // two of its sides cross in the middle of both
  const Pattern bow_tie{{{0, 0}, {0.1, 0.1}, {0.1, 0}, {0, 0.1}}, {}};
  for (const Pattern& pattern : {lopsided, bow_tie})
    for (const double edge : {0.05, 0.03, 0.02, 0.01, 0.007})
      EXPECT_EQ(fault_of([&] { mesh_pattern(pattern, edge, {}); }), ErrorCode::scene) << edge;
  for (const int count : counts) {
    EXPECT_EQ(fault_of([&] { mesh_pattern_with(lopsided, count, {}); }), ErrorCode::scene) << count;
    EXPECT_EQ(fault_of([&] { mesh_pattern_with(bow_tie, count, {}); }), ErrorCode::scene) << count;
  }
}

TEST(PatternMeshTest, OutlineThatTouchesItselfIsRejected) {
  // two squares that share the corner (0.1, 0.1), and a slot that just reaches the opposite side
  const Pattern corner{
      {{0, 0}, {0.1, 0}, {0.1, 0.1}, {0.2, 0.1}, {0.2, 0.2}, {0.1, 0.2}, {0.1, 0.1}, {0, 0.1}}, {}};
  const Pattern cut{{{0, 0}, {0.1, 0}, {0.1, 0.1}, {0.06, 0.1}, {0.05, 0}, {0.04, 0.1}, {0, 0.1}},
                    {}};
  for (const Pattern& pattern : {corner, cut})
    for (const double edge : {0.02, 0.011})
      EXPECT_EQ(fault_of([&] { mesh_pattern(pattern, edge, {}); }), ErrorCode::scene);
}

TEST(PatternMeshTest, HoleThatCrossesTheOutlineIsRejected) {
  Pattern pattern = rectangle(0.1, 0.1);
  pattern.holes = {circle({0.09, 0.05}, 0.03, 24, /*counter_clockwise=*/false)};
  EXPECT_EQ(fault_of([&] { mesh_pattern(pattern, 0.01, {}); }), ErrorCode::scene);
}

TEST(PatternMeshTest, CreasesThatCrossAreRowsOfEdgesInEveryMesh) {
  Pattern pattern{{{0, 0}, {0.2, 0}, {0.2, 0.1}, {0, 0.1}}, {}, {}};
  pattern.prescribed_creases = {{{{0, 0}, {0.2, 0.1}}, 0},
                                {{{0, 0.1}, {0.07, 0.04}, {0.2, 0.02}}, 0},
                                {{{0.1, 0}, {0.1, 0.1}}, 0}};
  double length = 0;
  for (const PrescribedCrease& fold : pattern.prescribed_creases)
    for (std::size_t k = 0; k + 1 < fold.line.size(); ++k)
      length += (fold.line[k + 1] - fold.line[k]).norm();
  for (const double edge : {0.04, 0.013, 0.004}) {
    const PatternMesh mesh = mesh_pattern(pattern, edge, {{0.05, 0.05}});
    Sheet sheet{mesh.vertices, {}, {}, mesh.triangles, {}, pattern.prescribed_creases};
    const Hinges hinges = find_hinges(mesh.triangles);
    const auto lines = crease_of_hinges(sheet, hinges);
    double found = 0;
    for (std::size_t h = 0; h < lines.size(); ++h)
      if (lines[h])
        found += (mesh.vertices.row(hinges.hinges[h].vertices[0]) -
                  mesh.vertices.row(hinges.hinges[h].vertices[1]))
                     .norm();
    EXPECT_NEAR(found, length, 1e-9) << edge;
    EXPECT_EQ(mesh.vertices.row(mesh.point_vertex[0]), Eigen::RowVector2d(0.05, 0.05));
  }
}

}  // namespace
}  // namespace paperbake
