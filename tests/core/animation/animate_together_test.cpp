// Whole shots of several sheets.

#include "core/geometry/intersections.h"
#include "core/methods/fem.h"
#include "core/methods/hybrid.h"
#include "core/model/error.h"
#include "tests/core/animation/together_shots.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

using test::Outcome;
using test::small_hybrid;

MethodChoice coarse_fem(const Shot&, std::size_t) { return fem(150); }

AnimateOptions until(int last_frame, double gravity = 0) {
  AnimateOptions options;
  options.last_frame = last_frame;
  options.elastic.forces.gravity = gravity;
  return options;
}

/// Largest distance of a vertex between two shapes on one mesh. [m]
double off(const Sheet& a, const Sheet& b) { return (a.x - b.x).rowwise().norm().maxCoeff(); }

TEST(AnimateTogetherTest, SheetsFarApartGiveTheSameBitsAsAlone) {
  for (const auto method : {coarse_fem, small_hybrid}) {
    std::vector<Shot> shots{test::s1_push(), test::s1_push()};
    shots[1].start.x.col(1).array() += 0.11;  // beside it: their bounding boxes almost touch
    for (Handle& handle : shots[1].handles)
      if (handle.mode == HandleMode::absolute) handle.keyed.col(1).array() += 0.11;
    AnimateOptions options = until(40);
    options.plasticity = Plasticity::on;
    const Outcome both = test::outcome_of(shots, method, options);
    for (std::size_t s = 0; s < 2; ++s) {
      const Outcome alone = test::outcome_of(
          {shots[s]}, [&](const Shot& shot, std::size_t) { return method(shot, s); }, options);
      ASSERT_EQ(alone.shapes[0].size(), 40u);
      for (std::size_t f = 0; f < 40; ++f)
        ASSERT_TRUE(both.shapes[s][f].x == alone.shapes[0][f].x) << s << " " << f;
    }
    EXPECT_EQ(both.touching_others, 0);
  }
}

TEST(AnimateTogetherTest, APalmPushesACurtainWhicheverOfThemIsListedFirst) {
  const std::vector<Shot> shots = test::pushed_curtain(40);
  const AnimateOptions options = until(40, 9.81);
  AnimateOptions off_options = options;
  off_options.elastic.contact = SelfContact::off;
  ASSERT_LT(test::outcome_of(shots, coarse_fem, off_options).shapes[0].back().x.col(0).maxCoeff(),
            0.021)
      << "without contact it hangs where it hung";
  for (const auto method : {coarse_fem, small_hybrid}) {
    const Outcome pushed = test::outcome_of(shots, method, options);
    EXPECT_EQ(pushed.crossings, 0);
    EXPECT_EQ(pushed.crossings_with_others, 0);
    EXPECT_GT(pushed.touching_others, 0);
    EXPECT_GT(pushed.shapes[0].back().x.col(0).maxCoeff(), 0.08) << "in front of the palm";
    EXPECT_GT(pushed.shapes[0].back().x.col(2).minCoeff(), 0.03) << "lifted";
    EXPECT_LT(pushed.stretch, 1e-3);
    EXPECT_LT(pushed.energy, 1e-5) << "what a swinging sheet of 10 cm stores [J]";
    for (const HandleFrame& handle : pushed.frames[1].back().handles)
      EXPECT_LT((handle.at - handle.keyed).norm(), 1e-4);
    // the other way round: the result must not depend on the order of sheets and vertices
    const Outcome other = test::outcome_of(
        {shots[1], shots[0]}, [&](const Shot& shot, std::size_t s) { return method(shot, 1 - s); },
        options);
    EXPECT_LT(off(pushed.shapes[0].back(), other.shapes[1].back()), 0.005 * 0.1);
    EXPECT_LT(off(pushed.shapes[1].back(), other.shapes[0].back()), 0.005 * 0.1);
  }
}

