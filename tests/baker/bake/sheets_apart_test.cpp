// What should not matter does not: a sheet behaves as it does alone, whatever other sheets do
// elsewhere in its scene.

#include "baker/job/plan.h"
#include "core/animation/animate.h"
#include "core/geometry/intersections.h"

#include <gtest/gtest.h>

#include <memory>
#include <ostream>
#include <string>
#include <vector>

namespace paperbake {
namespace {

struct Case {
  const char* name;
  int last;
};
void PrintTo(const Case& c, std::ostream* to) { *to << c.name; }

BakePlan plan_of(const Case& c) {
  BakeSettings settings;
  settings.scene = std::string(PAPERBAKE_SAMPLES "/") + c.name + ".glb";
  settings.frames = FrameSpan{1, c.last, 1};
  return plan_bake(settings);
}

/// The same shot elsewhere.
Shot moved(Shot shot, const Eigen::RowVector3d& by) {
  shot.start.x.rowwise() += by;
  for (Handle& handle : shot.handles) handle.keyed.rowwise() += by;
  if (!shot.colliders) return shot;
  Colliders colliders;
  for (const Collider& collider : *shot.colliders) {
    ColliderMesh mesh = collider.mesh();
    mesh.x.rowwise() += by;
    for (Points3& x : mesh.frames.own()) x.rowwise() += by;
    colliders.emplace_back(std::move(mesh));
  }
  shot.colliders = std::make_shared<const Colliders>(std::move(colliders));
  return shot;
}

/// A plan of two sheets: that of another plan, and the same elsewhere.
BakePlan doubled(BakePlan plan, const Eigen::RowVector3d& by) {
  plan.shots.push_back(moved(plan.shots.front(), by));
  plan.sheets.push_back(plan.sheets.front());
  ++plan.sheets.back().seed;
  return plan;
}

std::vector<Sheet> frames_of_first_sheet(const BakePlan& plan) {
  std::vector<Sheet> seen;
  simulate(plan, options_of_sheets(plan), 1, [&](const AnimatedFrame& frame) {
    if (frame.sheet_index == 0) seen.push_back(*frame.sheet);
    return true;
  });
  return seen;
}

class SheetsApartTest : public testing::TestWithParam<Case> {};

// a crumple; a fold that is found between colliders; a page that a table holds while it is folded;
// a sheet that a container squeezes
INSTANTIATE_TEST_SUITE_P(Samples, SheetsApartTest,
                         testing::Values(Case{"S14_hands", 60}, Case{"S4_crumple", 70},
                                         Case{"F6_pinch", 66}, Case{"S12_sphere", 30},
                                         Case{"S5_roll", 40}),
                         [](const auto& info) { return std::string(info.param.name); });

TEST_P(SheetsApartTest, EachIsSimulatedAsIfItWereAlone) {
  const BakePlan one = plan_of(GetParam());
  const std::vector<Sheet> alone = frames_of_first_sheet(one),
                           both = frames_of_first_sheet(doubled(one, {5, 0, 0}));
  ASSERT_EQ(both.size(), alone.size());
  for (std::size_t f = 0; f < alone.size(); ++f) {
    ASSERT_EQ(both[f].x.rows(), alone[f].x.rows()) << "frame " << f + 1;
    ASSERT_EQ(both[f].x, alone[f].x) << "frame " << f + 1;
  }
}

/// Each takes its fast frames in parts, alone until they would have collided, and then together.
TEST(SheetsApart, SheetsThatMeetInAFrameThatIsTakenInPartsDoNotPassThroughEachOther) {
  std::vector<Sheet> of_frame;
  int touching = 0, frames_in_parts = 0;
  const BakePlan near = doubled(plan_of({"S0_note", 44}), {0, 0, 0.03});
  simulate(near, options_of_sheets(near), 1, [&](const AnimatedFrame& frame) {
    touching += frame.statistics.touching_others > 0;
    frames_in_parts += frame.statistics.substeps > 1;
    of_frame.push_back(*frame.sheet);
    if (of_frame.size() < 2) return true;
    EXPECT_EQ(crossings_between(of_frame[0], of_frame[1]), 0) << "frame " << frame.frame;
    of_frame.clear();
    return true;
  });
  EXPECT_GT(touching, 4);
  EXPECT_GT(frames_in_parts, 4);
}

}  // namespace
}  // namespace paperbake
