#include "formats/maps/map_fields.h"

#include "tests/formats/maps/crease_map_fixture.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

TEST(MapFields, TheBorderIsTheOutlineOfTheMesh) {
  const Sheet sheet = test::flat_sheet(0.1, 0.05, 0.01);
  const MapFields fields = map_fields(sheet, Points3::Zero(sheet.pattern.rows(), 3), {}, 0.002);
  double length = 0;
  for (const auto& [a, b] : fields.border)
    length += (sheet.pattern.row(a) - sheet.pattern.row(b)).norm();
  EXPECT_NEAR(length, 0.3, 1e-12);
}

TEST(MapFields, EveryWantedTexelIsVisitedOnceInsideLinearOutsideAsOnTheBorder) {
  const Sheet sheet = test::flat_sheet(0.1, 0.05, 0.01);
  const MapFields fields = map_fields(
      sheet, test::tensors(sheet, [](Vector2d p) { return 7 + 100 * p.x() + 300 * p.y(); }), {},
      0.002);
  std::vector<Vector2d> loop = test::rectangle(0.1, 0.05).outline;
  for (Vector2d& p : loop) p = to_texels(p, 0.1, 64);
  const MapRows rows{64, 16, 64};
  const std::vector<char> wanted = wanted_texels({loop}, area_coverage({loop}, rows), rows);
  std::vector<int> visits(rows.count(), 0);
  for_each_texel_row<0, 12>(fields, 0.1, {loop}, rows, wanted, [&](const TexelRow<12>& drawn) {
    for (int i = 0; i < drawn.texels; ++i) {
      if (!drawn.wanted[i]) continue;
      const int index = drawn.index + i;
      ++visits[index];
      const double x = 0.1 * (index % 64 + 0.5) / 64, y = 0.1 * (1 - (index / 64 + 16 + 0.5) / 64);
      EXPECT_NEAR(drawn.fields[0][i], 7 + 100 * x + 300 * std::min(y, 0.05),
                  1e-5);  // the place on the border is a 32-bit float
      EXPECT_NEAR(drawn.fields[of_fold][i], 0.002 * drawn.fields[0][i],
                  1e-7 * drawn.fields[of_fold][i]);
      EXPECT_NEAR(drawn.fields[of_strain][i], 0, 1e-12);
    }
  });
  for (int row = 16; row < 64; ++row)
    for (int i = 0; i < 64; ++i)
      ASSERT_EQ(visits[rows.index(i, row)], row >= 32 - map_padding) << i << ", " << row;
}

TEST(MapFields, SomeOfTheFieldsAreThoseOfAll) {
  const Sheet sheet = test::flat_sheet(0.1, 0.05, 0.01);
  const MapFields fields = map_fields(
      sheet, test::tensors(sheet, [](Vector2d p) { return 7 + 100 * p.x() + 300 * p.y(); }), {},
      0.002);
  std::vector<Vector2d> loop = test::rectangle(0.1, 0.05).outline;
  for (Vector2d& p : loop) p = to_texels(p, 0.1, 150);  // rows that are drawn in parts
  const MapRows rows{150, 60, 150};
  const std::vector<char> wanted = wanted_texels({loop}, area_coverage({loop}, rows), rows);
  std::vector<double> all(rows.count(), 0), alone = all;
  const auto keep = [](std::vector<double>& target, int field) {
    return [&target, field](const auto& row) {
      for (int i = 0; i < row.texels; ++i)
        if (row.wanted[i]) target[row.index + i] = row.fields[field][i];
    };
  };
  for_each_texel_row<0, 12>(fields, 0.1, {loop}, rows, wanted, keep(all, of_fold));
  for_each_texel_row<of_fold, 3>(fields, 0.1, {loop}, rows, wanted, keep(alone, 0));
  EXPECT_GT(*std::max_element(all.begin(), all.end()), 0.05);
  EXPECT_EQ(all, alone);
}

}  // namespace
}  // namespace paperbake
