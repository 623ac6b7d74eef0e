#include "core/step2_crumple/edge_flips.h"

#include "core/geometry/curvature.h"
#include "core/geometry/hinges.h"
#include "core/geometry/measure.h"
#include "tests/core/geometry/sound_mesh.h"
#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace paperbake {
namespace {

/// How far the folded edges of the sheet run across its rulings instead of along them:
/// sum |theta| l |across . edge| / sum |theta| l.
double misalignment(const Sheet& sheet, const Vector2d& across) {
  double off = 0, all = 0;
  for (const Hinge& hinge : find_hinges(sheet.triangles).hinges) {
    const Vector2d edge =
        (sheet.pattern.row(hinge.vertices[1]) - sheet.pattern.row(hinge.vertices[0])).transpose();
    const double weight = std::abs(dihedral_angle(sheet.x, hinge)) * edge.norm();
    off += weight * std::abs(edge.normalized().dot(across));
    all += weight;
  }
  return off / all;
}

TEST(EdgeFlipsTest, EdgesFlipTowardsTheRulingsOfACylinder) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 6, 0.25, 5);
  for (int v = 0; v < sheet.pattern.rows(); ++v) {  // rulings at 40 degrees
    const double c = std::cos(0.7), s = std::sin(0.7), R = 0.04;
    const double u = c * sheet.pattern(v, 0) + s * sheet.pattern(v, 1),
                 w = -s * sheet.pattern(v, 0) + c * sheet.pattern(v, 1);
    sheet.x.row(v) << R * std::sin(u / R), w, R * (std::cos(u / R) - 1);
  }
  const Vector2d across(std::cos(0.7), std::sin(0.7));
  const double before = misalignment(sheet, across), stretch = length_distortion(sheet).mean;
  const Points3 curvature = vertex_curvature(sheet);
  EXPECT_GT(flip_towards_rulings(sheet, curvature, 0.8), 5);
  EXPECT_LT(misalignment(sheet, across), 0.8 * before);
  EXPECT_LT(length_distortion(sheet).mean, stretch);  // edges along rulings keep their length
  test::expect_sound(sheet, 0.01);
  EXPECT_EQ(flip_towards_rulings(sheet, curvature, 0.8), 0);  // nothing is left to flip
}

TEST(EdgeFlipsTest, FlatSheetKeepsItsNearlyDelaunayMesh) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 8);
  EXPECT_EQ(flip_towards_rulings(sheet, vertex_curvature(sheet), 0.8), 0);
}

TEST(EdgeFlipsTest, AFlipPassesThroughNoOtherLayer) {
  // a saddle of two triangles over the longer diagonal, and a blade that stands between the two
  // diagonals
  Sheet pair = test::flat_sheet((Points2(4, 2) << 0, 0, 0.1, 0, 0.05, 0.03, 0.05, -0.03).finished(),
                                (Triangles(2, 3) << 0, 1, 2, 1, 0, 3).finished());
  pair.x.row(2)[2] = pair.x.row(3)[2] = 0.004;
  Sheet bladed = pair;
  bladed.pattern.conservativeResize(7, 2);
  bladed.pattern.bottomRows<3>() << 1, 0, 1.1, 0, 1, 0.1;
  bladed.x.conservativeResize(7, 3);
  bladed.x.bottomRows<3>() << 0.03, 0, 0.002, 0.07, 0, 0.002, 0.05, 0, 0.0025;
  bladed.triangles.conservativeResize(3, 3);
  bladed.triangles.row(2) << 4, 5, 6;
  EXPECT_EQ(flip_towards_rulings(pair, Points3::Zero(4, 3), 0.8), 1);
  EXPECT_EQ(flip_towards_rulings(bladed, Points3::Zero(7, 3), 0.8), 0);
}

}  // namespace
}  // namespace paperbake
