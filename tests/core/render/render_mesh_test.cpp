#include "core/render/render_mesh.h"
#include "core/model/segment2.h"

#include "core/geometry/hinges.h"
#include "core/geometry/point_location.h"
#include "core/geometry/prescribed_creases.h"
#include "core/geometry/random.h"
#include "core/model/error.h"
#include "core/render/creased_normals.h"
#include "core/render/subdivision.h"
#include "tests/core/test_meshes.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

double min_angle(const Points2& pattern, const Triangles& triangles) {
  double least = M_PI;
  for (int t = 0; t < triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i) {
      const Vector2d u = pattern.row(triangles(t, (i + 1) % 3)) - pattern.row(triangles(t, i));
      const Vector2d v = pattern.row(triangles(t, (i + 2) % 3)) - pattern.row(triangles(t, i));
      least = std::min(least, std::atan2(cross(u, v), u.dot(v)));
    }
  return least;
}

double length_of(const RenderMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b] : mesh.creases) sum += (mesh.pattern.row(a) - mesh.pattern.row(b)).norm();
  return sum;
}

double area_of(const RenderMesh& mesh) {
  double sum = 0;
  for (int t = 0; t < mesh.triangles.rows(); ++t) {
    const Vector2d u =
        mesh.pattern.row(mesh.triangles(t, 1)) - mesh.pattern.row(mesh.triangles(t, 0));
    const Vector2d v =
        mesh.pattern.row(mesh.triangles(t, 2)) - mesh.pattern.row(mesh.triangles(t, 0));
    sum += 0.5 * cross(u, v);
  }
  return sum;
}

TEST(RenderMeshTest, HasEveryPointAndEveryCrease) {
  const RenderFeatures features{{{0.03, 0.04}, {0, 0.05}, {0.1, 0.1}},
                                {{{0.03, 0.04}, {0.1, 0.0773}}, {{0.01, 0.09}, {0.09, 0.015}}}};
  const RenderMesh mesh = mesh_for_render(test::rectangle(0.1, 0.1), 0.002, features);
  for (std::size_t k = 0; k < features.points.size(); ++k)
    EXPECT_LT((mesh.pattern.row(mesh.point_vertex[k]).transpose() - features.points[k]).norm(),
              1e-12);
  double wanted = 0;
  for (const CreaseSegment& c : features.creases) wanted += (c.b - c.a).norm();
  EXPECT_NEAR(length_of(mesh), wanted, 0.01 * wanted);
  for (const auto& [a, b] : mesh.creases)
    for (const int v : {a, b}) {
      double least = 1;
      for (const CreaseSegment& c : features.creases) {
        const Vector2d d = (c.b - c.a).normalized(), p = mesh.pattern.row(v).transpose() - c.a;
        least = std::min(least, std::abs(cross(p, d)));
      }
      EXPECT_LT(least, 1e-9) << "vertices of creases lie on them";
    }
  EXPECT_NEAR(area_of(mesh), 0.01, 1e-12);
  EXPECT_GT(min_angle(mesh.pattern, mesh.triangles), 20 * M_PI / 180);
  const double equilateral = 0.01 / (std::sqrt(0.1875) * 0.002 * 0.002);
  EXPECT_NEAR(mesh.triangles.rows(), equilateral, 0.15 * equilateral);
}

