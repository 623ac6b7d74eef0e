#include "core/step2_crumple/vertex_insertion.h"

#include "core/geometry/measure.h"
#include "core/geometry/random.h"
#include "tests/core/geometry/sound_mesh.h"
#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

TEST(VertexInsertionTest, InsertedPointBecomesAVertexAndTheMeshStaysSound) {
  int exact = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    Sheet sheet = test::hex_sheet(0.1, 0.1, 6, 0.1, seed);
    test::roll(sheet, 0.05);
    // every other time no vertex may move, so that triangles have to be split
    std::vector<char> fixed(sheet.pattern.rows(), seed % 2);
    for (int k = 0; k < 5; ++k) {
      const Vector2d p(0.05 + 0.04 * uniform(seed, 2 * k), 0.05 + 0.04 * uniform(seed, 2 * k + 1));
      const int v = insert_vertex(sheet, p, fixed);
      const double beside = (sheet.pattern.row(v).transpose() - p).norm();
      // a fifth of an altitude: the vertex lies farther inside where it would cut across a fold
      EXPECT_LT(beside, 0.2 * 0.0167);
      exact += beside < 1e-15;
      sheet.singular.push_back({sheet.pattern.row(v).transpose(), 1, "test"});
      EXPECT_NEAR(sheet.x(v, 1), sheet.pattern(v, 1), 2e-3);  // on a chord of the cylinder
      EXPECT_EQ(sheet.v.rows(), sheet.pattern.rows());
      fixed.resize(sheet.pattern.rows(), 0);
    }
    test::expect_sound(sheet, 0.01);
  }
  EXPECT_GT(exact, 0.7 * 60 * 5);
}

TEST(VertexInsertionTest, PointInsertedNearAnEdgeTurnsNoTriangleOver) {
  // the lower triangle is so flat that points above the left half of the common edge are not
  // visible from its tip
  Points2 pattern(4, 2);
  pattern << 0, 0, 1, 0, 0.3, 0.5, -0.8, -0.1;
  Triangles triangles(2, 3);
  triangles << 0, 1, 2, 1, 0, 3;
  for (double x = 0.05; x < 0.95; x += 0.05)
    for (const double y : {0.01, 0.03, 0.05, 0.07}) {
      Sheet sheet = test::flat_sheet(pattern, triangles);
      sheet.x(3, 2) = -0.01;  // a fold
      insert_vertex(sheet, {x, y}, {1, 1, 1, 1});
      test::expect_sound(sheet, 0.3);
    }
}

TEST(VertexInsertionTest, APointJustBesideAFoldStaysInItsTriangle) {
  // two triangles folded by 90 degrees: a point just beside the fold stays in its own triangle
  Sheet bent = test::flat_sheet((Points2(4, 2) << 0, 0, 0.1, 0, 0.05, 0.08, 0.05, -0.08).finished(),
                                (Triangles(2, 3) << 0, 1, 2, 1, 0, 3).finished());
  bent.x.row(3) << 0.05, 0, -0.08;
  insert_vertex(bent, {0.05, 0.004}, {});
  EXPECT_LT(length_distortion(bent).largest, 1e-12);
  EXPECT_EQ(bent.triangles.rows(), 4);
}

}  // namespace
}  // namespace paperbake
