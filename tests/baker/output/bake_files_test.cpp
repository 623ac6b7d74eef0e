#include "baker/output/bake_files.h"

#include "core/model/error.h"

#include <gtest/gtest.h>

#include <vector>

namespace paperbake {
namespace {

using Paths = std::vector<std::filesystem::path>;
using Counts = std::vector<std::size_t>;

int number(std::size_t n) { return 10 + 2 * static_cast<int>(n); }

TEST(BakeFilesTest, AFileThatFailedIsNotListedAndNotTriedAgain) {
  BakeFiles files("out");
  EXPECT_TRUE(files.write("a", [](const auto& path) { EXPECT_EQ(path, "out/a"); }));
  EXPECT_FALSE(files.write("b", [](const auto&) { throw Error(ErrorCode::folder, "b", "full"); }));
  EXPECT_FALSE(files.write("b", [](const auto&) { FAIL() << "it has failed"; }));
  EXPECT_EQ(files.written(), Paths{"out/a"});
  ASSERT_EQ(files.failures.all().size(), 1u);
}

TEST(BakeFilesTest, ACacheThatLacksFramesIsListedWithTheLastOneItHas) {
  BakeFiles files("out");
  EXPECT_EQ(files.finish_cache(
                "whole", {3, 3},
                [] {
                  return Counts{3, 3};
                },
                number),
            (Counts{3, 3}));
  EXPECT_TRUE(files.failures.all().empty());
  files.finish_cache(
      "short", {3, 3},
      [] {
        return Counts{2, 1};
      },
      number);
  files.finish_cache(
      "empty", {3}, [] { return Counts{0}; }, number);
  EXPECT_EQ(files.written(), (Paths{"out/whole", "out/short"}));
  EXPECT_EQ(files.failures.summary(), "short ends at frame 12; empty has no frame");
}

TEST(BakeFilesTest, ACacheThatCannotBeFinishedHasNoFrames) {
  BakeFiles files("out");
  const auto fail = []() -> Counts { throw Error(ErrorCode::folder, "c", "full"); };
  EXPECT_EQ(files.finish_cache("c", {3, 3}, fail, number), (Counts{0, 0}));
  EXPECT_TRUE(files.written().empty());
  EXPECT_EQ(files.failures.summary(), "there is no c");
}

TEST(BakeFilesTest, CachesAreListedBeforeTheMapsThatWereWrittenEarlier) {
  BakeFiles files("out");
  for (const char* map : {"map1", "map2"}) files.add(map);
  for (const char* cache : {"abc", "usd"}) files.add(cache);
  files.move_to_front_after(2);
  EXPECT_EQ(files.written(), (Paths{"out/abc", "out/usd", "out/map1", "out/map2"}));
}

}  // namespace
}  // namespace paperbake
