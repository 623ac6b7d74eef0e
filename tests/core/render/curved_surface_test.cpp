#include "core/render/curved_surface.h"

#include "core/geometry/hinges.h"
#include "core/render/shot_record.h"
#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace paperbake {
namespace {

/// A sheet of ruling strips rolled to radius R: rulings along y, vertices on the arc. [m]
Sheet ruled_roll(double R, int strips) {
  Sheet sheet = test::strip_sheet(0.1, 0.05, strips);
  test::roll(sheet, R);
  return sheet;
}

/// Largest |distance from the axis of this roll - R| over points of the inner triangles. [m]
double off_the_cylinder(const CurvedSurface& surface, double R, int from_border) {
  double most = 0;
  for (int t = from_border; t < surface.triangles.rows() - from_border; ++t)
    for (const Vector3d& b : {Vector3d(1. / 3, 1. / 3, 1. / 3), Vector3d(.6, .2, .2),
                              Vector3d(.1, .1, .8), Vector3d(0, .5, .5)}) {
      const Vector3d x = surface.at({t, b});
      most = std::max(most, std::abs(std::hypot(x.x(), x.z() + R) - R));
    }
  return most;
}

TEST(CurvedSurfaceTest, StripsOfACylinderBecomeACylinder) {
  const double R = 0.03;
  const Sheet sheet = ruled_roll(R, 12);
  CurvedSurface flat = curve(sheet), curved = flat;
  flat.bulge.setZero();
  flat.corners = sheet.x;
  // Drawing the corners in removes half of the mean height of the patches. It is undone here, to
  // compare with the arc.
  curved.corners = sheet.x;
  const double chord = off_the_cylinder(flat, R, 6);
  ASSERT_GT(chord, 2e-4);  // the strips are 8.3 mm wide: 0.29 mm below their arc
  EXPECT_LT(off_the_cylinder(curved, R, 6), 0.1 * chord);
}

TEST(CurvedSurfaceTest, TheSurfaceHasNoGapsOnAnyMesh) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 8, 0.25);
  test::roll(sheet, 0.03);
  // and not developable
  for (int v = 0; v < sheet.x.rows(); ++v)
    sheet.x(v, 2) += 2e-3 * std::sin(900 * sheet.pattern(v, 1));
  const CurvedSurface surface = curve(sheet);
  const Hinges hinges = find_hinges(sheet.triangles);
  double max_bulge = 0;
  for (const Hinge& hinge : hinges.hinges) {
    Vector3d middle[2];
    for (int side = 0; side < 2; ++side) {
      Vector3d b(0, 0, 0);
      for (int i = 0; i < 3; ++i) {
        const int v = sheet.triangles(hinge.triangles[side], i);
        if (v == hinge.vertices[0]) b[i] = 0.3;
        if (v == hinge.vertices[1]) b[i] = 0.7;
      }
      middle[side] = surface.at({hinge.triangles[side], b});
    }
    EXPECT_LT((middle[0] - middle[1]).norm(), 1e-15);
    max_bulge = std::max(max_bulge, surface.bulge.row(3 * hinge.triangles[0]).norm());
  }
  EXPECT_GT(max_bulge, 1e-4);
}

TEST(CurvedSurfaceTest, AFoldStaysSharpAndTheSheetBesideItFlat) {
  Sheet sheet = test::strip_sheet(0.1, 0.05, 8);
  for (int v = 0; v < sheet.x.rows(); ++v) {  // folded by 90 degrees along x = 0.05
    const double s = sheet.pattern(v, 0) - 0.05;
    sheet.x.row(v) << std::min(s, 0.0), sheet.pattern(v, 1), -std::max(s, 0.0);
  }
  const CurvedSurface surface = curve(sheet);
  EXPECT_LT((surface.corners - sheet.x).cwiseAbs().maxCoeff(), 1e-15);
  EXPECT_LT(surface.bulge.cwiseAbs().maxCoeff(), 1e-12);
}

TEST(CurvedSurfaceTest, HeldVerticesAreNotDrawnIn) {
  const Sheet sheet = ruled_roll(0.02, 8);
  const CurvedSurface all = curve(sheet), held = curve(sheet, {6, 7});
  ASSERT_GT((all.corners.row(6) - sheet.x.row(6)).norm(), 1e-5);
  EXPECT_EQ((held.corners.row(6) - sheet.x.row(6)).norm(), 0);
  EXPECT_EQ((held.corners.row(7) - sheet.x.row(7)).norm(), 0);
}

TEST(CurvedSurfaceTest, CreaseShareRisesSmoothlyFromZeroToOne) {
  EXPECT_EQ(crease_share(0.4), 0);
  EXPECT_EQ(crease_share(-0.8), 1);
  EXPECT_NEAR(crease_share(0.6), 0.5, 1e-12);
  EXPECT_EQ(crease_share(0.55), crease_share(-0.55));
}

TEST(CurvedSurfaceTest, ACreaseThatHandsHaveFoldedAndOpenedAgainStaysSharpAsRecorded) {
  constexpr double turn = 15 * M_PI / 180, middle = 0.05;  // [rad], [m]
  Sheet sheet = test::strip_sheet(2 * middle, 0.03, 4);
  for (int v = 0; v < sheet.x.rows(); ++v)
    if (const double beyond = sheet.pattern(v, 0) - middle; beyond > 1e-9)
      sheet.x.row(v) << middle + beyond * std::cos(turn), sheet.pattern(v, 1),
          beyond * std::sin(turn);
  const double low = sheet.pattern.col(1).minCoeff(), high = sheet.pattern.col(1).maxCoeff();
  sheet.prescribed_creases = {{{{middle, low}, {middle, high}}, 0, false}};
  ShotRecord record;
  for (const bool folded : {false, true}) {
    sheet.crease_edges = {{{middle, low}, {middle, high}, 0, folded, {}}};
    AnimatedFrame frame;
    frame.sheet = &sheet;
    record.add(frame);
  }
  const auto bulge = [&](int k) {
    return curve(record.sheet(record.frames()[k]), {}).bulge.cwiseAbs().maxCoeff();
  };
  EXPECT_GT(bulge(0), 1e-4) << "paper that has never been folded here bends";
  EXPECT_LT(bulge(1), 1e-8) << "two flat parts that meet at a crease, in 32 bits";
}

}  // namespace
}  // namespace paperbake