TEST(AnimateTogetherTest, ACardThatFallsOnASheetHeldByItsCornersMakesItSag) {
  const Vector3d x(1, 0, 0), y(0, 1, 0), above(0.055, 0.024, 0.02);
  constexpr int frames = 40;
  Shot sheet = test::placed(0.21, 0.148, Vector3d::Zero(), x, y),
       card = test::placed(0.1, 0.1, above, x, y);
  card.paper.area_density = 0.2;
  card.paper.bending_stiffness *= 10;
  for (const double u : {0.0, 0.21})
    for (const double v : {0.0, 0.148})
      test::hold(
          sheet, {u, v}, frames,
          [=](int f) { return Vector3d(std::min(1.0, f / 12.0) * (u > 0 ? -2e-4 : 2e-4), 0, 0); },
          Vector3d::Zero(), x, y);
  AnimateOptions options = until(frames, 9.81);
  options.elastic.inertia = Inertia::dynamic;
  const Outcome without = test::outcome_of({sheet}, coarse_fem, options),
                with = test::outcome_of({sheet, card}, coarse_fem, options);
  EXPECT_EQ(with.crossings_with_others, 0);
  EXPECT_GT(with.touching_others, 0);
  const auto height = [](const Outcome& o) { return o.shapes[0].back().x.col(2).mean(); };
  EXPECT_LT(height(with), height(without) - 7e-5)
      << "it cannot stretch, and a stiff card bridges its middle";
  EXPECT_GT(with.shapes[1].back().x.col(2).minCoeff(), with.shapes[0].back().x.col(2).minCoeff())
      << "it lies on it";
  EXPECT_LT(with.shapes[1].back().x.col(2).maxCoeff(), 0) << "below the corners";
}

/// Two sheets, one 6 mm above the other, each drawn together by three handles.
std::vector<Shot> two_crumples() {
  const Vector3d x(1, 0, 0), y(0, 1, 0), middle(0.075, 0.075, 0);
  std::vector<Shot> shots;
  for (int s = 0; s < 2; ++s) {
    const Vector3d corner(0, 0, 0.006 * s);
    Shot shot = test::placed(0.15, 0.15, corner, x, y);
    shot.paper.friction = 0.4;
    for (int k = 0; k < 3; ++k) {
      const double turn = 2 * M_PI * k / 3 + s * M_PI / 3;
      const Vector2d p = middle.head<2>() + 0.06 * Vector2d(std::cos(turn), std::sin(turn));
      test::hold(
          shot, p, 30,
          [=](int f) -> Vector3d {
            return std::min(1.0, f / 26.0) *
                   Vector3d(-0.6 * (p.x() - 0.075), -0.6 * (p.y() - 0.075), k % 2 ? 0.02 : -0.02);
          },
          corner, x, y);
    }
    shots.push_back(shot);
  }
  return shots;
}

TEST(AnimateTogetherTest, TwoSheetsCrushedTogetherDoNotIntersect) {
  AnimateOptions options = until(30);
  options.plasticity = Plasticity::on;
  const Outcome crushed = test::outcome_of(two_crumples(), small_hybrid, options);
  EXPECT_EQ(crushed.crossings, 0);
  EXPECT_EQ(crushed.crossings_with_others, 0);
  EXPECT_GT(crushed.touching_others, 20);
  EXPECT_LT(crushed.stretch, 0.02);
  int births = 0;
  for (const auto& sheet : crushed.frames)
    for (const AnimatedFrame& f : sheet) births += f.statistics.new_singular;
  EXPECT_GT(births, 0) << "their meshes change beside each other";
}

TEST(AnimateTogetherTest, AResumedShotOfTwoSheetsGivesTheSameBits) {
  const std::vector<Shot> shots = two_crumples();
  AnimateOptions options = until(18);
  options.plasticity = Plasticity::on;
  const auto animated = [&](const std::vector<std::string>& states) {
    std::vector<MethodChoice> methods{small_hybrid(shots[0], 0), small_hybrid(shots[1], 1)};
    std::vector<AnimateOptions> all(2, options);
    for (std::size_t s = 0; s < states.size(); ++s) all[s].resume_state = states[s];
    std::vector<std::pair<Points3, std::string>> frames;
    animate_together({{shots[0], methods[0], all[0]}, {shots[1], methods[1], all[1]}},
                     [&](const AnimatedFrame& f) {
                       frames.emplace_back(f.sheet->x, f.state());
                       return true;
                     });
    return frames;
  };
  const auto whole = animated({});
  ASSERT_EQ(whole.size(), 36u);
  for (const std::size_t from : {4u, 11u}) {
    const auto rest = animated({whole[2 * from].second, whole[2 * from + 1].second});
    ASSERT_EQ(rest.size(), 36 - 2 * (from + 1));
    for (std::size_t k = 0; k < rest.size(); ++k) {
      EXPECT_TRUE(rest[k].first == whole[2 * (from + 1) + k].first) << from << " " << k;
      EXPECT_EQ(rest[k].second, whole[2 * (from + 1) + k].second);
    }
  }
  EXPECT_THROW(animated({whole[2].second, ""}), Error);
}

