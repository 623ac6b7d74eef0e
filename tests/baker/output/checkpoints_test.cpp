#include "baker/output/checkpoints.h"

#include "baker/job/input_hash.h"
#include "formats/files/frame_statistics_table.h"
#include "tests/core/test_meshes.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <type_traits>
#include <unistd.h>
#include <vector>

namespace paperbake {
namespace {

namespace fs = std::filesystem;

class CheckpointsTest : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(testing::TempDir()) / ("paperbake_checkpoints_" + std::to_string(getpid()));
    fs::create_directories(folder);
    plan.shots = {test::blank_shot(test::rectangle(0.1, 0.1))};
    plan.simulation_hash = "of this simulation";
    plan.animation.last_frame = 2;
    hash_frames(plan);
  }
  void TearDown() override { fs::remove_all(folder); }

  /// Keeps a checkpoint of frames 1 and 2.
  void keep(const FrameStatistics& first, const FrameStatistics& second, int keys_until = 0) const {
    Checkpoints checkpoints(folder, plan, 2);
    const Sheet sheet = test::hex_sheet(0.1, 0.1, 4, 0.2, 1);
    for (const int number : {1, 2}) {
      AnimatedFrame frame;
      frame.frame = number;
      frame.sheet = &sheet;
      frame.statistics = number == 1 ? first : second;
      frame.handles.resize(plan.shots[0].handles.size());
      frame.keys_until = keys_until;
      frame.state = [] { return std::string("state"); };
      checkpoints.add(frame);
    }
    EXPECT_EQ(checkpoints.failure(), "");
  }
  std::vector<FrameStatistics> load() const {
    std::vector<FrameStatistics> loaded;
    Checkpoints checkpoints(folder, plan, 2);
    const Checkpoints::ResumePoint point = checkpoints.load([&](const AnimatedFrame& frame) {
      loaded.push_back(frame.statistics);
      return true;
    });
    EXPECT_EQ(point.damaged, "");
    return loaded;
  }

  fs::path folder;
  BakePlan plan;
};

TEST_F(CheckpointsTest, EveryNumberOfASimulatedFrameIsLoadedAsItWas) {
  FrameStatistics statistics;
  int next = 3;
  visit_frame_statistics([&](const auto& field) {
    using Value = typename std::decay_t<decltype(field)>::Value;
    Value* value = find_statistic(statistics, field);
    if (!value) return;  // of the render mesh: nothing is rendered yet
    if constexpr (std::is_same_v<Value, bool>)
      *value = !*value;
    else
      *value = static_cast<Value>(std::is_enum_v<Value> ? 2 : ++next + 0.3);
  });
  ASSERT_GT(next, 20);
  keep(statistics, {});
  const std::vector<FrameStatistics> loaded = load();
  ASSERT_EQ(loaded.size(), 2u);
  visit_frame_statistics([&](const auto& field) {
    const auto* value = find_statistic(loaded[0], field);
    ASSERT_EQ(value != nullptr, find_statistic(statistics, field) != nullptr);
    if (!value) return;
    EXPECT_EQ(*value, *find_statistic(statistics, field)) << (field.name ? field.name : "unnamed");
    EXPECT_NE(*value, *find_statistic(loaded[1], field)) << (field.name ? field.name : "unnamed");
  });
}

TEST_F(CheckpointsTest, FramesThatHaveLookedAheadAreUsedWhileTheKeysThatTheySawAreAsTheyWere) {
  plan.shots[0].handles.resize(1);
  Points3& keyed = plan.shots[0].handles[0].keyed;
  keyed.setZero(8, 3);
  hash_frames(plan);
  for (const int keys_until : {2, 5}) {
    keep({}, {}, keys_until);
    ASSERT_EQ(load().size(), 2u);
    for (const int moved : {2, 3, 5, 6}) {
      keyed(moved - 1, 2) = 0.01;
      hash_frames(plan);
      EXPECT_EQ(load().size(), moved > keys_until ? 2u : 0u)
          << "seen until " << keys_until << ", the key of frame " << moved;
      keyed(moved - 1, 2) = 0;
      hash_frames(plan);
    }
  }
}

TEST_F(CheckpointsTest, CheckpointsOfAnotherSimulationAreNotUsed) {
  keep({}, {});
  ASSERT_EQ(load().size(), 2u);
  plan.simulation_hash = "of another";
  EXPECT_TRUE(load().empty());
}

}  // namespace
}  // namespace paperbake
