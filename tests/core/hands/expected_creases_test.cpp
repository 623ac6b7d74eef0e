#include "core/hands/expected_creases.h"

#include "core/animation/animate.h"
#include "core/geometry/measure.h"
#include "core/methods/hybrid.h"
#include "core/model/segment2.h"
#include "tests/core/test_meshes.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <utility>

namespace paperbake {
namespace {

using Eigen::Isometry3d;
using Poses = std::function<Isometry3d(double share)>;  // of the time, from 0 to 1

constexpr int frames = 25, first_frame = 1;
constexpr double degrees = M_PI / 180;

/// Handles that move as one rigid plate, from where they hold the flat sheet.
struct Plate {
  std::vector<Vector2d> points;  // [m]
  Poses pose;
};

Vector3d on_sheet(const Vector2d& p) { return {p.x(), p.y(), 0}; }

Isometry3d still(double) { return Isometry3d::Identity(); }

/// The turn about a line of the flat sheet, right-handed about its direction.
Isometry3d turned(double angle, const Vector2d& point, const Vector2d& direction) {
  return Isometry3d(Eigen::Translation3d(on_sheet(point)) *
                    Eigen::AngleAxisd(angle, on_sheet(direction).normalized()) *
                    Eigen::Translation3d(-on_sheet(point)));
}

Poses turning(double angle, const Vector2d& point, const Vector2d& direction) {
  return [=](double share) { return turned(share * angle, point, direction); };
}

void hold(Shot& shot, const Plate& plate) {
  for (const Vector2d& p : plate.points) {
    Handle handle = test::bare_handle("handle." + std::to_string(shot.handles.size()), p, frames);
    for (int f = 0; f < frames; ++f)
      handle.keyed.row(f) = plate.pose(f / (frames - 1.0)) * on_sheet(p);
    shot.handles.push_back(handle);
  }
}

Shot held(const Pattern& pattern, const std::vector<Plate>& plates) {
  Shot shot = test::blank_shot(pattern);
  for (const Plate& plate : plates) hold(shot, plate);
  return shot;
}

std::vector<ExpectedCrease> lines_of(const Shot& shot) {
  return expected_creases(shot, first_frame);
}

/// The only line whose two ends are these, in one of the two orders.
const ExpectedCrease* line_between(const std::vector<ExpectedCrease>& lines, const Vector2d& a,
                                   const Vector2d& b, double near = 1e-9) {
  const ExpectedCrease* found = nullptr;
  for (const ExpectedCrease& line : lines) {
    const auto& [p, q] = line.line;
    if (((p - a).norm() > near || (q - b).norm() > near) &&
        ((p - b).norm() > near || (q - a).norm() > near))
      continue;
    EXPECT_EQ(found, nullptr) << "the same line twice";
    found = &line;
  }
  return found;
}

/// [rad] between two plates with an edge a-b in common; `left` is on the left of the way from a to
/// b.
double angle_between(const Isometry3d& left, const Isometry3d& right, const Vector2d& a,
                     const Vector2d& b) {
  const Vector2d across = Vector2d(a.y() - b.y(), b.x() - a.x());
  Points3 x(4, 3);
  x << (left * on_sheet(a)).transpose(), (left * on_sheet(b)).transpose(),
      (left * on_sheet(0.5 * (a + b) + across)).transpose(),
      (right * on_sheet(0.5 * (a + b) - across)).transpose();
  return dihedral_angle(x, {{0, 1, 2, 3}, {0, 1}});
}

const Pattern a4 = test::rectangle(0.210, 0.297);
constexpr double low_fold = 0.099, high_fold = 0.198;  // [m]

const std::vector<Vector2d> in_the_middle{
    {0, 0.110}, {0.210, 0.110}, {0.105, 0.147}, {0, 0.184}, {0.210, 0.184}};
const std::vector<Vector2d> at_the_bottom{
    {0, 0.030}, {0.105, 0.030}, {0.210, 0.030}, {0.0525, 0.066}, {0.1575, 0.066}};
const std::vector<Vector2d> at_the_top{
    {0, 0.297}, {0.105, 0.297}, {0.210, 0.297}, {0.0525, 0.2475}, {0.1575, 0.2475}};

/// The bottom third first and up, the top third after it, up too or under the sheet.
std::vector<Plate> letter(double bottom = 177.5 * degrees, double top = 165 * degrees) {
  return {{in_the_middle, still},
          {at_the_bottom,
           [=](double s) {
             return turned(std::min(1.0, 2 * s) * bottom, {0, low_fold}, {-1, 0});
           }},
          {at_the_top, [=](double s) {
             return turned(std::max(0.0, 2 * s - 1) * top, {0, high_fold}, {1, 0});
           }}};
}

TEST(ExpectedCreasesTest, HandsThatPickUpALyingSheetAnnounceTheSameLines) {
  Shot shot = held(a4, letter());
  const std::vector<ExpectedCrease> absolute = lines_of(shot);
  for (Handle& handle : shot.handles) {
    handle.mode = HandleMode::relative;
    handle.keyed.rowwise() += Eigen::RowVector3d(0.02, 0.01, 0.05);  // they hover beside it
  }
  const std::vector<ExpectedCrease> relative = lines_of(shot);
  ASSERT_EQ(relative.size(), absolute.size());
  for (std::size_t i = 0; i < relative.size(); ++i) {
    EXPECT_LT((relative[i].line.a - absolute[i].line.a).norm(), 1e-9);
    EXPECT_LT((relative[i].line.b - absolute[i].line.b).norm(), 1e-9);
    EXPECT_NEAR(relative[i].turn.back(), absolute[i].turn.back(), 1e-9);
  }
}

TEST(ExpectedCreasesTest, ThreeClampsOfALetterGiveItsTwoLinesAndTurns) {
  for (const double top : {165 * degrees, -165 * degrees}) {
    const std::vector<Plate> plates = letter(177.5 * degrees, top);
    const std::vector<ExpectedCrease> lines = lines_of(held(a4, plates));
    ASSERT_EQ(lines.size(), 2u);
    const ExpectedCrease *low = line_between(lines, {0, low_fold}, {0.210, low_fold}),
                         *high = line_between(lines, {0, high_fold}, {0.210, high_fold});
    ASSERT_TRUE(low && high);
    for (const ExpectedCrease* line : {low, high}) {
      EXPECT_TRUE(line->drawn.empty());
      ASSERT_EQ(line->missing.size(), 1u);
      EXPECT_EQ(line->missing[0].a, line->line.a);
      EXPECT_EQ(line->missing[0].b, line->line.b);
      ASSERT_EQ(line->turn.size(), std::size_t(frames));
    }
    EXPECT_NEAR(low->turn.back(), -177.5 * degrees, 1e-9) << "up: it bulges away from the normals";
    EXPECT_NEAR(high->turn.back(), -top, 1e-9);
    for (int f = 0; f < frames; ++f) {
      const double s = f / (frames - 1.0);
      const Isometry3d middle = plates[0].pose(s), bottom = plates[1].pose(s),
                       over = plates[2].pose(s);
      EXPECT_NEAR(low->turn[f], angle_between(middle, bottom, {0, low_fold}, {0.210, low_fold}),
                  1e-9);
      EXPECT_NEAR(high->turn[f], angle_between(over, middle, {0, high_fold}, {0.210, high_fold}),
                  1e-9);
    }
    EXPECT_TRUE(low->between.y() > 0.048 && low->between.y() < 0.147);
    EXPECT_TRUE(high->between.y() > 0.147 && high->between.y() < 0.273);
  }
}

TEST(ExpectedCreasesTest, TheTurnGoesOnBeyondHalfATurn) {
  const auto lines = lines_of(held(a4, letter(190 * degrees, 0)));
  ASSERT_EQ(lines.size(), 1u);
  for (int f = 0; f < frames; ++f)
    EXPECT_NEAR(lines[0].turn[f], -190 * degrees * std::min(1.0, 2 * f / (frames - 1.0)), 1e-9);
}

/// Strips side by side, turned to and fro by this angle.
std::vector<Plate> fan(int strips, double angle) {
  constexpr double width = 0.032;
  std::vector<Plate> plates;
  for (int i = 0; i < strips; ++i) {
    const double left = i * width;
    plates.push_back(
        {{{left + 0.008, 0}, {left + 0.024, 0}, {left + 0.008, 0.1}, {left + 0.024, 0.1}},
         [=](double s) {
           Isometry3d pose = Isometry3d::Identity();
           for (int k = 1; k <= i; ++k)
             pose = pose * turned((k % 2 ? 1 : -1) * s * angle, {k * width, 0}, {0, 1});
           return pose;
         }});
  }
  return plates;
}

TEST(ExpectedCreasesTest, AFanOfFiveStripsGivesFourLinesOfAlternatingSign) {
  for (const double angle : {70 * degrees, 160 * degrees}) {
    const std::vector<ExpectedCrease> lines =
        lines_of(held(test::rectangle(0.160, 0.1), fan(5, angle)));
    EXPECT_EQ(lines.size(), 4u);
    for (int k = 1; k <= 4; ++k) {
      const ExpectedCrease* line = line_between(lines, {0.032 * k, 0}, {0.032 * k, 0.1});
      ASSERT_TRUE(line) << k;
      EXPECT_NEAR(line->turn.back(), (k % 2 ? 1 : -1) * angle, 1e-9);
      EXPECT_NEAR(line->between.x(), 0.032 * k, 1e-9);
    }
  }
}

TEST(ExpectedCreasesTest, HandlesOnTheFoldsOfAnAccordionFoldEachBetweenThePlatesBesideIt) {
  // the strip in the middle is the widest: the handles on both its sides are nearer to others
  const std::vector<double> at{0, 0.025, 0.050, 0.076, 0.101, 0.126, 0.151};
  std::vector<Plate> rows;
  for (std::size_t k = 0; k < at.size(); ++k)
    rows.push_back(
        {{{at[k], 0}, {at[k], 0.05}, {at[k], 0.1}}, [=](double s) {
           Isometry3d pose = Isometry3d::Identity();
           for (std::size_t i = 1; i <= k && i + 1 < at.size(); ++i)
             pose = pose * turned((i % 2 ? 1 : -1) * s * 150 * degrees, {at[i], 0}, {0, 1});
           return pose;
         }});
  const std::vector<ExpectedCrease> lines = lines_of(held(test::rectangle(0.151, 0.1), rows));
  EXPECT_EQ(lines.size(), 5u);
  for (std::size_t k = 1; k + 1 < at.size(); ++k) {
    const ExpectedCrease* line = line_between(lines, {at[k], 0}, {at[k], 0.1});
    ASSERT_TRUE(line) << k;
    EXPECT_NEAR(line->turn.back(), (k % 2 ? 1 : -1) * 150 * degrees, 1e-9) << k;
    EXPECT_NEAR(line->between.x(), 0.25 * (at[k - 1] + 2 * at[k] + at[k + 1]), 1e-9) << k;
  }
}

const Pattern page = test::rectangle(0.150, 0.150);
const std::vector<Vector2d> on_the_page{{0, 0}, {0.150, 0}, {0, 0.150}, {0.090, 0.090}},
    on_the_corner{{0.150, 0.150}, {0.145, 0.085}, {0.085, 0.145}, {0.120, 0.120}};

/// A corner turned over along the line x + y = 210 mm.
std::vector<Plate> corner(double angle) {
  return {{on_the_page, still}, {on_the_corner, turning(angle, {0.105, 0.105}, {1, -1})}};
}

TEST(ExpectedCreasesTest, ACornerIsFoldedAlongADiagonalLine) {
  const std::vector<ExpectedCrease> lines = lines_of(held(page, corner(175 * degrees)));
  ASSERT_EQ(lines.size(), 1u);
  ASSERT_TRUE(line_between(lines, {0.150, 0.060}, {0.060, 0.150}));
  EXPECT_NEAR(lines[0].turn.back(), -175 * degrees, 1e-9);
  EXPECT_NEAR(lines[0].turn[12], -87.5 * degrees, 1e-9);
}

TEST(ExpectedCreasesTest, AWholeSceneThatIsTurnedAndMovedHasTheSameLines) {
  const Isometry3d moved =
      Eigen::Translation3d(3, -2, 1.5) * Eigen::AngleAxisd(2.2, Vector3d(1, 2, -0.5).normalized());
  for (Shot shot : {held(a4, letter()), held(page, corner(150 * degrees))}) {
    const std::vector<ExpectedCrease> here = lines_of(shot);
    for (Handle& handle : shot.handles)
      for (int f = 0; f < frames; ++f)
        handle.keyed.row(f) = moved * Vector3d(handle.keyed.row(f).transpose());
    const std::vector<ExpectedCrease> there = lines_of(shot);
    ASSERT_GT(here.size(), 0u);
    ASSERT_EQ(here.size(), there.size());
    for (const ExpectedCrease& line : here) {
      const ExpectedCrease* same = line_between(there, line.line.a, line.line.b);
      ASSERT_TRUE(same);
      for (int f = 0; f < frames; ++f) EXPECT_NEAR(same->turn[f], line.turn[f], 1e-9);
    }
  }
}

TEST(ExpectedCreasesTest, AHoleDividesALine) {
  Pattern pattern = a4;
  pattern.holes = {{{0.08, 0.09}, {0.08, 0.105}, {0.13, 0.105}, {0.13, 0.09}}};
  const std::vector<ExpectedCrease> lines = lines_of(held(pattern, letter()));
  EXPECT_EQ(lines.size(), 3u);
  EXPECT_TRUE(line_between(lines, {0, low_fold}, {0.08, low_fold}));
  EXPECT_TRUE(line_between(lines, {0.13, low_fold}, {0.210, low_fold}));
}

/// A card with a spine at u = 80 mm that stands open by 2 x `angle`, with two slits across the
/// spine. The strip between them stands up from it where `popped`.
/// ridge  [m] u of the fold of the strip; of the whole spine where no strip stands up
Shot pop_up_card(double angle, bool popped, double ridge = 0.08) {
  const std::vector<double> us{0, 0.05, 0.08, 0.11, 0.16}, vs{0, 0.04, 0.041, 0.079, 0.08, 0.12};
  Pattern pattern;
  pattern.outline = {{0, 0}, {us[4], 0}, {us[4], vs[5]}, {0, vs[5]}};
  for (const int k : {1, 3})
    pattern.holes.push_back(
        {{us[1], vs[k]}, {us[1], vs[k + 1]}, {us[3], vs[k + 1]}, {us[3], vs[k]}});
  Shot shot = test::blank_shot(pattern);
  Sheet& start = shot.start;
  start = {};
  start.pattern.resize(30, 2);
  start.x.resize(30, 3);
  const auto half = [&](double u) { return (u - us[2]) * std::cos(angle); };
  const auto height = [&](double u) { return std::abs(u - us[2]) * std::sin(angle); };
  for (int j = 0; j < 6; ++j)
    for (int i = 0; i < 5; ++i) {
      const bool stands_up = popped && i == 2 && (j == 2 || j == 3);
      const double u = stands_up || (i == 2 && !popped) ? ridge : us[i];
      start.pattern.row(5 * j + i) << u, vs[j];
      start.x.row(5 * j + i) << half(u), vs[j],
          stands_up ? 2 * height(us[1]) - height(u) : height(u);
    }
  std::vector<std::array<int, 3>> triangles;
  for (int j = 0; j < 5; ++j)
    for (int i = 0; i < 4; ++i) {
      if ((j == 1 || j == 3) && (i == 1 || i == 2)) continue;  // the slits
      const int a = 5 * j + i;
      triangles.push_back({a, a + 1, a + 6});
      triangles.push_back({a, a + 6, a + 5});
    }
  start.triangles.resize(static_cast<int>(triangles.size()), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    start.triangles.row(static_cast<int>(t)) << triangles[t][0], triangles[t][1], triangles[t][2];
  // the hands hold the two halves not quite alike: their middle does not lie on the spine
  for (const double side : {-1, 1})
    for (const Vector2d& at : {Vector2d(0.07, 0.01), Vector2d(0.07, 0.11), Vector2d(0.05, 0.06)}) {
      const Vector2d p(at.x() + 5e-4 * side, at.y());
      Handle handle = test::bare_handle("handle." + std::to_string(shot.handles.size()),
                                        {us[2] + side * p.x(), p.y()}, frames);
      for (int f = 0; f < frames; ++f) {
        const double now = angle + f / (frames - 1.0) * (85 * degrees - angle);
        handle.keyed.row(f) << side * p.x() * std::cos(now), p.y(), p.x() * std::sin(now);
      }
      shot.handles.push_back(handle);
    }
  return shot;
}

TEST(ExpectedCreasesTest, HandsDoNotFoldAStripThatBeginsFoldedTheOtherWay) {
  const Vector2d low(0.08, 0.041), high(0.08, 0.079);
  for (const double angle : {5 * degrees, 45 * degrees, 60 * degrees}) {
    for (const double ridge : {0.08, 0.0801, 0.0795, 0.095}) {
      const std::vector<ExpectedCrease> popped = lines_of(pop_up_card(angle, true, ridge));
      EXPECT_EQ(popped.size(), 2u) << "the spine on both sides of the strip: " << ridge;
      EXPECT_FALSE(line_between(popped, low, high));
    }
    for (const double spine : {0.08, 0.0802}) {
      const std::vector<ExpectedCrease> flat = lines_of(pop_up_card(angle, false, spine));
      EXPECT_EQ(flat.size(), 3u) << spine;
      EXPECT_TRUE(line_between(flat, low, high)) << "folded like the spine, it is part of it";
    }
  }
}

TEST(ExpectedCreasesTest, AHandleThatIsNearlyOnTheLineBecomesAPointOfIt) {
  const auto with = [](const std::vector<Vector2d>& more) {
    std::vector<Plate> plates = letter();
    plates.push_back({more, still});
    return lines_of(held(a4, plates));
  };
  const auto distance = [](const ExpectedCrease& line, const Vector2d& p) {
    return distance_to_segment(p, line.line.a, line.line.b);
  };
  const Vector2d inside(0.1, low_fold + 5e-5), at_border(0.210, low_fold - 5e-5),
      far(0.1, low_fold + 5e-3);
  for (const auto& points : std::vector<std::vector<Vector2d>>{
           {inside}, {at_border}, {{0, low_fold + 5e-5}, at_border}}) {
    const std::vector<ExpectedCrease> lines = with(points);
    ASSERT_EQ(lines.size(), 2u);
    const bool first = distance(lines[0], points[0]) < 1e-3;
    const ExpectedCrease& low = lines[first ? 0 : 1];
    for (const Vector2d& p : points) EXPECT_LT(distance(low, p), 1e-12);
  }
  // exactly, where it is the end of the line
  const std::vector<ExpectedCrease> ends = with({at_border});
  int exact = 0;
  for (const ExpectedCrease& line : ends)
    for (const Vector2d& p : {line.line.a, line.line.b}) exact += p == at_border;
  EXPECT_EQ(exact, 1);
  EXPECT_TRUE(line_between(with({far}), {0, low_fold}, {0.210, low_fold}));
}

TEST(ExpectedCreasesTest, AHandleOfAClampBesideTheLineDoesNotMoveIt) {
  // it goes where the clamp goes: a line through it would make one flap longer than the way to its
  // hand, so that it would bulge
  for (const double beside : {0.0005, 0.0008, 0.002}) {
    const Plate lying{{{0.01, 0.01}, {0.01, 0.14}, {0.06, 0.07}}, still},
        fingers{{{0.075 - beside, 0.03}, {0.075 - beside, 0.12}}, still},
        flap{{{0.14, 0.01}, {0.14, 0.14}, {0.09, 0.07}}, [](double s) {
               return turned(s * 170 * degrees, {0.075, 0}, {0, -1});
             }};
    const std::vector<ExpectedCrease> lines = lines_of(held(page, {lying, fingers, flap}));
    EXPECT_EQ(lines.size(), 1u) << beside;
    EXPECT_TRUE(line_between(lines, {0.075, 0}, {0.075, 0.15})) << beside;
  }
}

TEST(ExpectedCreasesTest, AHandThatTakesOverFromAnotherFoldsOnAlongItsLine) {
  const Poses turns = [](double s) { return turned(s * 172 * degrees, {0.075, 0}, {0, -1}); };
  const Plate still_half{{{0.01, 0.01}, {0.01, 0.14}, {0.06, 0.07}}, still},
      first{{{0.14, 0.01}, {0.14, 0.14}, {0.09, 0.07}}, turns},
      second{{{0.13, 0.03}, {0.13, 0.12}, {0.10, 0.05}}, turns};
  constexpr int change = 14;  // frame of the scene
  for (const int gap : {-3, 0, 2}) {
    Shot shot = held(page, {still_half, first, second});
    for (std::size_t h = 3; h < 6; ++h) shot.handles[h].release_frame = first_frame + change;
    for (std::size_t h = 6; h < 9; ++h) shot.handles[h].grab_frame = first_frame + change + gap;
    const std::vector<ExpectedCrease> lines = lines_of(shot);
    ASSERT_EQ(lines.size(), 1u) << gap;
    EXPECT_NEAR(std::abs(largest_turn(lines[0])), 172 * degrees, 1e-9) << gap;
    for (int f = 0; f < frames; ++f)
      EXPECT_EQ(std::isnan(lines[0].turn[f]), f >= change && f < change + gap) << gap << ' ' << f;
  }
}

TEST(ExpectedCreasesTest, WhatTheArtistHasDrawnAlongALineIsMovedOntoItAndFoldedByHands) {
  Shot shot = held(a4, letter());
  // 0.5 to 1 mm beside the line; a crease that ends there; and one that crosses it
  shot.pattern.prescribed_creases = {{{{0, 0.0998}, {0.1, 0.0985}, {0.210, 0.0995}}, -1.0},
                                     {{{0.05, 0.09915}, {0.09, 0.15}}},
                                     {{{0.15, 0.02}, {0.15, 0.12}}}};
  const std::vector<PrescribedCrease> before = shot.pattern.prescribed_creases;
  const std::vector<ExpectedCrease> lines = lines_of(shot);
  ASSERT_EQ(lines.size(), 2u);
  const ExpectedCrease *drawn = line_between(lines, {0, low_fold}, {0.210, low_fold}),
                       *other = line_between(lines, {0, high_fold}, {0.210, high_fold});
  ASSERT_TRUE(drawn && other);
  EXPECT_TRUE(drawn->missing.empty());
  EXPECT_EQ(drawn->creases, std::vector<int>{0});
  EXPECT_EQ(drawn->drawn.size(), 2u);
  add_expected_creases(shot, lines);
  const std::vector<PrescribedCrease>& now = shot.pattern.prescribed_creases;
  ASSERT_EQ(now.size(), 4u) << "none is added where one is drawn";
  EXPECT_EQ(now[0].angle, -1.0);
  for (std::size_t k = 0; k < before[0].line.size(); ++k)
    EXPECT_LT((now[0].line[k] - Vector2d(before[0].line[k].x(), low_fold)).norm(), 1e-9);
  EXPECT_LT((now[1].line[0] - Vector2d(0.05, low_fold)).norm(), 1e-9);
  EXPECT_EQ(now[1].line[1], before[1].line[1]);
  EXPECT_EQ(now[2].line, before[2].line);
  ASSERT_EQ(shot.hands.size(), 2u);
  for (const FoldingHands& hands : shot.hands) {
    const bool of_drawn = hands.line.a.y() < 0.1;
    EXPECT_EQ(hands.turn, (of_drawn ? drawn : other)->turn);
    EXPECT_EQ(hands.parts.size(), of_drawn ? 2u : 1u);
  }
}

/// A book cover: the upper half turns a quarter about one edge of a spine, and then another one
/// about the other edge of it.
Shot cover_round_a_spine(double spine) {
  const double from = 0.1485 - 0.5 * spine, to = from + spine;  // [m] along the longer side
  const Poses flap = [=](double share) {
    const double first = std::min(1.0, 2 * share), second = std::max(0.0, 2 * share - 1);
    return turned(first * 90 * degrees, {0, from}, {1, 0}) *
           turned(second * 88 * degrees, {0, to}, {1, 0});
  };
  Shot shot = held(a4, {{at_the_bottom, still}, {at_the_top, flap}});
  shot.pattern.prescribed_creases = {{{{0, from}, {0.210, from}}, 0, false},
                                     {{{0, to}, {0.210, to}}, 0, false}};
  return shot;
}

TEST(ExpectedCreasesTest, TwoCreasesThatAreDrawnBesideEachOtherAreNotMovedOntoOneLine) {
  for (const double spine : {0.002, 0.003, 0.004}) {
    Shot shot = cover_round_a_spine(spine);
    const std::vector<PrescribedCrease> drawn = shot.pattern.prescribed_creases;
    const std::vector<ExpectedCrease> lines = lines_of(shot);
    EXPECT_TRUE(lines.empty()) << spine;
    add_expected_creases(shot, lines);
    ASSERT_EQ(shot.pattern.prescribed_creases.size(), 2u) << spine;
    for (std::size_t c = 0; c < 2; ++c)
      EXPECT_EQ(shot.pattern.prescribed_creases[c].line, drawn[c].line) << spine;
    // one of them alone is what hands fold there, and so is one that is drawn in two parts
    shot = cover_round_a_spine(spine);
    std::vector<PrescribedCrease>& creases = shot.pattern.prescribed_creases;
    creases.pop_back();
    EXPECT_EQ(lines_of(shot).size(), 1u) << spine;
    creases.push_back(creases.front());
    creases[0].line[1].x() = creases[1].line[0].x() = 0.1;
    EXPECT_EQ(lines_of(shot).size(), 1u) << spine;
  }
}

TEST(ExpectedCreasesTest, CreasesAreBesideEachOtherOnlyWhereTheyAreAlongMostOfWhatIsDrawn) {
  const double spine = 0.004, middle = 0.1485, low = middle - 0.5 * spine, high = low + spine;
  using Line = std::vector<Vector2d>;
  const auto count = [&](const std::vector<Line>& drawn) {
    Shot shot = cover_round_a_spine(spine);
    shot.pattern.prescribed_creases.clear();
    for (const Line& line : drawn) shot.pattern.prescribed_creases.push_back({line, 0, false});
    return lines_of(shot).size();
  };
  // two parts that pass each other by 5 mm
  EXPECT_EQ(count({{{0, low}, {0.105, low}}, {{0.1, high}, {0.210, high}}}), 1u);
  // one that slants, whose last third is drawn twice
  const Vector2d third(0.140, low + 2 * spine / 3);
  EXPECT_EQ(count({{{0, low}, {0.210, high}}, {third, {0.210, high}}}), 1u);
  // two that cross on the line are apart from each other along most of it
  EXPECT_EQ(count({{{0, low}, {0.210, high}}, {{0.210, low}, {0, high}}}), 0u);
  // two in many short pieces
  Line one, other;
  for (int k = 0; k <= 100; ++k) {
    one.emplace_back(0.0021 * k, low + 1e-4 * (k % 2));
    other.emplace_back(0.0021 * k, high - 1e-4 * (k % 2));
  }
  EXPECT_EQ(count({one, other}), 0u);
  EXPECT_EQ(count({one}), 1u);
}

TEST(ExpectedCreasesTest, WhereTheArtistHasDrawnOnlyPartsOfALineTheOthersAreAdded) {
  Shot shot = held(a4, letter());
  const Vector2d inside(0.04, low_fold), end(0.09, low_fold), corner(0.12, low_fold),
      aside(0.12, 0.15), border(0.210, low_fold);
  // in both directions; the second one turns off the line at a corner
  shot.pattern.prescribed_creases = {{{end, inside}}, {{border, corner, aside}}};
  const std::vector<ExpectedCrease> lines = lines_of(shot);
  const ExpectedCrease* line = line_between(lines, {0, low_fold}, border);
  ASSERT_TRUE(line);
  ASSERT_EQ(line->drawn.size(), 2u);
  ASSERT_EQ(line->missing.size(), 2u);
  double length = 0;
  for (const std::vector<Segment2>& parts : {line->drawn, line->missing})
    for (const Segment2& part : parts) {
      EXPECT_NEAR(part.a.y(), low_fold, 1e-9);
      EXPECT_NEAR(part.b.y(), low_fold, 1e-9);
      length += (part.b - part.a).norm();
    }
  EXPECT_NEAR(length, 0.210, 1e-9) << "no gap and no overlap";
}

TEST(ExpectedCreasesTest, ACreaseThatIsDrawnAcrossALineDoesNotReplaceIt) {
  Shot shot = held(a4, letter());
  shot.pattern.prescribed_creases = {{{{0.105, 0}, {0.105, 0.297}}}};
  const std::vector<ExpectedCrease> lines = lines_of(shot);
  const ExpectedCrease* line = line_between(lines, {0, low_fold}, {0.210, low_fold});
  ASSERT_TRUE(line);
  EXPECT_TRUE(line->drawn.empty());
  EXPECT_EQ(line->missing.size(), 1u);
}

/// A body with two flaps beside each other, and the three hands that hold it.
Shot two_flaps(const Poses& left, const Poses& right) {
  const Pattern pattern{{{0, 0},
                         {0.12, 0},
                         {0.12, 0.1},
                         {0.061, 0.1},
                         {0.061, 0.06},
                         {0.059, 0.06},
                         {0.059, 0.1},
                         {0, 0.1}},
                        {}};
  return held(pattern, {{{{0.01, 0.01}, {0.11, 0.01}, {0.06, 0.05}}, still},
                        {{{0.01, 0.07}, {0.05, 0.07}, {0.03, 0.09}}, left},
                        {{{0.07, 0.07}, {0.11, 0.07}, {0.09, 0.09}}, right}});
}

TEST(ExpectedCreasesTest, EachOfTwoFlapsOnOneLineIsFoldedByItsOwnHand) {
  const auto turn = [](double angle) { return turning(angle, {0, 0.06}, {1, 0}); };
  for (const double other : {-90 * degrees, 80 * degrees, 120 * degrees}) {
    const std::vector<ExpectedCrease> lines = lines_of(two_flaps(turn(80 * degrees), turn(other)));
    ASSERT_EQ(lines.size(), 2u) << other;
    const ExpectedCrease *left = line_between(lines, {0, 0.06}, {0.059, 0.06}),
                         *right = line_between(lines, {0.061, 0.06}, {0.12, 0.06});
    ASSERT_TRUE(left && right);
    EXPECT_NEAR(std::abs(left->turn.back()), 80 * degrees, 1e-6);
    EXPECT_NEAR(std::abs(right->turn.back()), std::abs(other), 1e-6);
    EXPECT_EQ(left->turn.back() * right->turn.back() > 0, other > 0);
  }
}

TEST(ExpectedCreasesTest, AFlapThatStaysFlatDoesNotKeepTheOneBesideItFromFolding) {
  const std::vector<ExpectedCrease> lines =
      lines_of(two_flaps(turning(90 * degrees, {0, 0.06}, {1, 0}), still));
  ASSERT_EQ(lines.size(), 1u);
  ASSERT_TRUE(line_between(lines, {0, 0.06}, {0.059, 0.06}));
  EXPECT_NEAR(std::abs(lines[0].turn.back()), 90 * degrees, 1e-6);
}

/// A tray with a square bottom and four walls of half its height, which are folded up at once.
Shot tray(double a) {
  const double h = a / 2, n = 0.1 * a, f = 0.9 * a, m = a / 2, o = 0.4 * a, up = 88 * degrees;
  const Pattern pattern{{{0, -h},
                         {a, -h},
                         {a, 0},
                         {a + h, 0},
                         {a + h, a},
                         {a, a},
                         {a, a + h},
                         {0, a + h},
                         {0, a},
                         {-h, a},
                         {-h, 0},
                         {0, 0}},
                        {}};
  return held(pattern, {{{{n, n}, {f, n}, {m, f}}, still},
                        {{{n, -n}, {f, -n}, {m, -o}}, turning(up, {0, 0}, {-1, 0})},
                        {{{n, a + n}, {f, a + n}, {m, a + o}}, turning(up, {0, a}, {1, 0})},
                        {{{-n, n}, {-n, f}, {-o, m}}, turning(up, {0, 0}, {0, 1})},
                        {{{a + n, n}, {a + n, f}, {a + o, m}}, turning(up, {a, 0}, {0, -1})}});
}

TEST(ExpectedCreasesTest, ALineGoesNoFartherAlongTheBorder) {
  // each line goes on along the borders of two other walls; rounding is another for each size
  for (const double a : {0.03, 0.055, 0.06, 0.08, 0.11}) {
    const std::vector<ExpectedCrease> lines = lines_of(tray(a));
    EXPECT_EQ(lines.size(), 4u) << a;
    for (const auto& [p, q] : std::vector<std::pair<Vector2d, Vector2d>>{
             {{0, 0}, {a, 0}}, {{a, 0}, {a, a}}, {{a, a}, {0, a}}, {{0, a}, {0, 0}}})
      EXPECT_TRUE(line_between(lines, p, q, 1e-6)) << a;
  }
}

TEST(ExpectedCreasesTest, ATrayIsFoldedUpByItsHands) {
  Shot shot = tray(0.08);
  add_expected_creases(shot, lines_of(shot));
  AnimateOptions options;
  options.first_frame = first_frame;
  options.last_frame = first_frame + frames - 1;
  options.plasticity = Plasticity::on;
  double handles = 0, edges = 0;  // [m]; [1]
  animate(shot, hybrid(shot.pattern, shot.paper, 120, {}, 0, 0), options,
          [&](const AnimatedFrame& frame) {
            edges = std::max(edges, length_distortion(*frame.sheet).largest);
            for (const HandleFrame& handle : frame.handles)
              handles = std::max(handles, handle.error());
            return true;
          });
  EXPECT_LT(handles, 1e-4);
  EXPECT_LT(edges, 3e-3);
}

TEST(ExpectedCreasesTest, HandlesThatOnlyMoveAlongFoldNothing) {
  const auto by = [](const Vector3d& way) {
    return [=](double s) { return Isometry3d(Eigen::Translation3d(s * way)); };
  };
  EXPECT_TRUE(lines_of(held(a4, {{in_the_middle, still},
                                 {at_the_bottom, by({0, 0.08, 0.03})},
                                 {at_the_top, by({0.01, -0.05, 0.08})}}))
                  .empty());
}

/// A corner of a page that is folded onto a wing, and the wing up with it: two folds that end at
/// the middle of the top border, or `apart` [m] of each other.
std::vector<Plate> half_a_plane(double apart) {
  const Vector2d top(0.105, 0.297), beside(0.105 + apart, 0.297);
  const auto wing = [=](double s) {
    return turned(std::max(0.0, 2 * s - 1) * 70 * degrees, top, {0.105, -0.2535});
  };
  return {{{{0.105, 0.02}, {0.075, 0.1}, {0.135, 0.1}, {0.105, 0.15}}, still},
          {{{0.207, 0.07}, {0.205, 0.13}, {0.19, 0.165}}, wing},
          {{{0.205, 0.237}, {0.195, 0.247}, {0.207, 0.222}}, [=](double s) {
             return wing(s) *
                    turned(std::min(1.0, 2 * s) * 150 * degrees, beside, {0.105 - apart, -0.105});
           }}};
}

TEST(ExpectedCreasesTest, AHandBeyondAnotherFoldFoldsNothingByItself) {
  // the corner turns against the body, too, about a line that crosses the wing
  const std::vector<ExpectedCrease> lines = lines_of(held(a4, half_a_plane(0)));
  EXPECT_EQ(lines.size(), 2U);
  EXPECT_TRUE(line_between(lines, {0.105, 0.297}, {0.210, 0.0435}, 1e-6));
  EXPECT_TRUE(line_between(lines, {0.105, 0.297}, {0.210, 0.192}, 1e-6));
}

TEST(ExpectedCreasesTest, FoldsThatEndBesideEachOtherEndAtOnePoint) {
  for (const double apart : {1e-7, 3e-4, 1e-3, 5e-3}) {
    const std::vector<ExpectedCrease> lines = lines_of(held(a4, half_a_plane(apart)));
    ASSERT_EQ(lines.size(), 2U);
    double nearest = 1;
    for (const Vector2d& p : {lines[0].line.a, lines[0].line.b})
      for (const Vector2d& q : {lines[1].line.a, lines[1].line.b})
        nearest = std::min(nearest, (p - q).norm());
    if (apart < 2e-3)
      EXPECT_EQ(nearest, 0) << apart;
    else
      EXPECT_NEAR(nearest, apart, 1e-6);
  }
}

/// A sheet that is folded in half and has a corner turned down after that, both layers of it, by a
/// line that meets the first fold at this angle. The corner ends 1.8 mm above the rest.
std::vector<Plate> doubled_corner(double angle, bool holds_both) {
  const Vector2d middle(0.074, 0.105), down(-std::cos(angle), -std::sin(angle));
  const auto half = [=](double s) {
    return turned(std::min(1.0, 2 * s) * 177.8 * degrees, {0, middle.y()}, {1, 0});
  };
  const auto corner = [=](double s) {
    const double share = std::max(0.0, 2 * s - 1);
    return Eigen::Translation3d(0, 0, 0.0018 * std::max(0.0, 2 * share - 1)) *
           turned(-share * 170 * degrees, middle, down);
  };
  const double reach = 0.05 * std::tan(angle);  // [m] within the corner
  const auto points = [&](double side) -> std::vector<Vector2d> {
    return {{0.004, middle.y() + side * 0.006},
            {0.004, middle.y() + side * reach},
            {0.045, middle.y() + side * 0.006}};
  };
  std::vector<Plate> plates{{{{0.03, 0.01}, {0.118, 0.01}, {0.09, 0.06}}, still},
                            {{{0.03, 0.2}, {0.118, 0.2}, {0.09, 0.15}}, half},
                            {points(-1), corner}};
  if (holds_both) plates.push_back({points(1), [=](double s) { return corner(s) * half(s); }});
  return plates;
}

TEST(ExpectedCreasesTest, ACornerOfADoubledSheetIsTurnedDownAlongALineAndItsMirrorImage) {
  const Pattern sheet = test::rectangle(0.148, 0.210);
  const Vector2d middle(0.074, 0.105);
  for (const double angle : {45 * degrees, 30 * degrees})
    for (const bool holds_both : {false, true}) {
      const std::vector<ExpectedCrease> lines =
          lines_of(held(sheet, doubled_corner(angle, holds_both)));
      EXPECT_EQ(lines.size(), 3U) << holds_both;
      const double reach = 0.074 * std::tan(angle), near = 1e-3;  // [m] the fold is not quite shut
      const ExpectedCrease *lower = line_between(lines, middle, {0, 0.105 - reach}, near),
                           *upper = line_between(lines, middle, {0, 0.105 + reach}, near);
      EXPECT_TRUE(line_between(lines, {0, 0.105}, {0.148, 0.105}, 1e-6)) << holds_both;
      ASSERT_TRUE(lower && upper) << holds_both;
      EXPECT_NEAR(std::abs(largest_turn(*lower)), std::abs(largest_turn(*upper)), 1e-3);
    }
}

TEST(ExpectedCreasesTest, AHandThatHoldsTheOtherCornerOfADoubledSheetIsNotInTheWay) {
  // straight on beyond the first fold, where the lines do not go, they would cut through the hand
  std::vector<Plate> plates = doubled_corner(45 * degrees, true);
  for (const Vector2d& p : {Vector2d(0.144, 0.006), Vector2d(0.144, 0.05), Vector2d(0.1, 0.006)}) {
    plates[0].points.push_back({p.x(), 0.105 - p.y()});
    plates[1].points.push_back({p.x(), 0.105 + p.y()});
  }
  const std::vector<ExpectedCrease> lines = lines_of(held(test::rectangle(0.148, 0.210), plates));
  EXPECT_EQ(lines.size(), 3U);
  const Vector2d middle(0.074, 0.105);
  EXPECT_TRUE(line_between(lines, middle, {0, 0.031}, 1e-3));
  EXPECT_TRUE(line_between(lines, middle, {0, 0.179}, 1e-3));
}

TEST(ExpectedCreasesTest, ALineAcrossAShutFoldAtARightAngleGoesStraightOn) {
  const double x = 0.05;  // [m]
  std::vector<Plate> plates = doubled_corner(45 * degrees, false);
  plates.pop_back();
  const auto turn = [=](double s) {
    return turned(std::max(0.0, 2 * s - 1) * 165 * degrees, {x, 0}, {0, -1});
  };
  for (Plate& plate : plates)
    for (Vector2d& p : plate.points) p.x() = 0.1 + 0.3 * p.x();
  plates.push_back({{{0.01, 0.02}, {0.03, 0.02}, {0.02, 0.09}}, turn});
  const std::vector<ExpectedCrease> lines = lines_of(held(test::rectangle(0.148, 0.210), plates));
  EXPECT_EQ(lines.size(), 2U);
  EXPECT_TRUE(line_between(lines, {x, 0}, {x, 0.210}, 1e-6));
}

TEST(ExpectedCreasesTest, HandsTurnDownACornerOfADoubledSheet) {
  // where the line went straight on, handles were 90 mm behind
  Shot shot = held(test::rectangle(0.148, 0.210), doubled_corner(45 * degrees, true));
  add_expected_creases(shot, lines_of(shot));
  AnimateOptions options;
  options.last_frame = frames;
  double off = 0, stretch = 0;
  animate(shot, hybrid(shot.pattern, shot.paper, 120, {}, 0, 0), options,
          [&](const AnimatedFrame& frame) {
            for (const HandleFrame& h : frame.handles) off = std::max(off, h.error());
            stretch = std::max(stretch, length_distortion(*frame.sheet).largest);
            return true;
          });
  EXPECT_LT(off, 1e-3);
  EXPECT_LT(stretch, 0.01);
}

/// A sheet that is folded in half and has both of its corners turned down after that, one after the
/// other, by lines that are so far apart where they meet the first fold [m].
Shot doubled_corners(double apart) {
  const double fold_end = 1.0 / 3, middle = 0.105;
  const auto share = [=](double s, double begin) {
    return std::clamp((s - begin) / fold_end, 0.0, 1.0);
  };
  const auto half = [=](double s) {
    return turned(share(s, 0) * 179 * degrees, {0, middle}, {1, 0});
  };
  std::vector<Plate> plates{{{{0.03, 0.01}, {0.118, 0.01}, {0.09, 0.06}}, still},
                            {{{0.03, 0.2}, {0.118, 0.2}, {0.09, 0.15}}, half}};
  for (const double side : {-1.0, 1.0}) {
    const double x = 0.074 + 0.5 * apart * side;
    const auto corner = [=](double s) {
      return Eigen::Translation3d(0, 0, 0.0006) *
             turned(side * share(s, side < 0 ? fold_end : 2 * fold_end) * 170 * degrees,
                    {x, middle}, {side, -1}) *
             Eigen::Translation3d(0, 0, -0.0006);
    };
    const auto points = [=](double y) -> std::vector<Vector2d> {
      return {{x + side * 0.068, middle + y * 0.006},
              {x + side * 0.068, middle + y * 0.05},
              {x + side * 0.03, middle + y * 0.006}};
    };
    plates.push_back({points(-1), corner});
    plates.push_back({points(1), [=](double s) { return corner(s) * half(s); }});
  }
  return held(test::rectangle(0.148, 0.210), plates);
}

TEST(ExpectedCreasesTest, LinesOfTwoCornersThatMeetAtOnePointAreFour) {
  // each is the straight continuation of the one of the other corner in the other layer
  for (const double apart : {0.004, 0.0}) {
    const std::vector<ExpectedCrease> lines = lines_of(doubled_corners(apart));
    EXPECT_EQ(lines.size(), 5U);
    for (const double side : {-1.0, 1.0})
      for (const double y : {-1.0, 1.0})
        EXPECT_TRUE(line_between(lines, {0.074 + 0.5 * apart * side, 0.105},
                                 {0.074 + 0.074 * side, 0.105 + y * (0.074 - 0.5 * apart)}, 1e-3))
            << apart << " " << side << " " << y;
  }
}

TEST(ExpectedCreasesTest, HandsTurnDownBothCornersOfADoubledSheet) {
  // where the extension of the first line counted as a fold, half of the second one was pressed the
  // wrong way, and handles were 50 mm behind
  Shot shot = doubled_corners(0.004);
  add_expected_creases(shot, lines_of(shot));
  AnimateOptions options;
  options.last_frame = frames;
  double off = 0;
  animate(shot, hybrid(shot.pattern, shot.paper, 120, {}, 0, 0), options,
          [&](const AnimatedFrame& frame) {
            for (const HandleFrame& h : frame.handles) off = std::max(off, h.error());
            return true;
          });
  EXPECT_LT(off, 1e-3);
}

TEST(ExpectedCreasesTest, ATurnOfLessThanSixtyDegreesIsNoFold) {
  EXPECT_TRUE(lines_of(held(page, corner(59 * degrees))).empty());
  EXPECT_EQ(lines_of(held(page, corner(61 * degrees))).size(), 1u);
}

TEST(ExpectedCreasesTest, ARowOfHandlesFoldsAgainstAPlateWhereItGoesOnAnArc) {
  const Poses turn = turning(170 * degrees, {0, low_fold}, {-1, 0});
  const std::vector<Vector2d> row{{0, 0}, {0.105, 0}, {0.210, 0}};
  std::vector<Vector2d> plate = row;
  plate.push_back({0.1, 0.03});
  const std::vector<ExpectedCrease> expected =
      lines_of(held(a4, {{in_the_middle, still}, {plate, turn}}));
  ASSERT_EQ(expected.size(), 1u);
  for (const std::vector<Vector2d>& some : {row, {row[0], row[2]}}) {
    const std::vector<ExpectedCrease> lines =
        lines_of(held(a4, {{in_the_middle, still}, {some, turn}}));
    ASSERT_EQ(lines.size(), 1u);
    EXPECT_TRUE(line_between(lines, {0, low_fold}, {0.210, low_fold}));
    for (int f = 0; f < frames; ++f) EXPECT_NEAR(lines[0].turn[f], expected[0].turn[f], 1e-6) << f;
  }
  // a row that comes nearer in the plane of the sheet bows it
  const auto push = [](double s) {
    return Isometry3d(Eigen::Translation3d(Vector3d(0, 0.05 * s, 0)));
  };
  EXPECT_TRUE(lines_of(held(a4, {{in_the_middle, still}, {row, push}})).empty());
  // two rows say nothing of the plane between them
  EXPECT_TRUE(lines_of(held(a4, {{{{0, 0.15}, {0.21, 0.15}}, still}, {row, turn}})).empty());
}

/// A part of the paper, from a clamp on its left to the handles at its right border, bent evenly by
/// this angle.
Vector3d on_an_arc(double angle, double x, double y) {
  const double k = angle / 0.15;  // [1/m]
  return {0.05 + (angle == 0 ? x : std::sin(k * x) / k), y,
          angle == 0 ? 0 : (1 - std::cos(k * x)) / k};
}

/// A clamp, and what holds the end of the sheet while it is rolled up.
Shot rolled_up(double angle, const std::vector<Vector2d>& ends) {
  Shot shot = held(test::rectangle(0.2, 0.1), {{{{0, 0}, {0, 0.1}, {0.05, 0.05}}, still}});
  for (const Vector2d& p : ends) {
    Handle handle = test::bare_handle("end", p, frames);
    for (int f = 0; f < frames; ++f)
      handle.keyed.row(f) = on_an_arc(angle * f / (frames - 1.0), p.x() - 0.05, p.y());
    shot.handles.push_back(handle);
  }
  return shot;
}

TEST(ExpectedCreasesTest, ARowThatRollsTheSheetUpDoesNotFoldIt) {
  for (const double angle : {110 * degrees, 120 * degrees, 180 * degrees, 270 * degrees})
    EXPECT_TRUE(lines_of(rolled_up(angle, {{0.2, 0}, {0.2, 0.1}})).empty()) << angle;
}

TEST(ExpectedCreasesTest, WhetherHandsFoldDoesNotDependOnTheFrameRate) {
  // bowed at first, exact from 35 degrees on
  for (const int rows : {25, 121, 481}) {
    Shot shot = held(test::rectangle(0.2, 0.1), {{{{0, 0}, {0, 0.1}, {0.05, 0.05}}, still}});
    for (const Vector2d& p : {Vector2d(0.2, 0), Vector2d(0.2, 0.1), Vector2d(0.15, 0.05)}) {
      Handle handle = test::bare_handle("flap", p, rows);
      for (int f = 0; f < rows; ++f) {
        const double turn = f / (rows - 1.0) * 178 * degrees,
                     bow = 0.01 * std::max(0.0, 1 - turn / (35 * degrees));
        handle.keyed.row(f) = turned(turn, {0.1, 0}, {0, -1}) * on_sheet(p);
        handle.keyed(f, 0) -= bow;
      }
      shot.handles.push_back(handle);
    }
    EXPECT_EQ(lines_of(shot).size(), 1u) << rows;
  }
}

TEST(ExpectedCreasesTest, AClampThatIsCarriedOverInALoopDoesNotFoldTheSheet) {
  // the paper is bowed all the way, and at its end the clamps lie flat on each other
  const Pattern page = test::rectangle(0.297, 0.210);
  const std::vector<Vector2d> lying{{0, 0}, {0, 0.21}, {0.015, 0}, {0.015, 0.21}},
      carried{{0.297, 0}, {0.297, 0.21}, {0.282, 0}, {0.282, 0.21}};
  const Poses over = [](double s) {
    const double turn = s * 178 * degrees, radius = 0.1485;
    const Vector3d at(radius * (1 + std::cos(turn)), 0, 0.8 * radius * std::sin(turn));
    return Isometry3d(Eigen::Translation3d(at) * Eigen::AngleAxisd(-turn, Vector3d::UnitY()) *
                      Eigen::Translation3d(-0.297, 0, 0));
  };
  EXPECT_TRUE(lines_of(held(page, {{lying, still}, {carried, over}})).empty());
  const Poses fold = [](double s) { return turned(s * 178 * degrees, {0.1485, 0}, {0, -1}); };
  EXPECT_EQ(lines_of(held(page, {{lying, still}, {carried, fold}})).size(), 1u);
}

TEST(ExpectedCreasesTest, ATwistedStripIsNotFolded) {
  const double length = 0.3, width = 0.03;
  const std::vector<Vector2d> left{{0, 0}, {0, width}, {0.02, 0}, {0.02, width}},
      right{{length, 0}, {length, width}, {length - 0.02, 0}, {length - 0.02, width}};
  const auto twist = [=](double angle) { return turned(angle, {0, 0.5 * width}, {1, 0}); };
  const Poses straight = [=](double s) { return twist(s * M_PI); };
  // a Moebius strip: bent to a ring, and twisted by half a turn
  const Poses ring = [=](double s) {
    const double around = 2 * M_PI * s;
    const Vector3d end =
        s == 0 ? Vector3d(length, 0, 0)
               : Vector3d(std::sin(around), 0, 1 - std::cos(around)) * length / around;
    return Isometry3d(Eigen::Translation3d(end) * Eigen::AngleAxisd(-around, Vector3d::UnitY()) *
                      twist(s * M_PI) * Eigen::Translation3d(-length, 0, 0));
  };
  for (const Poses& way : {straight, ring})
    EXPECT_TRUE(
        lines_of(held(test::rectangle(length, width), {{left, still}, {right, way}})).empty());
}

/// Handles all over the sheet, each on a way of its own towards its middle.
Shot crumpled(unsigned seed, int handles) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal;
  Shot shot = test::blank_shot(a4);
  for (int h = 0; h < handles; ++h) {
    const double u = uniform(random), v = uniform(random);
    const Vector2d p(0.210 * u, 0.297 * v);
    const double x = normal(random), y = normal(random), z = normal(random);
    const Vector3d end = Vector3d(0.105, 0.15, 0.05) + 0.02 * Vector3d(x, y, z);
    hold(shot, {{p}, [=](double s) {
                  return Isometry3d(Eigen::Translation3d(s * (end - on_sheet(p))));
                }});
  }
  return shot;
}

TEST(ExpectedCreasesTest, HandlesThatCrumpleASheetFoldNoLine) {
  for (unsigned seed = 1; seed <= 10; ++seed)
    for (const int handles : {4, 12, 40})
      EXPECT_TRUE(lines_of(crumpled(seed, handles)).empty()) << seed << " " << handles;
}

TEST(ExpectedCreasesTest, HandsThatTurnAsTheyLikeFoldNoLine) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::vector<Plate> plates{{in_the_middle, still}};
    for (const auto& points : {at_the_bottom, at_the_top}) {
      Vector3d axis, way;
      for (int i = 0; i < 3; ++i) axis[i] = normal(random), way[i] = 0.03 * normal(random);
      plates.push_back({points, [=](double s) {
                          return Isometry3d(
                              Eigen::Translation3d(s * way + on_sheet(points[1])) *
                              Eigen::AngleAxisd(s * 150 * degrees, axis.normalized()) *
                              Eigen::Translation3d(-on_sheet(points[1])));
                        }});
    }
    EXPECT_TRUE(lines_of(held(a4, plates)).empty()) << seed;
  }
}

