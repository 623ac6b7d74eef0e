#include "core/animation/sheet_islands.h"

#include "core/methods/fem.h"
#include "tests/core/animation/together_shots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace paperbake {
namespace {

using Island = SheetIslands::Island;
using Islands = std::vector<Island>;

const Vector3d along_x(1, 0, 0), along_y(0, 1, 0);

/// Sheets of 0.1 m that lie over each other at these heights [m], held at two corners.
struct Pile {
  std::vector<Shot> shots;
  MethodChoice method = fem(40);
  AnimateOptions options;
  SheetIslands::Sheets sheets;
  std::optional<SheetIslands> islands;

  /// falls  [m] by how much each goes down in the second frame
  /// aside  [m] by how much each is beside the one before it, along x
  explicit Pile(const std::vector<double>& heights, const std::vector<double>& falls = {},
                double aside = 0) {
    for (std::size_t s = 0; s < heights.size(); ++s) {
      const Vector3d corner(s * aside, 0, heights[s]);
      shots.push_back(test::placed(0.1, 0.1, corner, along_x, along_y));
      for (const Vector2d& p :
           {Vector2d(0, 0), Vector2d(0.1, 0), Vector2d(0.1, 0.1), Vector2d(0, 0.1)})
        test::hold(
            shots.back(), p, 5,
            [&](int f) { return Vector3d(0, 0, falls.empty() || f == 0 ? 0 : -falls[s]); }, corner,
            along_x, along_y);
    }
    options.last_frame = 5;
    options.elastic.forces.gravity = 0;
    for (std::size_t s = 0; s < shots.size(); ++s)
      sheets.push_back(std::make_unique<SheetSimulation>(shots[s], method, options,
                                                         SheetSimulation::Place{s, {}}));
    islands.emplace(sheets, SheetIslands::Start::fresh);
  }
  double dhat() const { return sheets.front()->elastic().dhat(); }
  /// Begins a frame.
  void prepare() {
    for (const auto& sheet : sheets) sheet->prepare(whatever);
  }
  /// Takes the step of each sheet alone.
  void step_alone() {
    for (const auto& sheet : sheets) sheet->step(SheetSimulation::RecordTrajectory::yes, whatever);
  }
  /// The first frame, in which the sheets are as they were modelled.
  void take_first_frame() {
    prepare();
    step_alone();
    for (const auto& sheet : sheets) sheet->finish_step(whatever);
  }
  static bool whatever(const Sheet&, const Sheet&, double) { return true; }
};

TEST(SheetIslandsTest, SheetsBeginWithTheDistanceBetweenThemAsTheirContactDistance) {
  const double full = Pile({0}).dhat();
  ASSERT_GT(full, 1e-4);
  const auto dhat = [](double apart) { return Pile({0, apart}).sheets[1]->dhat[0]; };
  EXPECT_NEAR(dhat(2 * full), full, 1e-12) << "the smaller of their own two";
  EXPECT_NEAR(dhat(0.5 * full), 0.9 * 0.5 * full, 1e-12);
  EXPECT_NEAR(dhat(0.03 * full), 0.9 * 0.03 * full, 1e-12);
  EXPECT_EQ(dhat(0.01 * full), 0) << "as good as one sheet";
}

TEST(SheetIslandsTest, SheetsThatTouchInPartAsTheyBeginKeepATenth) {
  // the second one covers less than half of the first
  const Pile in_part({0, 0}, {}, 0.07), as_one({0, 0}, {}, 0.0);
  EXPECT_NEAR(in_part.sheets[1]->dhat[0], 0.1 * in_part.dhat(), 1e-12);
  EXPECT_EQ(as_one.sheets[1]->dhat[0], 0);
}

TEST(SheetIslandsTest, SheetsCloserThanTheirContactDistanceAreInOneIslandAlsoByOthers) {
  Pile pile({0, 3e-3, 1e-3, 2e-3, 9e-3, 9.9e-3}, {1e-5, 1e-5, 1e-5, 1e-5, 1e-5, 1e-5});
  pile.take_first_frame();
  pile.prepare();
  const auto islands_with = [&](double dhat) {
    for (std::size_t b = 0; b < pile.sheets.size(); ++b)
      for (std::size_t a = 0; a < b; ++a) pile.sheets[b]->dhat[a] = dhat;
    return pile.islands->build_islands();
  };
  EXPECT_EQ(islands_with(0.8e-3), (Islands{{0}, {1}, {2}, {3}, {4}, {5}}));
  EXPECT_EQ(islands_with(0.95e-3), (Islands{{0}, {1}, {2}, {3}, {4, 5}}));
  EXPECT_EQ(islands_with(1.05e-3), (Islands{{0, 1, 2, 3}, {4, 5}}));
  EXPECT_EQ(islands_with(0), (Islands{{0}, {1}, {2}, {3}, {4}, {5}}));
}

TEST(SheetIslandsTest, SheetsThatSkipTheStepAreAlone) {
  Pile pile({0, 1e-3});
  pile.sheets[1]->dhat[0] = 2e-3;
  pile.prepare();
  ASSERT_TRUE(pile.sheets[0]->is_idle() && pile.sheets[1]->is_idle());
  EXPECT_EQ(pile.islands->build_islands(), (Islands{{0}, {1}}));
}

TEST(SheetIslandsTest, SheetsThatWouldHavePassedThroughEachOtherAreMerged) {
  // the second one falls through the first; the third as far, and ends above it; the last stays
  Pile pile({0, 5e-3, 0.03, -0.05}, {0, 0.01, 0.01, 0});
  pile.take_first_frame();
  pile.prepare();
  ASSERT_EQ(pile.islands->build_islands(), (Islands{{0}, {1}, {2}, {3}}));
  pile.step_alone();
  ASSERT_NEAR(pile.sheets[1]->sheet().x.col(2).maxCoeff(), -5e-3, 1e-4);
  EXPECT_EQ(pile.islands->merge_colliding({{0}, {1}, {2}, {3}}), (Islands{{0, 1}, {2}, {3}}));
  EXPECT_EQ(pile.islands->merge_colliding({{0, 2}, {1, 3}}), (Islands{{0, 1, 2, 3}}));
  EXPECT_EQ(pile.islands->merge_colliding({{0, 1}, {2}, {3}}), (Islands{{0, 1}, {2}, {3}}));
  pile.sheets[1]->dhat[0] = 0;
  EXPECT_EQ(pile.islands->merge_colliding({{0}, {1}, {2}, {3}}), (Islands{{0}, {1}, {2}, {3}}))
      << "they ignore each other";
}

TEST(SheetIslandsTest, ASheetMayGoNoNearerToAnotherThanHalfWay) {
  Pile pile({0, 0.8e-3, 0.1});
  pile.sheets[1]->dhat[0] = 1e-3;
  const Sheet here = pile.sheets[1]->sheet();
  const auto may_go = [&](double by, double moved) {
    Sheet there = here;
    there.x.col(2).array() += by;
    return pile.islands->is_admissible(1, here, there, moved);
  };
  EXPECT_TRUE(may_go(0, 0));
  EXPECT_TRUE(may_go(-0.35e-3, 0.35e-3));
  EXPECT_FALSE(may_go(-0.45e-3, 0.45e-3));
  EXPECT_TRUE(may_go(0.02, 0.7e-3)) << "away from it";
  EXPECT_FALSE(may_go(0, 0.9e-3)) << "a vertex may have been on its other side meanwhile";
  EXPECT_FALSE(may_go(-1.6e-3, 1.6e-3)) << "beyond it";
  pile.sheets[1]->dhat[0] = 0;
  EXPECT_TRUE(may_go(-0.9e-3, 0.9e-3)) << "they ignore each other";
}

TEST(SheetIslandsTest, SheetsThatHaveMovedApartGetTheirContactDistanceBack) {
  const double full = Pile({0}).dhat(), apart = 0.5 * full, farther = 0.3 * full;
  for (const double fall : {farther, 10 * full, -0.3 * full}) {
    Pile pile({0, apart}, {fall, 0});
    const double before = pile.sheets[1]->dhat[0];
    ASSERT_NEAR(before, 0.9 * apart, 1e-12);
    pile.take_first_frame();
    pile.prepare();
    pile.step_alone();
    pile.islands->restore_contact_distances();
    const double now = std::clamp(0.9 * (apart + fall), before, full);
    EXPECT_NEAR(pile.sheets[1]->dhat[0], now, 1e-3 * full) << fall;
  }
}

}  // namespace
}  // namespace paperbake