TEST(RenderMeshTest, SimulatedEdgesAreRowsOfEdges) {
  // two meshes of one shot, whose edges cross at all angles
  const Sheet meshes[] = {test::hex_sheet(0.1, 0.1, 6, 0.2, 1),
                          test::hex_sheet(0.1, 0.1, 5, 0.2, 2)};
  RenderFeatures features{{{0.03, 0.04}}, {}};
  for (const Sheet& sheet : meshes)
    for (const Hinge& hinge : find_hinges(sheet.triangles).hinges)
      features.edges.push_back(
          {sheet.pattern.row(hinge.vertices[0]), sheet.pattern.row(hinge.vertices[1])});
  features.creases = {features.edges[7]};
  const RenderMesh mesh = mesh_for_render(test::rectangle(0.1, 0.1), 0.003, features);
  ASSERT_EQ(mesh.simulated_edges, SimulatedEdges::kept);
  EXPECT_NEAR(area_of(mesh), 0.01, 1e-12);
  EXPECT_NEAR(length_of(mesh), (features.edges[7].b - features.edges[7].a).norm(), 1e-6);
  EXPECT_LT((mesh.pattern.row(mesh.point_vertex[0]).transpose() - features.points[0]).norm(),
            1e-12);
  for (const Sheet& sheet : meshes) {
    const PointLocator locator(sheet.pattern, sheet.triangles);
    for (int t = 0; t < mesh.triangles.rows(); ++t) {
      Vector2d middle = Vector2d::Zero();
      for (int i = 0; i < 3; ++i) middle += mesh.pattern.row(mesh.triangles(t, i)).transpose() / 3;
      const int under = locator.locate(middle).triangle;
      for (int i = 0; i < 3; ++i) {
        const Vector2d p = mesh.pattern.row(mesh.triangles(t, i));
        for (int k = 0; k < 3; ++k) {  // inside each side of the simulated triangle
          const Vector2d a = sheet.pattern.row(sheet.triangles(under, k)),
                         d = (sheet.pattern.row(sheet.triangles(under, (k + 1) % 3)).transpose() -
                              a)
                                 .normalized();
          EXPECT_GT(cross(d, p - a), -3e-7) << "a millionth of the sheet, and what comes of it";
        }
      }
    }
  }
  EXPECT_EQ(mesh_for_render(test::rectangle(0.1, 0.1), 0.03, features).simulated_edges,
            SimulatedEdges::too_long)
      << "no room: 3.6 m of edges, and 2 m may be";
}

TEST(RenderMeshTest, SimulatedEdgesThatNearlyCoincideAreKeptOrLeftOutAndTheMeshSaysSo) {
  // Edges that cross within a millionth of the sheet. Which of them no triangulation has is a
  // matter of rounding.
  RenderFeatures features;
  for (int k = 1; k <= 40; ++k) {
    const double off = 2.5e-8 * k;
    features.edges = {{{0.0213, 0.0517}, {0.0831, 0.0529}},
                      {{0.0213, 0.0517 - off}, {0.0831, 0.0529 + off}}};
    const RenderMesh mesh = mesh_for_render(test::rectangle(0.1, 0.1), 0.003, features);
    EXPECT_NEAR(area_of(mesh), 0.01, 1e-12) << off;
    EXPECT_TRUE(mesh.simulated_edges == SimulatedEdges::kept ||
                mesh.simulated_edges == SimulatedEdges::too_close)
        << off;
  }
  features.edges.pop_back();
  EXPECT_EQ(mesh_for_render(test::rectangle(0.1, 0.1), 0.003, features).simulated_edges,
            SimulatedEdges::kept);
  features.edges.clear();
  EXPECT_EQ(mesh_for_render(test::rectangle(0.1, 0.1), 0.003, features).simulated_edges,
            SimulatedEdges::none);
}

TEST(RenderMeshTest, SimulatedEdgesThatNoTriangulationHasAreLeftOutAndTheMeshSaysSo) {
  // one that leads across a hole, and one that leaves the sheet: they cross the border whatever the
  // rounding
  Pattern holed = test::rectangle(0.1, 0.1);
  holed.holes = {{{0.04, 0.04}, {0.04, 0.06}, {0.06, 0.06}, {0.06, 0.04}}};
  RenderFeatures features;
  features.edges = {{{0.02, 0.05}, {0.08, 0.0513}}};
  const RenderMesh around = mesh_for_render(holed, 0.003, features);
  EXPECT_EQ(around.simulated_edges, SimulatedEdges::too_close);
  EXPECT_NEAR(area_of(around), 0.01 - 0.0004, 1e-12);

  features.edges = {{{0.02, 0.05}, {0.08, 0.12}}};
  const RenderMesh inside = mesh_for_render(test::rectangle(0.1, 0.1), 0.003, features);
  EXPECT_EQ(inside.simulated_edges, SimulatedEdges::too_close);
  EXPECT_NEAR(area_of(inside), 0.01, 1e-12);
}

TEST(RenderMeshTest, AnOutlineThatCrossesItselfIsAnErrorWithSimulatedEdgesToo) {
  const Pattern crossed{{{0, 0}, {0.1, 0.1}, {0.1, 0}, {0, 0.1}}, {}};
  RenderFeatures features{{}, {}};
  EXPECT_THROW(mesh_for_render(crossed, 0.003, features), Error);
  features.edges = {{{0.04, 0.05}, {0.06, 0.05}}};
  EXPECT_THROW(mesh_for_render(crossed, 0.003, features), Error);
}