/// Two sheets on each other, held at their left borders; the right border of the lower one is
/// lifted.
std::vector<Shot> stack(double gap, double friction = 0) {
  const Vector3d x(1, 0, 0), y(0, 1, 0);
  std::vector<Shot> shots;
  for (int s = 0; s < 2; ++s) {
    const Vector3d corner(0, 0, gap * s);
    Shot shot = test::placed(0.1, 0.1, corner, x, y);
    shot.paper.friction = friction;
    for (const double v : {0.0, 0.1}) test::hold(shot, {0, v}, 20, test::stays, corner, x, y);
    if (s == 0)
      for (const double v : {0.0, 0.1})
        test::hold(
            shot, {0.1, v}, 20,
            [](int f) {
              const double a = f < 4 ? 0 : 0.05 * (f - 4);
              return Vector3d(0.0995 * std::cos(a) - 0.0995 - (f < 4 ? 0 : 5e-4), 0,
                              0.0995 * std::sin(a));
            },
            corner, x, y);
    shots.push_back(shot);
  }
  return shots;
}

TEST(AnimateTogetherTest, AStackOfSheetsNeitherJumpsApartNorIntersects) {
  for (const double friction : {0.0, 0.4}) {
    const Outcome lifted = test::outcome_of(stack(1e-4, friction), coarse_fem, until(20));
    EXPECT_LT((lifted.shapes[1][3].x.col(2).array() - 1e-4).abs().maxCoeff(), 5e-5)
        << "nothing has moved yet";
    EXPECT_EQ(lifted.crossings_with_others, 0);
    EXPECT_GT(lifted.shapes[1].back().x.col(2).maxCoeff(), 0.06) << "the lower one lifts the other";
  }
}

TEST(AnimateTogetherTest, CoincidentSheetsIgnoreEachOther) {
  const Outcome lying = test::outcome_of(stack(0), coarse_fem, until(20));
  EXPECT_EQ(lying.touching_others, 0);
  EXPECT_LT(lying.shapes[1].back().x.col(2).cwiseAbs().maxCoeff(), 1e-3)
      << "the upper one stays where it is";
}

/// A sheet that lies flat, and one joined to it at its left border that stands up by 10 degrees;
/// its right border is pressed down to 10 mm below the other sheet.
TEST(AnimateTogetherTest, SheetsJoinedAtABorderStayApartElsewhere) {
  const Vector3d x(1, 0, 0), y(0, 1, 0), up(std::cos(0.17), 0, std::sin(0.17));
  Shot page = test::placed(0.1, 0.1, Vector3d::Zero(), x, y),
       leaf = test::placed(0.1, 0.1, Vector3d::Zero(), up, y);
  for (const double v : {0.0, 0.1}) {
    test::hold(leaf, {0, v}, 24, test::stays, Vector3d::Zero(), up, y);
    test::hold(
        leaf, {0.1, v}, 24, [](int f) { return Vector3d(0, 0, -0.027 * f / 23.0); },
        Vector3d::Zero(), up, y);
    test::hold(page, {0, v}, 24, test::stays, Vector3d::Zero(), x, y);
  }
  const Outcome pressed = test::outcome_of({page, leaf}, coarse_fem, until(24));
  // in the first frame they are as modelled
  for (std::size_t f = 1; f < 24; ++f)
    EXPECT_EQ(crossings_between(pressed.shapes[0][f], pressed.shapes[1][f]), 0) << f;
  EXPECT_GT(pressed.touching_others, 0);
  EXPECT_LT(pressed.shapes[0].back().x.col(2).minCoeff(), -0.005) << "pressed down";
}

}  // namespace
}  // namespace paperbake
