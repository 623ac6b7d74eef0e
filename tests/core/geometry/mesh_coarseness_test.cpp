// How coarse the triangles of a bent sheet are.

#include "core/geometry/mesh_coarseness.h"

#include <gtest/gtest.h>

#include <cmath>

namespace paperbake {
namespace {

/// A strip of flat pieces of this width [m], each turned by this angle [rad] from the one before,
/// and cut in two along a diagonal.
Sheet polygon_of(int pieces, double width, double turn) {
  Sheet sheet;
  sheet.pattern.resize(2 * (pieces + 1), 2);
  sheet.x.resize(2 * (pieces + 1), 3);
  sheet.triangles.resize(2 * pieces, 3);
  Vector2d at = Vector2d::Zero();
  for (int i = 0; i <= pieces; ++i) {
    for (int side = 0; side < 2; ++side) {
      sheet.pattern.row(2 * i + side) << i * width, 0.05 * side;
      sheet.x.row(2 * i + side) << at.x(), 0.05 * side, at.y();
    }
    at += width * Vector2d(std::cos(i * turn), std::sin(i * turn));
    if (i == pieces) break;
    sheet.triangles.row(2 * i) << 2 * i, 2 * i + 2, 2 * i + 3;
    sheet.triangles.row(2 * i + 1) << 2 * i, 2 * i + 3, 2 * i + 1;
  }
  return sheet;
}

TEST(MeshCoarsenessTest, TheSagittaIsThatOfTheArcThroughTheFoldsOfAPolygon) {
  const double width = 0.01, turn = 0.4, radius = width / turn;
  const Sheet sheet = polygon_of(12, width, turn);
  EXPECT_NEAR(mean_square_fold(sheet), turn * turn, 1e-12) << "flat diagonals store nothing";
  EXPECT_NEAR(rms_sagitta(sheet), width * turn / 8, 1e-12);
  EXPECT_NEAR(rms_sagitta(sheet), radius * (1 - std::cos(turn / 2)), 0.01 * rms_sagitta(sheet));
}

TEST(MeshCoarsenessTest, TheSagittaOfABendFallsWithTheSquareOfTheWidthOfItsPieces) {
  const double coarse = rms_sagitta(polygon_of(8, 0.02, 0.2)),
               fine = rms_sagitta(polygon_of(16, 0.01, 0.1));
  EXPECT_NEAR(coarse / fine, 4, 1e-9);
}

TEST(MeshCoarsenessTest, AFlatSheetIsNotCoarse) {
  EXPECT_EQ(rms_sagitta(polygon_of(3, 0.1, 0)), 0);
  EXPECT_EQ(mean_square_fold(polygon_of(3, 0.1, 0)), 0);
}

}  // namespace
}  // namespace paperbake
