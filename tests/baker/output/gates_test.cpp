// The sentences about gates: the worst frame, its place, and which other frames miss it.

#include "baker/output/gates.h"

#include "tests/core/collider_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace paperbake {
namespace {

FrameRecord rendered(int frame) {
  FrameRecord record;
  record.frame = frame;
  record.sheet = "paper";
  record.statistics.render.emplace();
  return record;
}

std::vector<std::string> sentences(const std::vector<MissedGate>& missed) {
  std::vector<std::string> all;
  for (const MissedGate& m : missed) all.push_back(m.sentence);
  return all;
}

TEST(Gates, ARenderedEdgeThatIsOffIsNamedWithItsPlaceThoughTheSimulatedOnesAreGood) {
  std::vector<FrameRecord> frames{rendered(81), rendered(82), rendered(83), rendered(84)};
  EXPECT_TRUE(missed_gates({}, frames, {}).empty());
  frames[1].statistics.render->stretch_max = 0.74;
  frames[1].worst.stretch_at << 0.0312, 0.1184;
  EXPECT_EQ(
      sentences(missed_gates({}, frames, {})),
      std::vector<std::string>{"Frame 82: an edge of the rendered mesh is off by 74.00 %, more "
                               "than 5 %, at (31.2, 118.4) mm of the pattern."});
  frames[2].statistics.render->stretch_max = 0.06;
  EXPECT_NE(missed_gates({}, frames, {}).at(0).sentence.find("Frame 83 misses this gate, too."),
            std::string::npos);
  frames[3].statistics.render->stretch_max = 0.06;
  EXPECT_NE(missed_gates({}, frames, {})
                .at(0)
                .sentence.find("2 more frames from 83 to 84 miss this gate."),
            std::string::npos);
}

TEST(Gates, TheMeanStretchOfTheRenderedMeshIsOne) {
  std::vector<FrameRecord> frames{rendered(3)};
  frames[0].statistics.render->stretch_mean = 0.021;
  EXPECT_EQ(sentences(missed_gates({}, frames, {})),
            std::vector<std::string>{
                "Frame 3: mean stretch of the rendered mesh 2.10 %, more than 2 %."});
}

TEST(Gates, ASheetInsideAColliderByMoreThanItsThicknessMissesOne) {
  std::vector<FrameRecord> frames{rendered(5)};
  frames[0].statistics.inside = 0.99e-4;
  EXPECT_TRUE(missed_gates({}, frames, {}).empty());
  frames[0].statistics.inside = 9.561e-3;
  frames[0].worst.inside_of = "collider.top";
  frames[0].worst.inside_at << 0.075, 0.07;
  EXPECT_EQ(
      sentences(missed_gates({}, frames, {})),
      std::vector<std::string>{"Frame 5: the sheet is 9.56 mm inside the collider "
                               "\"collider.top\", more than 0.1 mm, at (75.0, 70.0) mm of the "
                               "pattern."});
}

TEST(Gates, ACrossingOfTheRenderMeshIsOneThatIsMissed) {
  FrameRecord record;
  record.frame = 7;
  record.statistics.render.emplace().kept_apart = true;
  EXPECT_TRUE(missed_gates({}, {record}, {}).empty());
  record.statistics.render->crossings = 3;
  EXPECT_EQ(
      sentences(missed_gates({}, {record}, {})),
      std::vector<std::string>{"Frame 7: 3 pairs of rendered triangles pass through each other."});
}

TEST(Gates, ACrossingOfTwoSheetsIsOneThatIsMissedAsSimulatedAndAsRendered) {
  FrameRecord record;
  record.frame = 7;
  record.statistics.render.emplace().crossings_with_others = 5;
  const std::string rendered =
      "Frame 7: 5 pairs of rendered triangles of two sheets pass through each other.";
  EXPECT_EQ(sentences(missed_gates({}, {record}, {})), std::vector<std::string>{rendered});
  FrameRecord other = record;  // the sheet that the first one passes through
  other.statistics.render->crossings_with_others = 0;
  other.statistics.crossings_with_others = 2;
  EXPECT_EQ(sentences(missed_gates({}, {record, other}, {})),
            (std::vector<std::string>{
                "Frame 7: 2 pairs of triangles of two sheets pass through each other.", rendered}));
}

TEST(Gates, FramesThatWereNotSolvedAreToldAlsoWhereNoGateIsMissed) {
  std::vector<FrameRecord> frames(4);
  for (int f = 0; f < 4; ++f) frames[f].frame = 5 + f;
  EXPECT_EQ(describe_unsolved(frames), "");
  frames[1].step_unsolved = frames[3].step_unsolved = true;
  EXPECT_TRUE(missed_gates({}, frames, {}).empty());
  EXPECT_EQ(describe_unsolved(frames),
            "In 2 frames from 6 to 8 the sheet stands still because the step was not solved: look "
            "at what it meets there.");
}

TEST(Gates, FramesThatEndBeforeThePaperRestsAreTold) {
  std::vector<FrameRecord> frames(12);  // 5 to 10 of two sheets
  for (int f = 0; f < 12; ++f) {
    frames[f].frame = 5 + f / 2;
    frames[f].sheet = f % 2 == 0 ? "A" : "B";
  }
  const auto unsettle = [&](int f) { frames[f].statistics.converged = false; };
  EXPECT_EQ(describe_unsettled(frames), "");
  for (const int f : {0, 3, 6}) unsettle(f);
  EXPECT_EQ(describe_unsettled(frames), "") << "no sheet in two frames one after the other";
  for (const int f : {8, 10}) unsettle(f);
  EXPECT_EQ(describe_unsettled(frames),
            "In 3 frames from 8 to 10 the solver ended before the paper had come to rest, as it "
            "does where paper snaps: look whether it moves there as it should.");
  frames[8].step_unsolved = true;  // told as one that stands still
  EXPECT_EQ(describe_unsettled(frames), "");
  frames[8].step_unsolved = false;
  frames[4].statistics.singular = 1;
  EXPECT_EQ(describe_unsettled(frames), "") << "crumpled paper snaps";
}

TEST(Gates, OfSeveralSheetsTheSentenceNamesTheOne) {
  BakePlan plan;
  plan.shots.resize(2);
  std::vector<FrameRecord> frames{rendered(5), rendered(5)};
  frames[1].sheet = "paper.B";
  frames[1].statistics.render->stretch_max = 0.1;
  EXPECT_EQ(
      missed_gates({}, frames, plan).at(0).sentence.rfind("Frame 5, sheet \"paper.B\": an edge", 0),
      0u);
}

TEST(Gates, WhatIsGoodIsToldOfAllThatNoMissedGateIsAbout) {
  std::vector<FrameRecord> frames{rendered(5)};
  frames[0].statistics.render->stretch_mean = 3e-4;
  frames[0].statistics.handle_error_max = 2e-5;
  const std::vector<std::string> all = good_news(frames, {});
  ASSERT_EQ(all.size(), 3u);
  EXPECT_NE(all[0].find("0.03 % on average"), std::string::npos) << all[0];
  EXPECT_NE(all[1].find("to 0.02 mm"), std::string::npos) << all[1];
  frames[0].statistics.render->stretch_max = 0.2;
  const std::vector<MissedGate> missed = missed_gates({}, frames, {});
  const std::vector<std::string> rest = good_news(frames, missed);
  ASSERT_EQ(missed.size(), 1u);
  EXPECT_EQ(rest, std::vector<std::string>(all.begin() + 1, all.end()));
  EXPECT_NE(missed[0].advice.find("--mesh simulation"), std::string::npos)
      << "only the render mesh is at fault: " << missed[0].advice;
}

TEST(Gates, WhereOnlyTheRenderMeshIsAtFaultAllSentencesSaySo) {
  std::vector<FrameRecord> frames{rendered(5), rendered(6)};
  frames[0].statistics.render->stretch_mean = 0.05;
  for (FrameRecord& f : frames) f.statistics.render->stretch_max = 0.2;
  BakePlan plan;
  plan.start_faults = {{{"paper"}, "The sheet begins in a collider."}};
  const std::vector<MissedGate> missed = missed_gates({}, frames, plan);
  ASSERT_EQ(missed.size(), 2u);
  EXPECT_NE(missed[0].advice.find("--mesh simulation"), std::string::npos) << missed[0].advice;
  EXPECT_TRUE(missed[1].advice.empty());
  for (const MissedGate& m : missed)
    EXPECT_EQ(m.sentence.find("may be the cause"), std::string::npos) << m.sentence;
}

TEST(Gates, WhatIsToBeMovedMoreSlowlyIsWhatMoves) {
  FrameRecord bad = rendered(5);
  bad.statistics.stretch_max = 0.1;
  bad.statistics.crossings = 2;
  BakePlan plan;
  plan.shots.resize(1);
  const auto all_say = [&](const char* what) {
    const std::vector<MissedGate> missed = missed_gates({}, {bad}, plan);
    return missed.size() == 2 && std::all_of(missed.begin(), missed.end(), [&](const auto& m) {
             return m.advice.find(what) != std::string::npos;
           });
  };
  ColliderMesh table = test::ground();
  table.frames.own().assign(2, table.x);
  plan.shots[0].colliders = std::make_shared<const Colliders>(Colliders{Collider(table)});
  EXPECT_TRUE(all_say("ove the colliders more slowly"));
  plan.shots[0].handles.resize(1);
  EXPECT_TRUE(all_say("ove the handles more slowly"));
}

TEST(Gates, TheOneThatIsMissedInMostFramesIsToldFirst) {
  std::vector<FrameRecord> frames{rendered(5), rendered(6), rendered(7)};
  frames[0].statistics.render->stretch_max = 0.1;
  for (int k : {1, 2}) frames[k].statistics.handle_error_max = 0.01;
  const std::vector<MissedGate> missed = missed_gates({}, frames, {});
  ASSERT_EQ(missed.size(), 2u);
  EXPECT_EQ(missed[0].gate, Gate::handles);
  EXPECT_EQ(missed[0].frames, 2);
  EXPECT_EQ(missed[1].frames, 1);
}

TEST(Gates, AHandleThatIsOffIsToldWithTheCauseThatIsKnown) {
  BakePlan plan;
  plan.impossible = {{"paper", {"handle.a", "handle.b", 7, 6, 8, 0.2, 0.1}}};
  std::vector<FrameRecord> frames{rendered(7), rendered(9), rendered(10)};
  for (FrameRecord& f : frames) {
    f.jammed = {{"handle.b", 30}};
    f.statistics.touching = 2;
  }
  frames[0].statistics.handle_error_max = 0.03;
  EXPECT_NE(missed_gates({}, frames, plan)
                .at(0)
                .sentence.find("(\"handle.b\" is keyed beyond the reach of the paper)."),
            std::string::npos);
  EXPECT_TRUE(missed_gates({}, frames, plan).at(0).advice.empty()) << "that of the reach counts";
  frames[1].statistics.handle_error_max = 0.04;
  for (const int k : {1, 2}) frames[k].step_unsolved = true;
  const std::string sentence = missed_gates({}, frames, plan).at(0).sentence;
  EXPECT_NE(sentence.find("(\"handle.b\" is jammed; the sheet touches itself)"), std::string::npos)
      << "in that frame it is within reach: " << sentence;
  frames[1].statistics.touching = 0;
  EXPECT_NE(missed_gates({}, frames, plan).at(0).sentence.find("though nothing touches"),
            std::string::npos);
  plan.start_faults = {
      {{"paper"}, "The sheet \"paper\" begins 10.00 mm deep in the collider \"c\"."}};
  const std::string from_the_start = missed_gates({}, frames, plan).at(0).sentence;
  EXPECT_EQ(from_the_start.find("though nothing touches"), std::string::npos) << from_the_start;
  EXPECT_NE(from_the_start.find("This may be the cause: The sheet \"paper\" begins 10.00 mm deep"),
            std::string::npos)
      << from_the_start;
  EXPECT_NE(sentence.find("In 2 frames from 9 to 10 the sheet stands still because the step was "
                          "not solved"),
            std::string::npos)
      << sentence;
}

TEST(Gates, PaperBeyondAHandleThatLiftsItByAsMuchIsTold) {
  FrameRecord f = rendered(7);
  f.statistics.handle_error_max = 3.4e-3;
  f.statistics.on_colliders = 5;
  f.jammed = {{"handle.spine", 3.4}};
  const auto says = [&](double from_edge) {
    BakePlan plan;
    plan.shots.emplace_back();
    plan.shots[0].sheet_name = f.sheet;
    plan.shots[0].pattern.outline = {{0, 0}, {0.15, 0}, {0.15, 0.2}, {0, 0.2}};
    plan.shots[0].handles = {{"handle.spine", {from_edge, 0.1}, Points3::Zero(1, 3)}};
    return missed_gates({}, {f}, plan).at(0).advice;
  };
  EXPECT_EQ(says(3e-3).find("If the sheet turns about \"handle.spine\" there, the 3.0 mm of paper"),
            0u)
      << says(3e-3);
  for (const double from_edge : {0.0, 1e-3, 2e-2, 0.07})
    EXPECT_EQ(says(from_edge).find("Something is in the way"), 0u)
        << from_edge << ": paper of another size does not lift a handle by 3.4 mm";
}

TEST(Gates, AFaultOfTheSheetThatMissesTheGateIsToldFirst) {
  FrameRecord bad = rendered(5);
  bad.sheet = "paper.b";
  bad.statistics.crossings_with_others = 3;
  BakePlan plan;
  plan.start_faults = {{{"paper.a"}, "It begins in a table."},
                       {{"paper.c", "paper.b"}, "They lie on each other."}};
  const std::string sentence = missed_gates({}, {bad}, plan).at(0).sentence;
  EXPECT_NE(sentence.find("This may be the cause: They lie on each other. 1 more fault is told"),
            std::string::npos)
      << sentence;
  bad.sheet = "paper.d";
  EXPECT_NE(missed_gates({}, {bad}, plan).at(0).sentence.find("cause: It begins in a table."),
            std::string::npos);
}

TEST(Gates, EveryMissedGateHasAnAdvice) {
  FrameRecord bad = rendered(5);
  bad.statistics.stretch_mean = bad.statistics.stretch_max = bad.statistics.inside = 1;
  bad.statistics.render->stretch_mean = bad.statistics.render->stretch_max = 1;
  bad.statistics.handle_error_max = 1;
  bad.statistics.crossings = bad.statistics.render->crossings = 3;
  bad.statistics.render->crossings_with_others = 3;
  bad.jammed = {{"handle.a", 2}, {"handle.b", 9}};
  bad.statistics.touching = 1;
  BakePlan plan;
  plan.impossible.resize(1);
  const std::vector<MissedGate> missed = missed_gates({}, {bad}, plan);
  EXPECT_EQ(missed.size(), 10u);
  std::set<Gate> advised;
  for (const MissedGate& m : missed)
    EXPECT_EQ(m.advice.empty(), !advised.insert(m.gate).second)
        << "each advice is given once: " << m.sentence;
  EXPECT_EQ(with_advice(missed)[0], missed[0].sentence + " " + missed[0].advice);
  EXPECT_TRUE(good_news({bad}, missed).empty());
  EXPECT_TRUE(std::any_of(missed.begin(), missed.end(), [](const MissedGate& m) {
    return m.sentence.find("(\"handle.b\" is jammed; ") != std::string::npos;
  }));
}

TEST(Gates, WhatPullsASheetOffAHandleIsTold) {
  FrameRecord bad = rendered(5);
  bad.statistics.handle_error_max = 0.039;
  bad.jammed = {{"handle.post", 39}};
  const auto says = [&](const char* what) {
    return missed_gates({}, {bad}, {})[0].sentence.find(what) != std::string::npos;
  };
  EXPECT_TRUE(says("pushes back harder than a hand"));
  bad.statistics.inertia = true;
  EXPECT_TRUE(says("\"handle.post\" is behind, though nothing touches the sheet: its weight"));
  EXPECT_EQ(missed_gates({}, {bad}, {})[0].advice.find("in the way"), std::string::npos);
  EXPECT_NE(missed_gates({}, {bad}, {})[0].advice.find("more handles"), std::string::npos);
  bad.statistics.singular = 3;
  EXPECT_TRUE(says("pushes back harder than a hand"));
}

TEST(Gates, ASheetThatASingleHandleHoldsCannotBeJammedByItself) {
  FrameStatistics now;
  now.inertia = true;
  now.touching = 9;
  EXPECT_TRUE(is_pulled(now, 2, 1));
  EXPECT_FALSE(is_pulled(now, 2, 2)) << "two hands may crush it between them";
  now.on_colliders = 1;
  EXPECT_FALSE(is_pulled(now, 2, 1)) << "a collider may hold it";
  now.on_colliders = now.touching = 0;
  EXPECT_FALSE(is_pulled(now, 2, 2));
  EXPECT_TRUE(is_pulled(now, 0, 2));
  now.inertia = false;
  EXPECT_FALSE(is_pulled(now, 0, 1));
}

}  // namespace
}  // namespace paperbake