TEST(ExpectedCreasesTest, HandlesThatLetGoBeforeTheyTurnFoldNothing) {
  std::vector<Plate> plates = corner(0);
  plates[1].pose = [](double s) {
    return turned(std::max(0.0, 2 * s - 1) * 175 * degrees, {0.105, 0.105}, {1, -1});
  };
  Shot shot = held(page, plates);
  ASSERT_EQ(lines_of(shot).size(), 1u);
  for (std::size_t h = on_the_page.size(); h < shot.handles.size(); ++h)
    shot.handles[h].release_frame = first_frame + 12;
  EXPECT_TRUE(lines_of(shot).empty());
  // let go on the way, they have folded it; from then on nobody knows the turn
  for (Handle& handle : shot.handles) handle.release_frame = first_frame + 22;
  const std::vector<ExpectedCrease> lines = lines_of(shot);
  ASSERT_EQ(lines.size(), 1u);
  for (int f = 0; f < frames; ++f) EXPECT_EQ(std::isnan(lines[0].turn[f]), f >= 22) << f;
}

/// Two hands that fold the page along its middle and rest, until from frame 18 on handles of one of
/// them, or of both, come together by 5 mm.
Shot folded_and_squeezed(bool both) {
  const Poses turns = [](double s) {
    return turned(std::min(1.0, 2 * s) * 168 * degrees, {0.075, 0}, {0, -1});
  };
  Shot shot = held(page, {{{{0.01, 0.01}, {0.01, 0.14}, {0.06, 0.07}}, still},
                          {{{0.14, 0.01}, {0.14, 0.14}, {0.09, 0.07}}, turns}});
  for (std::size_t h = both ? 0 : 3; h < 6; ++h)
    for (int f = 18; f < frames; ++f)
      shot.handles[h].keyed(f, 1) +=
          (f - 17) / (frames - 18.0) * std::copysign(0.005, 0.075 - shot.handles[h].pattern.y());
  return shot;
}

