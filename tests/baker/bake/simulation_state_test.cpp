// A sample goes on from the state of any frame as if it had never stopped: with colliders that
// move, several sheets, inertia, friction, and folds that are sought in the steps before.

#include "baker/job/plan.h"
#include "core/animation/animate.h"

#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

namespace paperbake {
namespace {

struct Case {
  const char* name;
  int last;
  std::vector<int> resumed_after;
  double gravity = 0;  // [m/s2] 0: that of the scene
};
void PrintTo(const Case& c, std::ostream* to) { *to << c.name; }

/// What is handed on of all sheets of a frame, and what the next frame comes from.
struct Seen {
  std::vector<Sheet> sheets;
  std::vector<std::string> states;
};

class SimulationStateTest : public testing::TestWithParam<Case> {
 protected:
  BakePlan plan() const {
    BakeSettings settings;
    settings.scene = std::string(PAPERBAKE_SAMPLES "/") + GetParam().name + ".glb";
    settings.frames = FrameSpan{1, GetParam().last, 1};
    if (GetParam().gravity > 0) settings.gravity = GetParam().gravity;
    return plan_bake(settings);
  }

  /// At most so many frames of a plan, after those that led to the states.
  static std::vector<Seen> frames(const BakePlan& plan, const std::vector<std::string>& states,
                                  std::size_t most) {
    std::vector<AnimateOptions> options = options_of_sheets(plan);
    for (std::size_t s = 0; s < states.size(); ++s) options[s].resume_state = states[s];
    std::vector<Seen> seen;
    std::vector<Sheet> sheets;
    std::vector<std::function<std::string()>> after;
    simulate(plan, options, 1, [&](const AnimatedFrame& frame) {
      sheets.push_back(*frame.sheet);
      after.push_back(frame.state);
      if (sheets.size() < plan.shots.size()) return true;
      seen.push_back({std::move(sheets), {}});
      for (const auto& state : after) seen.back().states.push_back(state());
      sheets.clear();
      after.clear();
      return seen.size() < most;
    });
    return seen;
  }
};

INSTANTIATE_TEST_SUITE_P(
    Samples, SimulationStateTest,
    testing::Values(Case{"F2_half", 90, {30, 47, 60, 75}}, Case{"F6_pinch", 66, {47, 61, 58}},
                    Case{"F7_corners", 68, {60, 64}}, Case{"G2_poster", 40, {12, 30}},
                    Case{"G4_grades", 24, {2, 12, 19}}, Case{"G6_book", 24, {8, 17}},
                    Case{"S5_roll", 60, {15, 40, 52}, 9.81}, Case{"S11_palm", 36, {12, 28}},
                    Case{"S12_sphere", 30, {8, 20}}),
    [](const auto& info) { return std::string(info.param.name); });

TEST_P(SimulationStateTest, GoesOnAsIfItHadNeverStopped) {
  const BakePlan whole_plan = plan();
  const std::vector<Seen> whole = frames(whole_plan, {}, 1000);
  ASSERT_EQ(whole.size(), static_cast<std::size_t>(GetParam().last));
  for (const int from : GetParam().resumed_after) {
    // to the end once, otherwise a few frames
    const std::size_t most = from == GetParam().resumed_after.back() ? 1000 : 4;
    const std::vector<Seen> rest = frames(whole_plan, whole[from - 1].states, most);
    ASSERT_EQ(rest.size(), std::min(most, whole.size() - from));
    for (std::size_t k = 0; k < rest.size(); ++k)
      for (std::size_t s = 0; s < rest[k].sheets.size(); ++s) {
        const Sheet &got = rest[k].sheets[s], &wanted = whole[from + k].sheets[s];
        ASSERT_EQ(got.x.rows(), wanted.x.rows());
        ASSERT_EQ(got.x, wanted.x)
            << "sheet " << s << ", after " << from << ", " << k + 1 << " frames later";
        EXPECT_TRUE(rest[k].states[s] == whole[from + k].states[s])
            << "state of sheet " << s << ", after " << from << ", " << k + 1 << " frames later";
      }
  }
}

}  // namespace
}  // namespace paperbake
