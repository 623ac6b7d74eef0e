#include "core/geometry/mesh_transfer.h"

#include "core/geometry/pattern_mesh.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

PatternMesh mesh_of(double edge) {
  Pattern pattern;
  pattern.outline = {{0, 0}, {0.2, 0}, {0.2, 0.1}, {0, 0.1}};
  return mesh_pattern(pattern, edge, {});
}

/// An affine map of the pattern into space, which is linear in every triangle of every mesh.
Points3 affine(const Points2& pattern, double along, double across) {
  Points3 values(pattern.rows(), 3);
  for (int v = 0; v < values.rows(); ++v)
    values.row(v) << along * pattern(v, 0) + 0.3, across * pattern(v, 1), pattern(v, 0) - 0.2;
  return values;
}

TEST(MeshTransfer, ASheetOnAnotherMeshIsWhereItWasAndMovesAndHasItsPointsAndCreases) {
  PatternMesh coarse = mesh_of(0.03), fine = mesh_of(0.011);
  ASSERT_NE(coarse.vertices.rows(), fine.vertices.rows());
  const Sheet before{coarse.vertices,
                     affine(coarse.vertices, 1, 2),
                     affine(coarse.vertices, -3, 5),
                     coarse.triangles,
                     {{{0.05, 0.05}, 7, "here"}},
                     {{{{0.1, 0}, {0.1, 0.1}}, 0.5, true}},
                     {{{0.1, 0}, {0.1, 0.1}, 0.4, true, {}}}};
  const Sheet after = on_other_mesh(before, fine.vertices, fine.triangles);
  EXPECT_EQ(after.pattern, fine.vertices);
  EXPECT_EQ(after.triangles, fine.triangles);
  EXPECT_LT((after.x - affine(fine.vertices, 1, 2)).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_LT((after.v - affine(fine.vertices, -3, 5)).cwiseAbs().maxCoeff(), 1e-14);
  ASSERT_EQ(after.singular.size(), 1u);
  EXPECT_EQ(after.singular[0].frame_of_birth, 7);
  ASSERT_EQ(after.prescribed_creases.size(), 1u);
  EXPECT_EQ(after.prescribed_creases[0].angle, 0.5);
  ASSERT_EQ(after.crease_edges.size(), 1u);
  EXPECT_EQ(after.crease_edges[0].rest_angle, 0.4);
}

}  // namespace
}  // namespace paperbake
