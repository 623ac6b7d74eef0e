#include "formats/cache/usd_cache.h"

#include "formats/files/atomic_file.h"
#include "tests/own_folder.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace paperbake {
namespace {

namespace fs = std::filesystem;

/// A strip of `cells` squares, waving.
CacheFrame strip(int cells, int frame) {
  CacheFrame f;
  f.x.resize(2 * cells + 2, 3);
  f.triangles.resize(2 * cells, 3);
  for (int i = 0; i <= cells; ++i)
    for (const int side : {0, 1}) {
      f.x.row(2 * i + side) << 0.01 * i, 0.01 * side, 0.002 * std::sin(0.3 * i + 0.2 * frame);
    }
  for (int i = 0; i < cells; ++i) {
    f.triangles.row(2 * i) << 2 * i, 2 * i + 2, 2 * i + 1;
    f.triangles.row(2 * i + 1) << 2 * i + 1, 2 * i + 2, 2 * i + 3;
  }
  f.velocity = Points3::Constant(f.x.rows(), 3, 0.25 * frame);
  f.layers = {{"foldPeak", Eigen::VectorXd::Constant(f.x.rows(), 0.5)}};
  return f;
}

std::string layer(const fs::path& path, UsdEncoding encoding, int frames) {
  fs::remove(path);
  UsdWriter writer(path, encoding, {}, {"paper.A", "paper B"});
  for (int k = 0; k < frames; ++k)
    for (const std::size_t sheet : {0, 1}) writer.add_frame(sheet, strip(200, k));
  EXPECT_FALSE(fs::exists(path)) << "before it is whole";
  writer.finish();
  return read_file(path).value_or("");
}

TEST(UsdCache, TheSameCallsWriteTheSameBytes) {
  for (const auto encoding : {UsdEncoding::text, UsdEncoding::crate}) {
    const std::string first = layer(test::own_folder() / "first", encoding, 3);
    ASSERT_GT(first.size(), 1000u);
    EXPECT_EQ(first, layer(test::own_folder() / "second", encoding, 3));
  }
}

TEST(UsdCache, ABinaryLayerStoresEqualValuesOnce) {
  const fs::path path = test::own_folder() / "once.usdc";
  const std::size_t two = layer(path, UsdEncoding::crate, 2).size(),
                    ten = layer(path, UsdEncoding::crate, 10).size();
  // both sheets wave alike: a frame adds positions, velocities and a box, and what refers to them
  EXPECT_LT(ten - two, 8 * (2 * 402 * 12 + 1000));
  EXPECT_GT(ten - two, 8 * 2 * 402 * 12);
}

TEST(UsdCache, WithoutAnEndThereIsNoFile) {
  for (const auto encoding : {UsdEncoding::text, UsdEncoding::crate}) {
    const fs::path folder = test::own_folder() / "unfinished";
    fs::create_directory(folder);
    {
      UsdWriter writer(folder / "shot", encoding, {}, {"paper"});
      writer.add_frame(0, strip(10, 0));
      EXPECT_TRUE(fs::exists(folder / "shot.part"));
    }
    EXPECT_TRUE(fs::is_empty(folder));
  }
}

}  // namespace
}  // namespace paperbake