TEST(RenderMeshTest, ACreaseThatMeetsTheBorderAtASmallAngleIsComplete) {
  for (const double slope : {1.0, 0.5, 0.3, 0.2}) {
    const RenderFeatures features{{}, {{{0.0311, 0.0}, {0.07, 0.0389 * slope}}}};
    const RenderMesh mesh = mesh_for_render(test::rectangle(0.1, 0.1), 0.002, features);
    const double wanted = (features.creases[0].b - features.creases[0].a).norm();
    EXPECT_NEAR(length_of(mesh), wanted, 1e-6) << "slope " << slope;
    EXPECT_GT(min_angle(mesh.pattern, mesh.triangles), 8 * M_PI / 180) << "slope " << slope;
    EXPECT_NEAR(area_of(mesh), 0.01, 1e-12);
  }
}

TEST(RenderMeshTest, CreasesThatFanOutFromAPointBeginOnTheirOwnLines) {
  const double edge = 0.002;
  const Vector2d tip(0.05, 0.05);
  for (const double apart : {0.35, 0.45, 0.6}) {  // [rad]
    RenderFeatures features{{tip}, {}};
    for (const double angle : {0.2, 0.2 + apart, 0.2 + 2 * apart})
      features.creases.push_back({tip, tip + 0.04 * Vector2d(std::cos(angle), std::sin(angle))});
    const RenderMesh mesh = mesh_for_render(test::rectangle(0.1, 0.1), edge, features);
    EXPECT_NEAR(length_of(mesh), 3 * 0.04, 1e-3 * 0.04) << apart;
    for (const auto& [a, b] : mesh.creases) {
      double off = 1;  // of both ends from one line
      for (const CreaseSegment& line : features.creases) {
        const double ends[] = {distance_to_segment(mesh.pattern.row(a), line.a, line.b),
                               distance_to_segment(mesh.pattern.row(b), line.a, line.b)};
        off = std::min(off, std::max(ends[0], ends[1]));
      }
      EXPECT_LT(off, 0.1 * edge) << apart << ": a fold would cut through triangles";
    }
  }
}

TEST(RenderMeshTest, ManyCreasesMakeNoNeedles) {
  RenderFeatures features;
  for (int k = 0; k < 60; ++k) {
    const auto at = [&](int i) { return 0.1 * uniform(5, 4 * k + i); };
    features.creases.push_back({{at(0), at(1)}, {at(2), at(3)}, 1.0});
  }
  for (int k = 0; k < 10; ++k)  // side by side, and one of them twice
    features.creases.push_back({{0.02, 0.03 + 2e-4 * k}, {0.08, 0.03 - 1e-4 * k}, 1.0});
  features.creases.push_back(features.creases.back());
  const RenderMesh mesh = mesh_for_render(test::rectangle(0.1, 0.1), 0.002, features);
  EXPECT_GT(mesh.creases.size(), 400u);
  EXPECT_GT(min_angle(mesh.pattern, mesh.triangles), 8 * M_PI / 180);
  EXPECT_NEAR(area_of(mesh), 0.01, 1e-12);
}

TEST(RenderMeshTest, CreasesBesideAPrescribedOneMakeNoNeedles) {
  // a fold that is found while paper bends has sharp edges of the meshes before it on both sides
  RenderFeatures features;
  const Vector2d begin(0, 0.02), end(0.1, 0.085);
  Pattern pattern = test::rectangle(0.1, 0.1);
  pattern.prescribed_creases = {{{begin, end}}};
  for (int k = 0; k < 40; ++k) {
    const double along = uniform(7, 3 * k), turn = 0.3 * (uniform(7, 3 * k + 1) - 0.5),
                 beside = 2e-3 * (uniform(7, 3 * k + 2) - 0.5);
    const Vector2d way = 0.015 * (Eigen::Rotation2Dd(turn) * (end - begin).normalized()),
                   middle = begin + (0.1 + 0.8 * along) * (end - begin) + Vector2d(0, beside);
    features.creases.push_back({middle - way, middle + way, 1.0 + k});
  }
  features.creases.push_back({{0.05, 0.01}, {0.05, 0.09}, 100.0});  // straight across
  const RenderMesh mesh = mesh_for_render(pattern, 0.002, features);
  EXPECT_GT(min_angle(mesh.pattern, mesh.triangles), 7 * M_PI / 180);
  EXPECT_NEAR(area_of(mesh), 0.01, 1e-12);
  double prescribed = 0, across = 0;
  for (const auto& [a, b] : mesh.creases) {
    const double length = (mesh.pattern.row(a) - mesh.pattern.row(b)).norm();
    if (is_on_crease(mesh.prescribed_creases, mesh.pattern, a, b)) prescribed += length;
    // a point of it that lies beside the prescribed one has moved onto that, by 0.31 edges at most
    if (std::abs(mesh.pattern(a, 0) - 0.05) < 7e-4 && std::abs(mesh.pattern(b, 0) - 0.05) < 7e-4)
      across += length;
  }
  EXPECT_NEAR(prescribed, (end - begin).norm(), 1e-6);
  EXPECT_NEAR(across, 0.08, 1e-3);
}