TEST(ExpectedCreasesTest, HandsThatPartAfterTheyHaveFoldedAreHandsUntilThen) {
  for (const bool both : {false, true}) {
    const std::vector<ExpectedCrease> lines = lines_of(folded_and_squeezed(both));
    ASSERT_EQ(lines.size(), 1u) << both;
    EXPECT_TRUE(line_between(lines, {0.075, 0}, {0.075, 0.15}, 1e-6)) << both;
    EXPECT_NEAR(std::abs(largest_turn(lines[0])), 168 * degrees, 1e-9) << both;
    for (int f = 0; f < frames; ++f) EXPECT_EQ(std::isnan(lines[0].turn[f]), f >= 18) << f;
  }
}

TEST(ExpectedCreasesTest, HandsThatFoldAcrossALineThatOthersHaveOpenedAgainDoNotHideEachOther) {
  // a square is folded along one diagonal and opened, then other hands fold it along the other one
  const double w = 0.15;
  const Vector2d middle(w / 2, w / 2), up(1, 1), down(1, -1);
  const double open_again = 0.5;  // of the time
  const auto folded = [&](const Vector2d& direction, double begin) -> Poses {
    return [=](double s) {
      const double share = std::clamp((s - begin) / open_again, 0.0, 1.0);
      return turned((1 - std::abs(2 * share - 1)) * 168 * degrees, middle, direction);
    };
  };
  const std::vector<Plate> first{{{{0.01, 0.01}, {0.07, 0.01}, {0.01, 0.07}}, still},
                                 {{{0.14, 0.14}, {0.08, 0.14}, {0.14, 0.08}}, folded(down, 0)}},
      second{{{{0.14, 0.01}, {0.08, 0.01}, {0.14, 0.07}}, still},
             {{{0.01, 0.14}, {0.07, 0.14}, {0.01, 0.08}}, folded(up, open_again)}};
  Shot shot = held(test::rectangle(w, w), first);
  for (Handle& handle : shot.handles) handle.release_frame = first_frame + 13;
  const std::size_t of_first = shot.handles.size();
  for (const Plate& plate : second) hold(shot, plate);
  // for two frames all four hands hold the flat sheet
  for (std::size_t h = of_first; h < shot.handles.size(); ++h)
    shot.handles[h].grab_frame = first_frame + 11;
  const std::vector<ExpectedCrease> lines = lines_of(shot);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_TRUE(line_between(lines, {0, w}, {w, 0}));
  EXPECT_TRUE(line_between(lines, {0, 0}, {w, w}));
  // a hand that lies across a line while it is folded is in the way of it
  for (std::size_t h = of_first; h < shot.handles.size(); ++h)
    shot.handles[h].grab_frame = first_frame + 1;
  EXPECT_FALSE(line_between(lines_of(shot), {0, w}, {w, 0}));
}

TEST(ExpectedCreasesTest, HandlesThatTakeHoldOfAMovedSheetAreNoClamp) {
  Shot shot = held(page, corner(175 * degrees));
  for (std::size_t h = on_the_page.size(); h < shot.handles.size(); ++h) {
    shot.handles[h].mode = HandleMode::relative;
    shot.handles[h].grab_frame = first_frame + 2;
    for (const int row : {1, 2}) shot.handles[h].keyed.row(row) = shot.handles[h].keyed.row(0);
  }
  EXPECT_EQ(lines_of(shot).size(), 1u);
  shot.handles[0].keyed(1, 2) += 0.01;
  EXPECT_TRUE(lines_of(shot).empty());
}

}  // namespace
}  // namespace paperbake
