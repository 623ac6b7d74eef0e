#include "baker/job/plan.h"

#include "baker/job/input_hash.h"
#include "baker/job/method_choice.h"
#include "baker/job/plan_warnings.h"
#include "core/model/error.h"
#include "tests/core/test_meshes.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

namespace paperbake {
namespace {

/// Everything that a frame hands on, except times.
struct Seen {
  Sheet sheet;
  std::vector<std::pair<Vector2d, Vector2d>> rulings;
  int births;
  std::string state;  // what the next frame depends on, bit for bit
};

std::vector<Seen> frames_of(const BakePlan& plan) {
  std::vector<Seen> seen;
  simulate(plan, {plan.animation}, 1, [&](const AnimatedFrame& f) {
    seen.push_back({*f.sheet, f.parts.rulings, f.statistics.new_singular, f.state()});
    return true;
  });
  return seen;
}

BakePlan plan_of(const char* scene, const char* method, int last_frame) {
  BakeSettings settings;
  settings.scene = std::string(PAPERBAKE_SAMPLES "/") + scene;
  settings.method = method;
  settings.frames = FrameSpan{1, last_frame, 1};
  return plan_bake(settings);
}

int births(const std::vector<Seen>& frames) {
  int sum = 0;
  for (const Seen& f : frames) sum += f.births;
  return sum;
}

void expect_same(const std::vector<Seen>& once, const std::vector<Seen>& again) {
  ASSERT_EQ(once.size(), again.size());
  for (std::size_t k = 0; k < once.size(); ++k) {
    ASSERT_EQ(once[k].state, again[k].state) << "frame " << k + 1;
    ASSERT_EQ(once[k].sheet.x.rows(), again[k].sheet.x.rows()) << "frame " << k + 1;
    EXPECT_EQ(once[k].sheet.x, again[k].sheet.x) << "frame " << k + 1;
    EXPECT_EQ(once[k].rulings, again[k].rulings) << "frame " << k + 1;
    EXPECT_EQ(once[k].births, again[k].births) << "frame " << k + 1;
  }
}

TEST(PlanTest, ASheetAsNarrowAsItIsThickIsQuestioned) {
  BakePlan plan = plan_of("S4_crumple.glb", "hybrid", 2);
  plan.warnings.clear();
  warn_of_doubtful_values(plan);
  EXPECT_TRUE(plan.warnings.empty()) << plan.warnings.front();
  plan.shots[0].pattern.outline = {{0, 0}, {1, 0}, {1, 1e-4}, {0, 1e-4}};
  warn_of_doubtful_values(plan);
  ASSERT_EQ(plan.warnings.size(), 1u);
  EXPECT_NE(plan.warnings[0].find("0.1 mm wide, and 0.09 mm thick"), std::string::npos)
      << plan.warnings[0];
}

TEST(PlanTest, FramesBeforeTheSceneAreSkippedAndNoneBehindTheRangeIsBaked) {
  const auto frames_of = [](const FrameSpan& asked) {
    BakeSettings settings;
    settings.scene = PAPERBAKE_SAMPLES "/S1_push.glb";
    settings.frames = asked;
    return plan_bake(settings).frames;
  };
  const FrameSpan some = frames_of({-7, 8, 4});
  EXPECT_EQ(some.first, 1);
  EXPECT_EQ(some.last, 5);
  try {
    frames_of({0, 5, 20});
    FAIL() << "frames 0, 20, ...: none";
  } catch (const Error& error) {
    EXPECT_EQ(error.code, ErrorCode::command);
    EXPECT_EQ(error.place, "--frames");
  }
}

TEST(PlanTest, ARangeThatBeginsBehindTheShotIsTold) {
  const auto told = [](const FrameSpan& asked) {
    BakeSettings settings;
    settings.scene = PAPERBAKE_SAMPLES "/S1_push.glb";
    settings.frames = asked;
    const std::vector<std::string> warnings = plan_bake(settings).warnings;
    return std::count_if(warnings.begin(), warnings.end(), [](const std::string& warning) {
      return warning.find("after the end of the shot: its last frame is 60") != std::string::npos;
    });
  };
  EXPECT_EQ(told({61, 70, 1}), 1);
  EXPECT_EQ(told({60, 70, 1}), 0);
}

TEST(PlanTest, GivesTheSameCrumpleEveryTimeItIsSimulated) {
  const BakePlan plan = plan_of("S4_crumple.glb", "hybrid", 32);
  const std::vector<Seen> once = frames_of(plan);
  ASSERT_GE(births(once), 3);
  expect_same(once, frames_of(plan));
}

TEST(PlanTest, GivesTheSameRulingsEveryTimeItIsSimulated) {
  const BakePlan plan = plan_of("S2_moebius.glb", "hybrid", 72);
  const std::vector<Seen> once = frames_of(plan);
  ASSERT_GT(births(once), 0);
  ASSERT_TRUE(
      std::any_of(once.begin(), once.end(), [](const Seen& f) { return !f.rulings.empty(); }));
  expect_same(once, frames_of(plan));
}

TEST(PlanTest, GivesTheSameAdaptiveMeshesEveryTimeItIsSimulated) {
  const BakePlan plan = plan_of("S1_push.glb", "adaptive", 24);
  const std::vector<Seen> once = frames_of(plan);
  ASSERT_NE(once.front().sheet.triangles.rows(), once.back().sheet.triangles.rows());
  expect_same(once, frames_of(plan));
}

TEST(PlanTest, AnotherPrintOnASheetIsAnotherJobOfTheSameSimulation) {
  BakeSettings settings;
  settings.scene = PAPERBAKE_SAMPLES "/S4_crumple.glb";
  const auto plan = [&](const std::function<void(AuthoredSurface&)>& change) {
    Scene scene = read_scene(settings.scene, {});
    change(scene.sheets.at(0).authored);
    return plan_bake(settings, std::move(scene));
  };
  const BakePlan was = plan([](AuthoredSurface&) {}), again = plan([](AuthoredSurface&) {});
  EXPECT_EQ(was.job_hash, again.job_hash);
  for (const auto& change : std::vector<std::function<void(AuthoredSurface&)>>{
           [](AuthoredSurface& a) { a.attributes.at(0).values(0, 0) += 0.25; },
           [](AuthoredSurface& a) { a.attributes.at(0).name = "Print"; },
           [](AuthoredSurface& a) {
             a.attributes.push_back(
                 {"Wear", AttributeKind::number, AttributeValues::Zero(3 * a.triangles.rows(), 1)});
           },
           [](AuthoredSurface& a) { a.properties["title"] = std::string("Daily"); },
           [](AuthoredSurface& a) {
             a.materials = {"print"};
             a.material_of.assign(a.triangles.rows(), 0);
           }}) {
    const BakePlan other = plan(change);
    EXPECT_NE(other.job_hash, was.job_hash);
    EXPECT_EQ(other.simulation_hash, was.simulation_hash) << "what is simulated is used again";
  }
}

TEST(PlanTest, WhatHandsPressCountsInItsFrame) {
  // it may depend on later keys
  const BakePlan was = plan_of("F1_letter.glb", "hybrid", 100);
  BakePlan other = was;
  const int first = was.animation.first_frame;
  other.shots.at(0).hands.at(0).turn.at(40) += 1e-3;
  hash_inputs(other);
  for (const int row : {39, 40, 41})
    EXPECT_EQ(frame_input_hash("", other, first + row) == frame_input_hash("", was, first + row),
              row != 40)
        << row;
}

TEST(PlanTest, EveryKeyOfTheSceneCountsForWhatLooksAheadToIt) {
  // as the decision between attempts at a shot does: a later take under the same name is another
  const BakePlan was = plan_of("S14_hands.glb", "hybrid", 10);
  EXPECT_EQ(scene_input_hash(plan_of("S14_hands.glb", "hybrid", 10)), scene_input_hash(was));
  for (const int row : {5, 50}) {
    BakePlan later = was;
    ASSERT_LT(row, later.shots.at(0).handles.at(0).keyed.rows());
    later.shots[0].handles[0].keyed(row, 2) += 1e-6;
    hash_inputs(later);
    EXPECT_NE(scene_input_hash(later), scene_input_hash(was)) << row;
  }
}

TEST(PlanTest, SheetsThatPassThroughEachOtherInTheFirstFrameAreTold) {
  BakePlan plan;
  plan.shots.resize(2);
  for (Shot& shot : plan.shots) {
    shot.pattern = test::rectangle(0.1, 0.1);
    shot.start = test::hex_sheet(0.1, 0.1, 20);
  }
  plan.shots[0].sheet_name = "paper";
  plan.shots[1].sheet_name = "letter";
  Points3& x = plan.shots[1].start.x;
  x.col(2).setConstant(0.001);
  warn_of_sheets_in_each_other(plan);
  EXPECT_TRUE(plan.warnings.empty()) << "one lies on the other";
  x.col(2).setConstant(2e-5);
  warn_of_sheets_in_each_other(plan);
  ASSERT_EQ(plan.warnings.size(), 1u);
  EXPECT_EQ(plan.warnings[0].rfind("The sheets \"paper\" and \"letter\" lie 0.02 mm from each", 0),
            0u)
      << plan.warnings[0];
  ASSERT_EQ(plan.start_faults.size(), 1u);
  EXPECT_EQ(plan.start_faults[0].sheets, (std::vector<std::string>{"paper", "letter"}));
  plan.warnings.clear();
  x.col(2) = x.col(0).array() - 0.043;
  x.col(1).array() += 0.0013;  // edges do not meet edges
  warn_of_sheets_in_each_other(plan);
  ASSERT_EQ(plan.warnings.size(), 1u);
  EXPECT_EQ(plan.warnings[0].rfind("The sheets \"paper\" and \"letter\" pass through", 0), 0u);
}

TEST(Plan, AStripBeginsWithTwoRowsOfTrianglesUnlessANumberIsAskedFor) {
  const Pattern page = test::rectangle(0.2, 0.3), strip = test::rectangle(1, 0.03);
  BakeSettings settings;
  EXPECT_EQ(first_triangles(settings, page), 120);
  const int in_two_rows = first_triangles(settings, strip);
  // each is as high as half the strip: 15 mm x 17.3 mm / 2
  EXPECT_NEAR(in_two_rows, 1 * 0.03 / (0.015 * 0.0173 / 2), 2);
  settings.base_triangles *= 4;  // as other attempts and an accuracy have it
  EXPECT_EQ(first_triangles(settings, page), 480);
  EXPECT_NEAR(first_triangles(settings, strip), 4 * in_two_rows, 4);
  EXPECT_EQ(first_triangles(settings, test::rectangle(1, 0.001)), 2000) << "no more than that";
  settings.base_triangles = 60;
  settings.given["base_triangles"] = {"60", Origin::command};
  EXPECT_EQ(first_triangles(settings, strip), 60);
}

TEST(Plan, TheWorstImpossiblePairOfAllSheetsComesFirst) {
  BakePlan plan;
  for (const double over : {0.01, 0.03, 0.02}) {
    Shot shot = test::blank_shot(test::rectangle(0.1, 0.1));
    shot.sheet_name = "paper." + std::to_string(plan.shots.size());
    shot.handles = {test::bare_handle("handle.left", {0, 0}, 3),
                    test::bare_handle("handle.right", {0.1, 0}, 3)};
    shot.handles[1].keyed.col(0).array() += over;
    plan.shots.push_back(shot);
  }
  plan.animation.first_frame = 1;
  plan.animation.last_frame = 3;
  find_impossible_handles({}, plan);
  std::vector<std::string> sheets;
  for (const UnreachablePairOfSheet& pair : plan.impossible) sheets.push_back(pair.sheet);
  EXPECT_EQ(sheets, (std::vector<std::string>{"paper.1", "paper.2", "paper.0"}));
}

TEST(Plan, HandlesThatAreSlightlyTooFarApartAreAWarning) {
  const auto planned = [](double length, double over) {
    BakePlan plan;
    Shot shot = test::blank_shot(test::rectangle(0.1, 0.1));
    shot.sheet_name = "paper";
    shot.handles = {test::bare_handle("handle.left", {0, 0}, 3),
                    test::bare_handle("handle.right", {length, 0}, 3)};
    shot.handles[1].keyed.col(0).array() += over;
    plan.shots = {shot};
    plan.animation.first_frame = 1;
    plan.animation.last_frame = 3;
    find_impossible_handles({}, plan);
    return std::pair(plan.impossible.size(), plan.warnings.size());
  };
  const std::pair<std::size_t, std::size_t> nothing{0, 0}, warned{0, 1}, impossible{1, 0};
  EXPECT_EQ(planned(0.1, 2e-5), nothing) << "nobody sees it";
  EXPECT_EQ(planned(0.1, 9e-4), warned);
  EXPECT_EQ(planned(0.1, 1.1e-3), impossible) << "more than a handle may be off";
  EXPECT_EQ(planned(0.02, 3e-4), warned);
  EXPECT_EQ(planned(0.02, 5e-4), impossible) << "more than 2 % of 20 mm";
}

}  // namespace
}  // namespace paperbake