TEST(RenderMeshTest, LeavesOutTheLightestCreasesWhenThereAreTooMany) {
  RenderFeatures features;
  for (int k = 1; k < 100; ++k)
    features.creases.push_back({{0.001 * k, 0.0}, {0.001 * k, 0.1}, k == 50 ? 2.0 : 1.0});
  const RenderMesh mesh = mesh_for_render(test::rectangle(0.1, 0.1), 0.005, features);
  // a row of edges may be a little longer than its crease
  EXPECT_LT(length_of(mesh), 1.01 * 0.5 * 0.01 / 0.005);
  double heaviest = 0;
  for (const auto& [a, b] : mesh.creases)
    if (std::abs(mesh.pattern(a, 0) - 0.05) < 1e-9 && std::abs(mesh.pattern(b, 0) - 0.05) < 1e-9)
      heaviest += (mesh.pattern.row(a) - mesh.pattern.row(b)).norm();
  EXPECT_NEAR(heaviest, 0.1, 1e-6);
}

TEST(RenderMeshTest, HasNoMoreTrianglesThanAllowed) {
  const RenderFeatures features{{}, {{{0.01, 0.01}, {0.09, 0.08}}}};
  const RenderMesh mesh = mesh_for_render(test::rectangle(0.1, 0.1), 0.001, features, 3000);
  EXPECT_LE(mesh.triangles.rows(), 3000);
  EXPECT_GT(mesh.triangles.rows(), 2500);
}

TEST(RenderMeshTest, FollowsAFineBorder) {
  Pattern disc;
  for (int k = 0; k < 2000; ++k)
    disc.outline.emplace_back(0.05 + 0.05 * std::cos(M_PI * k / 1000),
                              0.05 + 0.05 * std::sin(M_PI * k / 1000));
  const RenderMesh mesh = mesh_for_render(disc, 0.002, {});
  double most = 0;
  for (int v = 0; v < mesh.pattern.rows(); ++v)
    most = std::max(most, (mesh.pattern.row(v) - Eigen::RowVector2d(0.05, 0.05)).norm());
  EXPECT_NEAR(most, 0.05, 1e-9);
  EXPECT_NEAR(area_of(mesh), M_PI * 0.05 * 0.05, 1e-4 * 0.0079);
}

/// A sheet folded by `angle` [rad] along a line of its mesh, bent to radius R [m] on both sides.
struct Folded {
  RenderMesh mesh =
      mesh_for_render(test::rectangle(0.1, 0.1), 0.004, {{}, {{{0.05, 0.0}, {0.05, 0.1}}}});
  Points3 x;
  Folded(double angle, double R) : x(mesh.pattern.rows(), 3) {
    for (int v = 0; v < x.rows(); ++v) {
      const double s = mesh.pattern(v, 0) - 0.05, side = s > 0 ? 1 : -1, a = std::abs(s) / R;
      const Vector2d arc(R * std::sin(a), R * (std::cos(a) - 1));
      const double c = std::cos(angle / 2), d = std::sin(angle / 2);
      x.row(v) << side * (c * arc.x() + d * arc.y()), mesh.pattern(v, 1),
          -d * arc.x() + c * arc.y();
    }
  }
  /// Normal of the curved sheet at distance s on the pattern, on one side of the fold.
  static Vector3d normal(double s, double side, double angle, double R) {
    const double a = std::abs(s) / R + angle / 2;
    return {side * std::sin(a), 0, std::cos(a)};
  }
};

