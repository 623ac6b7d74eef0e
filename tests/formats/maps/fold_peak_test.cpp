#include "formats/maps/fold_peak.h"

#include "tests/formats/maps/crease_map_fixture.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

TEST(FoldPeak, KeepsTheLargestAngleWithItsSignAndNeverLess) {
  const Sheet sheet = test::flat_sheet(0.1, 0.1, 0.01);
  FoldPeak peak({test::rectangle(0.1, 0.1).outline}, {0.1, test::fold_width}, 2048);
  std::vector<float> last(2048, 0.0f);
  for (const double k : {20.0, -90.0, 50.0, 0.0, 100.0}) {
    peak.record(map_fields(sheet, test::tensors(sheet, [k](Vector2d p) { return k * (1 + p.x()); }),
                           {}, 0.002));
    const std::vector<float> row = peak.peaks({2048, 700, 701});
    for (int i = 0; i < 2048; ++i) ASSERT_GE(std::abs(row[i]), std::abs(last[i]) - 1e-7f) << i;
    last = row;
    if (k == 50) {
      // linear: interpolated exactly
      EXPECT_NEAR(row[1000], -90 * (1 + 0.1 * 1000.5 / 2048) * 0.002, 1e-6);
    }
  }
  EXPECT_NEAR(last[1000], 100 * (1 + 0.1 * 1000.5 / 2048) * 0.002, 1e-6);
}

}  // namespace
}  // namespace paperbake
