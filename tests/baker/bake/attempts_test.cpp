// Attempts of a shot: when others are tried, which is baked, and what a bake that is stopped keeps.

#include "baker/bake/attempts.h"

#include "tests/baker/bake/resume_fixture.h"
#include "tests/core/collider_meshes.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <sys/resource.h>

namespace paperbake {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::Ended;
using test::read;
using test::Words;

BakePlan plan_of_one_sheet() {
  BakePlan plan;
  Shot shot;
  shot.sheet_name = "paper";
  shot.pattern.outline = {{0, 0}, {0.2, 0}, {0.2, 0.1}, {0, 0.1}};
  shot.handles.resize(2);
  shot.handles[0].name = "left";
  shot.handles[1].name = "right";
  plan.shots.push_back(shot);
  return plan;
}

AnimatedFrame frame_with_handles_off(int number, double left, double right) {
  static const Sheet flat;
  AnimatedFrame frame;
  frame.frame = number;
  frame.sheet = &flat;
  frame.handles.resize(2);
  frame.handles[0].state = frame.handles[1].state = HandleFrame::held;
  frame.handles[0].at = {left, 0, 0};
  frame.handles[1].at = {0, right, 0};
  return frame;
}

/// A floor that sinks by 20 mm in the last of three frames.
std::shared_ptr<const Colliders> falling_floor() {
  ColliderMesh floor = test::box({-1, -1, -0.1}, {1, 1, 0});
  Points3 lower = floor.x;
  lower.col(2).array() -= 0.02;
  floor.frames.own() = {floor.x, floor.x, lower};
  return test::all({floor});
}

TEST(Attempt, IsAsBadAsTheHandleThatIsOffMost) {
  const BakePlan plan = plan_of_one_sheet();
  Attempt attempt;
  add_frame(attempt, frame_with_handles_off(1, 0.001, 0.004), plan);
  add_frame(attempt, frame_with_handles_off(2, 0.003, 0), plan);
  EXPECT_NEAR(attempt.off, 0.004, 1e-12);
  EXPECT_NEAR(attempt.off_pct, 2, 1e-9) << "of the longer side, 200 mm";
  EXPECT_EQ(attempt.frame, 1);
}

TEST(Attempt, IsMadeAgainOnlyWhereAHandleOrAColliderHasMoved) {
  std::vector<Handle> handles(2);
  handles[0].keyed = Points3::Zero(3, 3);
  handles[1].keyed = (Points3(3, 3) << 0.1, 0, 0, 0.1, 0, 0.0005, 0.1, 0, 0.002).finished();
  EXPECT_FALSE(have_moved(handles, 0));
  EXPECT_FALSE(have_moved(handles, 1)) << "by half a millimetre, which the gate allows";
  EXPECT_TRUE(have_moved(handles, 2));
  EXPECT_TRUE(have_moved(handles, 9)) << "and stays there";
  const std::shared_ptr<const Colliders> floor = falling_floor();
  EXPECT_FALSE(have_moved(*floor, 0));
  EXPECT_FALSE(have_moved(*floor, 1));
  EXPECT_TRUE(have_moved(*floor, 2));
}

TEST(Attempt, IsMadeAgainWhereAHandleGivesWayToAColliderThatMoves) {
  BakeSettings settings;
  settings.resume = Resume::never;
  for (const bool moves : {false, true}) {
    BakePlan plan = plan_of_one_sheet();
    for (Handle& handle : plan.shots[0].handles) handle.keyed = Points3::Zero(3, 3);
    plan.animation.first_frame = 1;
    plan.animation.last_frame = 3;
    if (moves) plan.shots[0].colliders = falling_floor();
    Attempts attempts(settings, plan, "nowhere");
    attempts.watch(frame_with_handles_off(1, 0, 0));
    attempts.watch(frame_with_handles_off(2, 0.003, 0));
    EXPECT_FALSE(attempts.is_failing()) << "nothing has moved yet";
    attempts.watch(frame_with_handles_off(3, 0, 0));
    EXPECT_EQ(attempts.is_failing(), moves);
  }
}

TEST(Attempt, IsNotMadeAgainForHandlesWhereTheKeysAreOutOfReach) {
  BakeSettings settings;
  settings.resume = Resume::never;
  for (const bool out_of_reach : {false, true}) {
    BakePlan plan = plan_of_one_sheet();
    plan.animation.first_frame = 1;
    plan.animation.last_frame = 3;
    for (Handle& handle : plan.shots[0].handles)
      handle.keyed = (Points3(2, 3) << 0, 0, 0, 0.1, 0, 0).finished();
    if (out_of_reach) plan.impossible.push_back({"paper", {}});
    Attempts attempts(settings, plan, "nowhere");
    attempts.watch(frame_with_handles_off(1, 0, 0));
    attempts.watch(frame_with_handles_off(2, 0.01, 0));
    EXPECT_EQ(attempts.is_failing(), !out_of_reach);
  }
}

TEST(Attempt, MissesTheGateOfCollidersAsItMissesThatOfHandles) {
  AnimatedFrame frame = frame_with_handles_off(1, 0.0005, 0);
  BakePlan plan = plan_of_one_sheet();
  plan.animation.first_frame = 1;
  Attempt attempt;
  frame.statistics.inside_colliders = 0.025;
  add_frame(attempt, frame, plan);
  EXPECT_NEAR(worst_miss(attempt), 0.5, 1e-9) << "where it begins is the same in all attempts";
  frame.frame = 2;
  frame.statistics.inside_colliders = 0.0003;
  add_frame(attempt, frame, plan);
  EXPECT_NEAR(worst_miss(attempt), 3, 1e-9);
  frame.statistics.inside_colliders = 0;
  add_frame(attempt, frame, plan);
  EXPECT_NEAR(worst_miss(attempt), 3, 1e-9) << "it was in a frame before";
  EXPECT_NEAR(attempt.off, 0.0005, 1e-12) << "which is of handles alone";
  add_frame(attempt, frame_with_handles_off(3, 0.004, 0), plan);
  EXPECT_NEAR(worst_miss(attempt), 4, 1e-9);
}

TEST(Attempt, CountsThePointsThatWereBornAndNotThoseThatTheArtistAskedFor) {
  BakePlan plan = plan_of_one_sheet();
  plan.animation.first_frame = 5;
  AnimatedFrame frame = frame_with_handles_off(9, 0, 0);
  Sheet sheet;
  sheet.singular = {{{0, 0}, 5, "kept here"}, {{0.1, 0}, 8, "bends in two directions"}};
  frame.sheet = &sheet;
  Attempt attempt;
  add_frame(attempt, frame, plan);
  EXPECT_EQ(attempt.points, 1);
  plan.shots.push_back(plan.shots.front());
  Sheet other;
  other.singular.assign(2, {{0.1, 0}, 7, "bends in two directions"});
  frame.sheet_index = 1;
  frame.sheet = &other;
  add_frame(attempt, frame, plan);
  EXPECT_EQ(attempt.points, 2) << "of the sheet that has most";
}

TEST(Attempt, DoesNotCountAHandleThatHoldsNothing) {
  AnimatedFrame frame = frame_with_handles_off(1, 0.001, 0.05);
  frame.handles[1].state = HandleFrame::free;
  Attempt attempt;
  add_frame(attempt, frame, plan_of_one_sheet());
  EXPECT_NEAR(attempt.off, 0.001, 1e-12);
}

TEST(Attempt, DoesNotCountAHandleThatTheSheetIsPulledOff) {
  AnimatedFrame frame = frame_with_handles_off(1, 0.001, 0.05);
  frame.statistics.inertia = true;
  Attempt attempt;
  add_frame(attempt, frame, plan_of_one_sheet());
  EXPECT_EQ(attempt.off, 0) << "no seed and no mesh makes a hand stronger";
  EXPECT_NEAR(attempt.pulled, 0.05, 1e-12) << "but one on which it is not pulled is better";
  Sheet crumpled;
  crumpled.singular.resize(1);
  frame.sheet = &crumpled;
  add_frame(attempt, frame, plan_of_one_sheet());
  EXPECT_NEAR(attempt.off, 0.05, 1e-12) << "it may be jammed";
}

TEST(Attempt, DoesNotCountASoftHandleThatLags) {
  AnimatedFrame frame = frame_with_handles_off(1, 0.001, 0.05);
  frame.handles[1].state = HandleFrame::soft;
  Attempt attempt;
  add_frame(attempt, frame, plan_of_one_sheet());
  EXPECT_NEAR(attempt.off, 0.001, 1e-12);
}

TEST(Attempt, DoesNotCountWhatPaperCannotBridge) {
  BakePlan plan = plan_of_one_sheet();
  UnreachablePair pair;
  pair.a = "left";
  pair.b = "elsewhere";
  pair.apart = 0.23;
  pair.allowed = 0.2;
  plan.impossible.push_back({"paper", pair});
  Attempt attempt;
  add_frame(attempt, frame_with_handles_off(1, 0.029, 0.002), plan);
  EXPECT_NEAR(attempt.off, 0.002, 1e-12) << "the paper is 30 mm too short for the left one";
  add_frame(attempt, frame_with_handles_off(2, 0.036, 0.002), plan);
  EXPECT_NEAR(attempt.off, 0.006, 1e-12);
  EXPECT_NEAR(attempt.off_pct, 3, 1e-9);
}

TEST(Attempt, OnAFinerMeshIsTheWorseTheMoreIsWrongWithIt) {
  Attempt coarse, finer, finest;
  coarse.base_triangles = 120;
  finer.base_triangles = 480;
  finest.base_triangles = 960;
  const Comparison by{AttemptReason::coarse, 3, 0.001};
  EXPECT_EQ(badness(finer, true, by), 1) << "nothing is wrong";
  coarse.coarse = true;
  finer.points = 2;
  finest.coarse = true;
  EXPECT_EQ(badness(finer, false, by), 1) << "it is not over";
  EXPECT_LT(1, badness(finest, true, by));
  EXPECT_LT(badness(finest, true, by), badness(finer, true, by));
  EXPECT_LT(badness(finer, true, by), badness(coarse, true, by));
  const auto is_given_up = [&](const Attempt& attempt) {
    return std::isinf(badness(attempt, false, by));
  };
  finer.points = 3;
  EXPECT_TRUE(is_given_up(finer)) << "it crumples";
  finest.pulled = 0.0011;
  EXPECT_TRUE(is_given_up(finest)) << "its handles do not hold";
  finest.pulled = 0;
  finest.off = 0.0011;
  EXPECT_TRUE(is_given_up(finest)) << "a handle is off";
}

TEST(Attempt, IsNotDoubtedWhereAnySheetBeginsOnAFinerMesh) {
  BakePlan plan = plan_of_one_sheet();
  plan.shots.push_back(plan.shots.front());
  for (Shot& shot : plan.shots) shot.handles.clear();
  plan.animation.first_frame = 1;
  plan.animation.last_frame = 4;
  BakeSettings settings;
  settings.resume = Resume::never;
  const auto is_doubtful = [&](int sheet_that_begins_finer) {
    Attempts attempts(settings, plan, fs::temp_directory_path());
    for (int f = 1; f <= 4; ++f)
      for (int s = 0; s < 2; ++s) {
        AnimatedFrame frame = frame_with_handles_off(f, 0, 0);
        frame.handles.clear();
        frame.sheet_index = s;
        frame.statistics.doublings = s == sheet_that_begins_finer;
        frame.statistics.mesh_error = 0.01;
        attempts.watch(frame);
      }
    return attempts.is_doubtful();
  };
  EXPECT_TRUE(is_doubtful(-1));
  EXPECT_FALSE(is_doubtful(0));
  EXPECT_FALSE(is_doubtful(1));
}

TEST(Attempt, IsFinerThanTheMeshWithWhichTheFirstOneBegan) {
  const auto ladder = [](AttemptReason reason, int doublings) {
    std::vector<int> of_attempts;
    for (std::size_t k = 0; k < 4; ++k) of_attempts.push_back(refinement(k, reason, doublings));
    return of_attempts;
  };
  EXPECT_EQ(ladder(AttemptReason::handle_off, 0), (std::vector<int>{1, 2, 4, 2}));
  EXPECT_EQ(ladder(AttemptReason::crumpled, 0), (std::vector<int>{1, 4, 8, 4}));
  // a rehearsal doubles the first one itself
  EXPECT_EQ(ladder(AttemptReason::handle_off, 2), (std::vector<int>{1, 8, 16, 8}));
  EXPECT_EQ(refinement(attempt_on_finest_mesh, AttemptReason::handle_off, 0), 8);
}

TEST(Attempt, ThatIsBakedBecauseAllWereGivenUpIsNotCalledTheBest) {
  AttemptChoice choice;
  choice.tried.resize(2);
  choice.tried[0].off = 0.037;
  choice.tried[1].off = 0.031;
  EXPECT_NE(describe(choice).find("1 other is not better"), std::string::npos);
  choice.hopeless = true;
  EXPECT_EQ(describe(choice).find("not better"), std::string::npos);
  EXPECT_NE(describe(choice).find("10 % of the sheet"), std::string::npos);
}

TEST(Attempt, ThatHoldsTheHandlesIsSaidToCrumpleOnTheFinestMeshOnlyIfThatWasTried) {
  AttemptChoice choice;
  choice.tried.resize(3);
  choice.baked = 1;
  choice.tried[1].seed_offset = 1000;
  choice.tried[1].points = 30;
  choice.tried[2].seed_offset = 2000;
  choice.tried[2].base_triangles = 480;
  choice.tried[2].points = 30;
  EXPECT_EQ(describe(choice).find("crumples"), std::string::npos) << "it was off by more";
  choice.tried[2].seed_offset = 0;
  choice.tried[2].base_triangles = 960;
  EXPECT_NE(describe(choice).find("because the paper crumples on one of 960, too"),
            std::string::npos)
      << describe(choice);
}

TEST(Attempt, OnAFinerMeshIsBakedWhereOnlyTheFirstOneCrumples) {
  AttemptChoice choice;
  choice.reason = AttemptReason::crumpled;
  Attempt first, finer;
  first.base_triangles = 120;
  first.points = 3;
  finer.base_triangles = 480;
  choice.tried = {first, finer};
  choice.baked = 1;
  EXPECT_EQ(describe(choice),
            "attempts: the paper crumples on a first mesh of 120 triangles; one of 480 is baked");
  choice.baked = 0;
  EXPECT_NE(describe(choice).find("it is baked, because one of 480 is not better"),
            std::string::npos);
  choice.tried.pop_back();
  EXPECT_NE(describe(choice).find("it is baked, because none comes of a finer one"),
            std::string::npos)
      << "its simulation has failed";
  choice.tried.push_back(finer);
  choice.tried[1].points = 3;
  EXPECT_NE(describe(choice).find("it is baked, because the paper crumples on one of 480, too"),
            std::string::npos);
  choice.reason = AttemptReason::coarse;
  choice.tried[0].points = 0;
  EXPECT_EQ(describe(choice),
            "attempts: a first mesh of 120 triangles puts the smooth paper off visibly; it "
            "is baked, because the paper crumples on one of 480");
}

TEST(Attempt, OnAFinerMeshIsBakedWhereThePointsWereThoseOfTheFirstOne) {
  AttemptChoice choice;
  choice.reason = AttemptReason::crumpled;
  Attempt first, finer;
  first.base_triangles = 120;
  first.points = 2;
  finer.base_triangles = 480;
  finer.points = 1;
  choice.tried = {first, finer};
  choice.baked = 1;
  EXPECT_EQ(describe(choice),
            "attempts: the paper breaks at single points on a first mesh of 120 triangles; one of "
            "480 is baked");
  choice.baked = 0;
  choice.tried[1].points = 2;
  EXPECT_NE(describe(choice).find("because the paper breaks at single points on one of 480, too"),
            std::string::npos);
}

/// A crumple, from frame 24 on. With seed 0 a handle is off by 1.3 mm in frame 38, with seed 3 by
/// 1.1 mm in frame 45; on the finer mesh of the second attempt none is.
class AttemptsTest : public test::ResumeFixture {
 protected:
  Words shot(const std::string& sample, const std::string& out, const Words& more) const {
    return shot_of(test::samples + "/" + sample + ".glb", out, more);
  }
  static std::string violent(const std::string& scene) {
    return std::string(PAPERBAKE_DATA) + "/violent/" + scene + ".glb";
  }
  Words shot_of(const std::string& scene, const std::string& out, const Words& more) const {
    Words all{"bake",       scene,      "-o",        (folder / out).string(),
              "--formats",  "abc,cert", "--quality", "draft",
              "--progress", "plain"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  Words crumple(const std::string& out, Words more, const char* frames = "1-46") const {
    more.insert(more.end(), {"--frames", frames});
    return shot("S14_hands", out, more);
  }
  /// A note that crumples on any mesh, with handles that hold.
  Words note(const std::string& out, const Words& more) const { return shot("S0_note", out, more); }
  /// A cone that becomes a crumple on its first mesh, with this seed, and is smooth on a finer one.
  Words coarse_cone(const std::string& out, Words more) const {
    more.insert(more.end(), {"--seed", "2"});
    return shot("S15_cone", out, more);
  }
  std::vector<json> shapes(const std::string& out) const {
    std::vector<json> hashes;
    for (const std::string& line : test::lines_of(read(folder / out / "cert/frames.jsonl")))
      hashes.push_back(json::parse(line).at("content_hash"));
    return hashes;
  }
  json summary(const std::string& out) const {
    return json::parse(read(folder / out / "cert/summary.json"));
  }
};

TEST_F(AttemptsTest, AnAttemptThatGoesWellIsTheOnlyOne) {
  const Ended ended = run(crumple("out", {}, "1-23"));
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_TRUE(summary("out").at("attempts").is_null());
  EXPECT_EQ(simulated(ended), 23);
}

TEST_F(AttemptsTest, PaperThatCrumplesOnAFinerMeshTooIsBakedAsItCrumpledFirst) {
  const Ended ended = run(note("out", {}));
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(simulated(ended), 92) << "the first attempt is not simulated again";
  const json attempts = summary("out").at("attempts");
  EXPECT_EQ(attempts.at("reason"), "crumpled");
  EXPECT_EQ(attempts.at("baked"), 1);
  ASSERT_EQ(attempts.at("tried").size(), 3u);
  for (const int number : {1, 2}) {
    const json& finer = attempts.at("tried").at(number);
    EXPECT_EQ(finer.at("seed_offset"), 0);
    EXPECT_EQ(finer.at("base_triangles"), 480 * number);
    EXPECT_TRUE(finer.at("crumpled"));
    EXPECT_LT(finer.at("frames"), 92) << "it ends where it crumples";
  }
  run(note("alone", {"--attempts", "1"}));
  EXPECT_TRUE(summary("alone").at("attempts").is_null());
  EXPECT_TRUE(shapes("out") == shapes("alone"));

  // debug pictures need the frames again, but no second opinion
  const Ended again = run(note("out", {"--debug-pictures", (folder / "debug").string()}));
  EXPECT_EQ(simulated(again), 0) << again.err;
  EXPECT_EQ(times(again.err, "is tried"), 0) << again.err;
  EXPECT_EQ(summary("out").at("attempts"), attempts);
}

TEST_F(AttemptsTest, OfAPartOfAShotNothingIsConcluded) {
  const Ended part = run(note("part", {"--frames", "1-60"}));
  EXPECT_EQ(times(part.err, "is tried"), 0) << part.err;
  EXPECT_EQ(times(part.err, "a bake of the whole shot also tries a finer one"), 1) << part.err;
  EXPECT_TRUE(summary("part").at("attempts").is_null());
  const Ended early = run(note("early", {"--frames", "1-4"}));
  EXPECT_EQ(times(early.err, "whole shot"), 0) << "it is hardly bent yet";
  const Ended whole = run(note("part", {}));
  EXPECT_EQ(times(whole.err, "is tried"), 2) << whole.err;
}

TEST_F(AttemptsTest, ABakeThatIsKilledWhileItTriesAFinerMeshComesOutAsAnother) {
  run(note("whole", {}));
  EXPECT_EQ(bake_until(1, 100, SIGKILL, note("out", {}), "is tried"), -1);
  EXPECT_EQ(bake_until(1, 0, SIGTERM, note("out", {}), "is tried"), 5);
  EXPECT_NE(read(folder / "stderr.txt").find("stopped while it tried another attempt"),
            std::string::npos);
  const Ended rest = run(note("out", {"--threads", "5"}));
  EXPECT_EQ(simulated(rest), 0) << "the first attempt was simulated before";
  expect_same("out", "whole");
  EXPECT_EQ(summary("out").at("attempts"), summary("whole").at("attempts"));
}

TEST_F(AttemptsTest, PaperThatCrumplesOnlyOnACoarseMeshIsBakedOnAFinerOne) {
  const Ended ended = run(coarse_cone("out", {}));
  ASSERT_EQ(ended.code, 0) << ended.err;
  const json attempts = summary("out").at("attempts");
  EXPECT_EQ(attempts.at("baked"), 2);
  EXPECT_TRUE(attempts.at("tried").at(0).at("crumpled"));
  EXPECT_FALSE(attempts.at("tried").at(1).at("crumpled"));
  EXPECT_EQ(attempts.at("reason"), "crumpled");
  // who asks for a number of triangles gets it, also in a folder that has the other bake
  const std::vector<json> finer = shapes("out");
  run(coarse_cone("out", {"--base-triangles", "120"}));
  EXPECT_TRUE(summary("out").at("attempts").is_null());
  EXPECT_FALSE(shapes("out") == finer);
}

TEST_F(AttemptsTest, SmoothPaperThatIsTooTightlyBentForTheFirstMeshIsBakedOnAFinerOne) {
  const auto stacks = [&](const std::string& out, const Words& more) {
    return shot("S7_stacks", out, more);
  };
  const Ended ended = run(stacks("out", {}));
  ASSERT_EQ(ended.code, 0) << ended.err;
  const json attempts = summary("out").at("attempts");
  EXPECT_EQ(attempts.at("reason"), "coarse");
  EXPECT_FALSE(attempts.at("tried").at(0).at("crumpled"));
  EXPECT_EQ(attempts.at("baked"), 2);
  run(stacks("direct", {"--base-triangles", "480", "--attempts", "1"}));
  EXPECT_TRUE(shapes("out") == shapes("direct"));
  EXPECT_FALSE(fs::exists(folder / "out/.state/attempts"));

  // a polished shot is judged before that, and polished once
  const Ended polished = run(stacks("polished", {"--polish", "300"}));
  ASSERT_EQ(polished.code, 0) << polished.err;
  EXPECT_EQ(summary("polished").at("attempts"), attempts);
  EXPECT_EQ(simulated(polished), 25) << "nothing of the first attempt was handed on";
  run(stacks("directly", {"--polish", "300", "--base-triangles", "480", "--attempts", "1"}));
  EXPECT_TRUE(shapes("polished") == shapes("directly"));
}

TEST_F(AttemptsTest, MapsOfTheFirstOneGoAlsoWhereThoseOfTheChosenOneCannotBeWritten) {
  const auto with_maps = [&](const std::string& out) {
    Words all = shot("S7_stacks", out, {"--map-size", "256", "--map-frames", "1-25x6"});
    *std::find(all.begin(), all.end(), "abc,cert") = "maps,cert";
    return all;
  };
  const Ended whole = run(with_maps("whole"));
  ASSERT_EQ(whole.code, 0) << whole.err;
  std::uintmax_t smallest = std::numeric_limits<std::uintmax_t>::max();
  for (const auto& map : fs::directory_iterator(folder / "whole/maps"))
    smallest = std::min(smallest, map.file_size());
  ASSERT_GT(smallest, 2 * whole.err.size()) << "what it tells has to find room";

  const pid_t child = test::start(folder, with_maps("out"));
  while (times(read(folder / "stderr.txt"), "is tried") == 0) usleep(1000);
  const rlimit small{smallest - 1, smallest - 1};
  prlimit(child, RLIMIT_FSIZE, &small, nullptr);
  EXPECT_EQ(test::exit_code(child), 6);
  EXPECT_EQ(times(read(folder / "stderr.txt"), "there is no maps/S7_stacks.0013.exr"), 1)
      << read(folder / "stderr.txt");
  for (const auto& map : fs::directory_iterator(folder / "out/maps"))
    ADD_FAILURE() << map.path() << " is of the attempt that was not baked";
}

TEST_F(AttemptsTest, PicturesOfTheFirstOneGo) {
  const auto pictures = [&](const std::string& out, Words more) {
    more.insert(more.end(), {"--debug-pictures", folder / out / "debug"});
    run(coarse_cone(out, more));
    std::set<std::string> names;
    for (const auto& picture : fs::directory_iterator(folder / out / "debug"))
      names.insert(picture.path().filename());
    return names;
  };
  const std::set<std::string> chosen = pictures("out", {});
  const json attempts = summary("out").at("attempts");
  ASSERT_EQ(attempts.at("baked"), 2);
  ASSERT_TRUE(attempts.at("tried").at(0).at("crumpled")) << "its points would have pictures, too";
  EXPECT_EQ(chosen, pictures("direct", {"--base-triangles", "480", "--attempts", "1"}));
}

TEST_F(AttemptsTest, WhereOthersCannotBeKeptTheFirstOneIsWritten) {
  fs::create_directories(folder / "out/.state");
  std::ofstream(folder / "out/.state/attempts") << "a file in the way of their folder";
  const Ended ended = run(shot("S7_stacks", "out", {}));
  EXPECT_NE(ended.code, 0);
  EXPECT_NE(ended.err.find("attempts"), std::string::npos) << ended.err;
  EXPECT_TRUE(fs::exists(folder / "out/S7_stacks.abc"));
  run(shot("S7_stacks", "first", {"--attempts", "1"}));
  ASSERT_FALSE(shapes("first").empty());
  EXPECT_TRUE(shapes("out") == shapes("first"));
}

TEST_F(AttemptsTest, SmoothPaperThatItsMeshPutsOffIsBakedOnAFinerOne) {
  // its triangles are near smooth paper, and yet it is 0.6 % of its side from where it should be
  const Ended ended = run(shot("S1_push", "out", {}));
  ASSERT_EQ(ended.code, 0) << ended.err;
  const json attempts = summary("out").at("attempts");
  ASSERT_TRUE(attempts.is_object());
  EXPECT_EQ(attempts.at("reason"), "coarse");
  EXPECT_EQ(attempts.at("baked"), 2);
}

TEST_F(AttemptsTest, SingularPointsThatOnlyACoarseMeshHasAreNotBaked) {
  const Ended ended = run(shot_of(violent("squeezed_ring"), "out", {}));
  ASSERT_EQ(ended.code, 0) << ended.err;
  const json all = summary("out");
  EXPECT_EQ(all.at("attempts").at("reason"), "crumpled");
  EXPECT_EQ(all.at("attempts").at("baked"), 2);
  EXPECT_EQ(all.at("singular"), 0);
  run(shot_of(violent("squeezed_ring"), "first", {"--attempts", "1"}));
  EXPECT_GT(summary("first").at("singular"), 0);
}

TEST_F(AttemptsTest, APointThatGoesOnlyOnEightTimesAsManyTrianglesIsTheMeshsToo) {
  // finite elements have none either
  const Ended ended = run(shot("S8_dcone", "out", {}));
  ASSERT_EQ(ended.code, 0) << ended.err;
  const json all = summary("out"), attempts = all.at("attempts");
  EXPECT_EQ(attempts.at("baked"), 3);
  EXPECT_EQ(attempts.at("tried").at(1).at("points"), 1);
  EXPECT_LT(attempts.at("tried").at(1).at("frames"), 96) << "it ends where it gets one";
  EXPECT_EQ(all.at("singular"), 0);
}

TEST_F(AttemptsTest, ACrumpleThatGoesOnlyOnEightTimesAsManyTrianglesIsNotBaked) {
  const Ended ended = run(shot_of(violent("banknote"), "out", {}));
  ASSERT_EQ(ended.code, 0) << ended.err;
  const json all = summary("out"), attempts = all.at("attempts");
  EXPECT_EQ(attempts.at("baked"), 3);
  EXPECT_TRUE(attempts.at("tried").at(0).at("crumpled"));
  EXPECT_TRUE(attempts.at("tried").at(1).at("crumpled"));
  EXPECT_EQ(all.at("singular"), 0);
}

TEST_F(AttemptsTest, ACrumpleThatHoldsTheHandlesIsNotBakedWhereAFinerMeshIsSmooth) {
  // finite elements have one sharp point, too
  const auto arch = [&](const std::string& out, const Words& more) {
    return shot("S9_unload", out, more);
  };
  const Ended ended = run(arch("out", {}));
  ASSERT_EQ(ended.code, 0) << ended.err;
  const json attempts = summary("out").at("attempts"), tried = attempts.at("tried");
  EXPECT_EQ(attempts.at("reason"), "handle off");
  ASSERT_EQ(attempts.at("baked"), 3);
  EXPECT_TRUE(tried.at(1).at("crumpled"));
  EXPECT_LT(tried.at(1).at("off_mm"), 1) << "it would have been baked";
  EXPECT_EQ(tried.at(2).at("base_triangles"), 960);
  EXPECT_EQ(tried.at(2).at("seed_offset"), 0);
  EXPECT_NE(ended.err.find("attempt 3 of 4 is tried: the paper crumples"), std::string::npos)
      << ended.err;
  EXPECT_LT(summary("out").at("singular"), 3);
  // a bake that makes more of the same frames has the same choice
  const std::vector<json> baked = shapes("out");
  const Ended again = run(arch("out", {"--map-frames", "1"}));
  EXPECT_EQ(times(again.err, "is tried"), 0) << again.err;
  EXPECT_EQ(summary("out").at("attempts"), attempts);
  EXPECT_TRUE(shapes("out") == baked);
  // who allows two attempts gets no third
  run(arch("out", {"--attempts", "2"}));
  EXPECT_EQ(summary("out").at("attempts").at("baked"), 2);
}

TEST_F(AttemptsTest, AFinerMeshThatLosesAHandleIsFollowedByAFinerOneStill) {
  // a poster that is rolled from both ends: the rolls are boxes on 120 triangles
  const Ended ended = run(shot_of(violent("two_rolls"), "out", {}));
  ASSERT_EQ(ended.code, 0) << ended.err;
  const json attempts = summary("out").at("attempts");
  EXPECT_EQ(attempts.at("reason"), "coarse");
  ASSERT_EQ(attempts.at("baked"), 3);
  EXPECT_GT(attempts.at("tried").at(1).at("off_mm"), 1);
  EXPECT_EQ(attempts.at("tried").at(2).at("seed_offset"), 0);
  EXPECT_EQ(attempts.at("tried").at(2).at("base_triangles"), 960);
  EXPECT_LT(attempts.at("tried").at(2).at("off_mm"), 1);
  EXPECT_EQ(times(ended.err, "is tried"), 2) << ended.err;
  // a bake that makes more of the same frames has the same choice
  const Ended again = run(shot_of(violent("two_rolls"), "out", {"--map-frames", "1"}));
  EXPECT_EQ(times(again.err, "is tried"), 0) << again.err;
  EXPECT_EQ(summary("out").at("attempts"), attempts);
}

TEST_F(AttemptsTest, ABakeThatIsKilledInItsThirdAttemptComesOutAsAnother) {
  const auto rolls = [&](const std::string& out, const Words& more) {
    return shot_of(violent("two_rolls"), out, more);
  };
  run(rolls("whole", {"--threads", "1"}));
  EXPECT_EQ(bake_until(1, 100, SIGKILL, rolls("out", {}), "attempt 3 of 3 is tried"), -1);
  run(rolls("out", {"--threads", "3"}));
  expect_same("out", "whole");
  EXPECT_EQ(summary("out").at("attempts"), summary("whole").at("attempts"));
  // who allows two attempts gets no third
  run(rolls("two", {"--attempts", "2"}));
  EXPECT_EQ(summary("two").at("attempts").at("tried").size(), 2u);
  EXPECT_EQ(summary("two").at("attempts").at("baked"), 1);
}

TEST_F(AttemptsTest, WhereTheFirstOneLocksAnotherIsBakedThatDoesNot) {
  const Ended ended = run(crumple("out", {}));
  ASSERT_EQ(ended.code, 0) << ended.err;
  const json attempts = summary("out").at("attempts");
  const std::size_t baked = attempts.at("baked");
  EXPECT_GT(baked, 1U);
  ASSERT_GE(attempts.at("tried").size(), baked);
  EXPECT_GT(attempts.at("tried")[0].at("off_mm"), 1);
  EXPECT_LT(attempts.at("tried")[baked - 1].at("off_mm"), 1);
  EXPECT_EQ(attempts.at("tried")[baked - 1].at("frames"), 46);
  EXPECT_NE(ended.err.find("attempts: in the first attempt a handle is off by"), std::string::npos);

  const int seed = summary("out").at("sheets")[0].at("seed");
  const int triangles = attempts.at("tried")[baked - 1].at("base_triangles");
  run(crumple("direct", {"--seed", std::to_string(seed), "--base-triangles",
                         std::to_string(triangles), "--attempts", "1"}));
  EXPECT_TRUE(shapes("out") == shapes("direct")) << "it is the bake with that seed and mesh";
}

TEST_F(AttemptsTest, WhereOnlyCollidersMoveThereIsOneOnEachMesh) {
  const auto meshes = [&](const std::string& out, const Words& more) {
    const Ended ended = run(shot_of(violent("pencil8"), out, more));
    EXPECT_EQ(ended.code, 4) << "a pencil goes through a sheet that is held: " << ended.err;
    std::vector<int> triangles;
    const json attempts = summary(out).at("attempts");
    for (const json& tried : attempts.at("tried")) triangles.push_back(tried.at("base_triangles"));
    return triangles;
  };
  EXPECT_EQ(meshes("out", {}), (std::vector<int>{120, 240, 480}));
  EXPECT_EQ(meshes("two", {"--attempts", "2"}), (std::vector<int>{120, 240}));
  EXPECT_EQ(meshes("given", {"--base-triangles", "60"}), (std::vector<int>{60, 60}));
}

TEST_F(AttemptsTest, ADiscThatAFingerPushesIntoARingIsOneConeWithoutOtherPoints) {
  const Ended ended = run(shot("S15_cone", "out", {}));
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(summary("out").at("singular"), 0) << "the finger holds the apex";
}

TEST_F(AttemptsTest, ABakeThatIsKilledGoesOnWithTheAttemptThatWasChosen) {
  run(crumple("whole", {}));
  const int before = times(read(folder / "stderr.txt"), "is tried");
  // while other attempts are tried, and while the chosen one is baked
  EXPECT_EQ(bake_until(1, 0, SIGKILL, crumple("out", {}), "is tried"), -1);
  EXPECT_EQ(bake_until(1, 20000, SIGKILL, crumple("out", {}), "attempts: in"), -1);
  const Ended rest = run(crumple("out", {}));
  EXPECT_GT(before, 0);
  EXPECT_EQ(times(rest.err, "is tried"), 0) << rest.err;
  expect_same("out", "whole");
  EXPECT_EQ(summary("out").at("attempts"), summary("whole").at("attempts"));
}

TEST_F(AttemptsTest, TheChoiceDoesNotDependOnTheNumberOfThreads) {
  run(crumple("one", {}));
  run(crumple("many", {"--threads", "5"}));  // all attempts at the same time
  EXPECT_EQ(summary("many").at("attempts"), summary("one").at("attempts"));
  expect_same("many", "one");
}

TEST_F(AttemptsTest, WhatIsSimulatedOfOtherAttemptsIsKeptWhenABakeIsKilled) {
  run(crumple("whole", {}));
  EXPECT_EQ(bake_until(1, 100, SIGKILL, crumple("out", {}), "is tried"), -1);
  EXPECT_TRUE(fs::exists(folder / "out/.state/attempts/1"));
  fs::copy(folder / "out", folder / "anew", fs::copy_options::recursive);
  run(crumple("out", {}));
  expect_same("out", "whole");
  EXPECT_EQ(summary("out").at("attempts"), summary("whole").at("attempts"));
  EXPECT_FALSE(fs::exists(folder / "out/.state/attempts"));
  run(crumple("anew", {"--resume", "never"}));
  expect_same("anew", "whole");
  EXPECT_EQ(summary("anew").at("attempts"), summary("whole").at("attempts"));
}

TEST_F(AttemptsTest, ASignalIsHeardWhileOthersAreTried) {
  EXPECT_EQ(bake_until(1, 0, SIGTERM, crumple("out", {}), "is tried"), 5);
  const Ended other = run(crumple("out", {"--seed", "3"}));
  EXPECT_GT(times(other.err, "is tried"), 0) << "there is no decision yet, and this is another job";
}

}  // namespace
}  // namespace paperbake
