#include "core/geometry/developable_curvature.h"

#include "core/geometry/curvature.h"
#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace paperbake {
namespace {

/// Bends a flat sheet about lines that lean by `angle` from the y axis, to curvature k.
void wind(Sheet& sheet, double k, double angle) {
  const Vector2d across(std::cos(angle), std::sin(angle)), along(-across.y(), across.x());
  for (int v = 0; v < sheet.pattern.rows(); ++v) {
    const Vector2d p = sheet.pattern.row(v);
    const double turn = k * p.dot(across), off = std::sin(turn) / k;
    sheet.x.row(v) << off * across.x() + p.dot(along) * along.x(),
        off * across.y() + p.dot(along) * along.y(), (std::cos(turn) - 1) / k;
  }
}

TEST(DevelopableCurvatureTest, StripsShowRulingsThatAreNotTheirEdges) {
  // a band of one row of cells: all vertices lie on its borders, all edges across stand upright,
  // the true rulings lean
  constexpr double k = 20, angle = 0.35, length = 0.3;
  Sheet band = test::strip_sheet(length, 0.03, 30);
  wind(band, k, angle);
  const Points3 S = developable_curvature(band);
  for (int v = 0; v < S.rows(); ++v) {
    if (band.pattern(v, 0) < 0.2 * length || band.pattern(v, 0) > 0.8 * length) continue;
    const Principal p = principal_curvature(S.row(v).transpose());
    EXPECT_NEAR(p.k1, k, 0.1 * k) << v;  // chords of 30 mm along the edges
    EXPECT_NEAR(std::atan(p.across.y() / p.across.x()), angle, 0.1) << v;
  }
}

TEST(DevelopableCurvatureTest, ACylinderIsOneAllOverUpToItsBorders) {
  constexpr double k = 10;
  for (const double angle : {0.0, 0.3, 1.1}) {
    Sheet sheet = test::hex_sheet(0.1, 0.1, 14);
    wind(sheet, k, angle);
    const Points3 S = developable_curvature(sheet);
    const Vector2d n(std::cos(angle), std::sin(angle));
    const Eigen::RowVector3d expected(k * n.x() * n.x(), k * n.x() * n.y(), k * n.y() * n.y());
    double off = 0;
    for (int v = 0; v < S.rows(); ++v) off += (S.row(v) - expected).norm() / S.rows();
    EXPECT_LT(off, 0.1 * k) << angle;
  }
}

}  // namespace
}  // namespace paperbake
