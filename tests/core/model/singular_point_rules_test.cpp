// What an artist prescribes before a crumple begins: where singular points are fixed or forbidden.

#include "core/animation/animate.h"
#include "core/methods/hybrid.h"
#include "formats/scene/scene_file.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

Shot dcone() {
  const SceneSheet s = read_scene(PAPERBAKE_SAMPLES "/S8_dcone.glb").sheets.front();
  return {s.name, s.pattern, s.start, s.handles, Paper{}};
}

std::vector<SingularPoint> born(const Shot& shot, int last_frame) {
  CrumpleOptions crumple;
  crumple.singular_point_rules = shot.singular_point_rules;
  AnimateOptions options;
  options.last_frame = last_frame;
  options.plasticity = Plasticity::on;
  std::vector<SingularPoint> found;
  animate(shot, hybrid(shot.pattern, shot.paper, 120, crumple, 0, 0), options,
          [&](const AnimatedFrame& f) {
            found = f.sheet->singular;
            return true;
          });
  return found;
}

TEST(SingularPointRulesTest, AFixedSingularPointExistsFromTheFirstFrame) {
  Shot shot = dcone();
  shot.singular_point_rules.fixed = {{0.065, 0.03}};
  const auto found = born(shot, 4);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_LT((found[0].pattern - shot.singular_point_rules.fixed[0]).norm(), 1e-9);
  EXPECT_EQ(found[0].frame_of_birth, 1);
}

TEST(SingularPointRulesTest, NoSingularPointIsBornWhereItIsForbidden) {
  Shot shot = dcone();
  const auto without_rules = born(shot, 56);
  ASSERT_FALSE(without_rules.empty());
  const Disc disc{without_rules.front().pattern, 0.02};
  shot.singular_point_rules.forbidden = {disc};
  const auto others = born(shot, 56);
  ASSERT_FALSE(others.empty()) << "the next best place is taken";
  for (const SingularPoint& s : others) EXPECT_GT((s.pattern - disc.centre).norm(), disc.radius);
}

}  // namespace
}  // namespace paperbake