double worst_normal(const Points3& x, const RenderMesh& mesh, const CreasedNormals& normals,
                    double angle, double R) {
  const Points3 n = normals.normals(x);
  double worst = 0;
  for (int t = 0; t < mesh.triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i) {
      double middle = 0;
      for (int k = 0; k < 3; ++k) middle += (mesh.pattern(mesh.triangles(t, k), 0) - 0.05) / 3;
      const Vector2d p = mesh.pattern.row(mesh.triangles(t, i));
      if (p.minCoeff() < 1e-9 || p.maxCoeff() > 0.1 - 1e-9) continue;
      const Vector3d wanted = Folded::normal(p.x() - 0.05, middle > 0 ? 1 : -1, angle, R);
      worst =
          std::max(worst, std::acos(std::min(1.0, wanted.dot(n.row(normals.of_corner()(t, i))))));
    }
  return worst * 180 / M_PI;
}

TEST(RenderMeshTest, NormalsAreSplitAtAFoldAndSmoothBesideIt) {
  const double R = 0.04, angle = 1.2;
  const Folded folded(angle, R);
  const CreasedNormals normals(folded.mesh.triangles, folded.mesh.creases);
  // At the fold a normal has triangles on one side only, so it is the normal half an edge away:
  // 4 mm turn by 5.7 degrees.
  EXPECT_LT(worst_normal(folded.x, folded.mesh, normals, angle, R), 3.5);
  // plus one edge of the bend
  EXPECT_NEAR(normals.strength(folded.x).maxCoeff(), angle + 0.1, 0.05);
  EXPECT_GT(normals.of_corner().maxCoeff() + 1, folded.mesh.pattern.rows());
}

TEST(RenderMeshTest, NormalsOfAFlatCreaseAreTheSameOnBothSides) {
  const Folded folded(0, 0.04);
  const CreasedNormals creased(folded.mesh.triangles, folded.mesh.creases),
      smooth(folded.mesh.triangles, {});
  const Points3 a = creased.normals(folded.x), b = smooth.normals(folded.x);
  ASSERT_GT(a.rows(), b.rows());
  for (int t = 0; t < folded.mesh.triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i)
      EXPECT_LT((a.row(creased.of_corner()(t, i)) - b.row(smooth.of_corner()(t, i))).norm(), 1e-12);
}

TEST(RenderMeshTest, SubdivisionOfAFoldedRollKeepsRadiusAndFold) {
  const double R = 0.04, angle = 1.2;
  const Folded folded(angle, R);
  const CreasedNormals normals(folded.mesh.triangles, folded.mesh.creases);
  const Subdivision fine = subdivide(folded.mesh, normals.of_corner());
  EXPECT_EQ(fine.mesh.triangles.rows(), 4 * folded.mesh.triangles.rows());
  EXPECT_EQ(fine.mesh.creases.size(), 2 * folded.mesh.creases.size());
  EXPECT_NEAR(area_of(fine.mesh), 0.01, 1e-12);
  const Points3 x = fine.positions(folded.x, normals.normals(folded.x));
  double chord = 0, off = 0;
  const double c = std::cos(angle / 2), d = std::sin(angle / 2);
  const Vector3d axis[2] = {{-d * R, 0, -c * R}, {d * R, 0, -c * R}};
  for (std::size_t m = 0; m < fine.middles.size(); ++m) {
    const int v = static_cast<int>(folded.x.rows() + m);
    const double s = fine.mesh.pattern(v, 0) - 0.05;
    // normals at the border have triangles on one side only
    if (fine.mesh.pattern.row(v).minCoeff() < 0.004 || fine.mesh.pattern.row(v).maxCoeff() > 0.096)
      continue;
    const Vector3d& centre = axis[s < 0];
    const auto radius = [&](const Eigen::RowVector3d& p) {
      return std::hypot(p.x() - centre.x(), p.z() - centre.z());
    };
    chord = std::max(
        chord,
        std::abs(radius(0.5 * (folded.x.row(fine.middles[m].a) + folded.x.row(fine.middles[m].b))) -
                 R));
    off = std::max(off, std::abs(radius(x.row(v)) - R));
  }
  ASSERT_GT(chord, 3e-5);  // 4 mm over 8 R
  EXPECT_LT(off, 0.5 * chord);
  // [deg] 3.3 before the subdivision
  EXPECT_LT(
      worst_normal(x, fine.mesh, CreasedNormals(fine.mesh.triangles, fine.mesh.creases), angle, R),
      2.8);
}

}  // namespace
}  // namespace paperbake
