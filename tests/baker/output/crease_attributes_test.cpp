// What USD layers say of the damage, at the vertices of a mesh that is not the simulated one.

#include "baker/output/crease_attributes.h"

#include "core/geometry/curvature.h"
#include "tests/core/test_meshes.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

const Eigen::VectorXd& layer(const std::vector<CacheLayer>& layers, const std::string& name) {
  return std::find_if(layers.begin(), layers.end(),
                      [&](const CacheLayer& l) { return l.name == name; })
      ->values;
}

TEST(CreaseAttributesTest, LayersHoldFoldsNowTheirPeakAndTheNearestSingularPoints) {
  const Shot shot = test::blank_shot(test::rectangle(0.1, 0.1));
  CreaseAttributes damage(shot, 0.004, 24);
  ShotRecord record;
  const double curvatures[] = {30, -50, 10};
  std::vector<SingularPoint> singular;
  for (int f = 1; f <= 3; ++f) {
    Sheet sheet = test::hex_sheet(0.1, 0.1, f == 2 ? 40 : 30);  // the mesh changes
    test::roll(sheet, 1 / std::abs(curvatures[f - 1]));
    if (curvatures[f - 1] < 0) sheet.x.col(2) *= -1;
    if (f == 2) singular.push_back({Vector2d(0.03, 0.03), 2, "a"});
    if (f == 3) singular.push_back({Vector2d(0.08, 0.05), 3, "b"});
    sheet.singular = singular;
    AnimatedFrame frame;
    frame.frame = f;
    frame.sheet = &sheet;
    frame.plastic_curvature = Points3::Zero(sheet.pattern.rows(), 3);
    frame.plastic_curvature.col(0).setConstant(7);
    record.add(frame);
    damage.add(frame);
  }
  Points2 pattern(3, 2);
  pattern << 0.05, 0.05, 0.03, 0.04, 0.07, 0.06;
  const auto first = damage.at(0, record, pattern), last = damage.at(2, record, pattern);
  for (int v = 0; v < 3; ++v) {
    EXPECT_NEAR(layer(first, "foldAngle")[v], 30 * 0.004, 0.03 * 30 * 0.004);
    EXPECT_EQ(layer(first, "foldPeak")[v], layer(first, "foldAngle")[v]);
    EXPECT_NEAR(layer(last, "foldAngle")[v], 10 * 0.004, 0.03 * 10 * 0.004);
    // of frame 2, which was not asked for
    EXPECT_NEAR(layer(last, "foldPeak")[v], -50 * 0.004, 0.03 * 50 * 0.004);
    EXPECT_NEAR(layer(last, "foldPlastic")[v], 7 * 0.004, 1e-4);
    EXPECT_EQ(layer(first, "apexAge")[v], -1);
    EXPECT_NEAR(layer(first, "apexDistance")[v], 0.1 * std::sqrt(2.0), 1e-5);
  }
  EXPECT_NEAR(layer(last, "apexDistance")[1], 0.01, 1e-5);
  EXPECT_NEAR(layer(last, "apexAge")[1], 1 / 24.0, 1e-4);
  EXPECT_NEAR(layer(last, "apexDistance")[2], std::hypot(0.01, 0.01), 1e-5);
  EXPECT_EQ(layer(last, "apexAge")[2], 0);
}

}  // namespace
}  // namespace paperbake
