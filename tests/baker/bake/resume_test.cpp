// What a second bake in the same folder does: nothing, or what is left to do, and with the bytes
// that one bake alone would have written.

#include "tests/baker/bake/resume_fixture.h"

#include <functional>
#include <set>
#include <sys/resource.h>

namespace paperbake {
namespace {

namespace fs = std::filesystem;
using test::Ended;
using test::is_error;
using test::lines_of;
using test::read;
using test::samples;
using test::Words;
using test::write;
using ResumeTest = test::ResumeFixture;
using ResumePushTest = test::ResumePushFixture;

TEST_F(ResumeTest, ASecondBakeDoesNothingWhenNothingHasChanged) {
  const Ended first = run(words("out", {}, "1-6"));
  ASSERT_EQ(simulated(first), 6) << first.err;
  const auto before = fs::last_write_time(folder / "out/S4_crumple.abc");
  const Ended second = run(words("out", {"--threads", "1", "--checkpoint", "3"}, "1-6"));
  EXPECT_EQ(second.code, first.code);
  EXPECT_EQ(second.out, first.out);
  for (const char* work : {"simulated", "rendered", "earlier bake"})
    EXPECT_EQ(second.err.find(work), std::string::npos) << second.err;
  EXPECT_EQ(fs::last_write_time(folder / "out/S4_crumple.abc"), before);
}

TEST_F(ResumeTest, ABakeThatMissedAGateMissesItAgainWithoutWork) {
  const Ended first = run(words("out", {"--max-stretch", "1e-7"}, "1-6"));
  ASSERT_EQ(first.code, 4) << first.err;
  const Ended second = run(words("out", {"--max-stretch", "1e-7"}, "1-6"));
  EXPECT_EQ(second.code, 4);
  EXPECT_EQ(simulated(second), 0);
  EXPECT_NE(second.err.find("gate missed: Frame"), std::string::npos) << second.err;
}

TEST_F(ResumeTest, FilesThatWereChangedRemovedOrNewlyAskedForAreWrittenAgain) {
  bake_whole("out", {}, "1-6");
  bake_whole("whole", {"--formats", "abc,maps,cert,report,usd"}, "1-6");
  write(folder / "out/singular.csv", "mine");
  Ended again = run(words("out", {}, "1-6"));
  EXPECT_EQ(simulated(again), 0) << again.err;
  EXPECT_NE(again.err.find("rendered frame 6"), std::string::npos) << again.err;
  EXPECT_NE(read(folder / "out/singular.csv"), "mine");
  fs::remove(folder / "out/maps/S4_crumple.final.exr");
  again = run(words("out", {"--formats", "abc,maps,cert,report,usd"}, "1-6"));
  EXPECT_EQ(simulated(again), 0) << again.err;
  expect_same("out", "whole");
}

TEST_F(ResumeTest, ALongerBakeSimulatesOnlyTheNewFrames) {
  bake_whole("out", {}, "1-20");
  bake_whole("whole", {}, "1-30");
  const Ended longer = run(words("out", {}, "1-30"));
  EXPECT_EQ(simulated(longer), 10) << longer.err;
  expect_same("out", "whole");
  const Ended shorter = run(words("out", {"--quality", "shot"}, "7-17x2"));
  EXPECT_EQ(simulated(shorter), 0) << shorter.err;
  bake_whole("shorter", {"--quality", "shot"}, "7-17x2");
  expect_same("out", "shorter");
}

class ResumeAfterKillTest : public test::ResumeFixture,
                            public testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, ResumeAfterKillTest, testing::Values("hybrid", "fem", "adaptive"),
                         [](const auto& info) { return std::string(info.param); });

TEST_P(ResumeAfterKillTest, AKilledBakeResumesFromItsLastCheckpointToTheSameBytes) {
  const bool hybrid = std::string(GetParam()) == "hybrid";
  const std::string frames = hybrid ? "1-96" : "1-20";
  Words how{"--method", GetParam(), "--checkpoint", hybrid ? "12" : "4"};
  if (hybrid) how.insert(how.end(), {"--seed", "3"});          // a crumple that touches itself
  if (!hybrid) how.insert(how.end(), {"--triangles", "700"});  // slow enough to be killed in time
  bake_whole("whole", how, frames);
  const int kills[] = {hybrid ? 14 : 5, hybrid ? 20 : 3, hybrid ? 9 : 4};
  for (const int kill : kills)
    EXPECT_EQ(bake_until(kill, 0, SIGKILL, words("out", how, frames)), -1);
  const Ended last = run(words("out", how, frames));
  EXPECT_GT(simulated(last), 0);
  EXPECT_LT(simulated(last), hybrid ? 84 : 16) << last.err;
  expect_same("out", "whole");
  if (hybrid) {
    int births = 0, touching = 0;
    for (const std::string& line : lines_of(read(folder / "out/cert/frames.jsonl"))) {
      const auto record = nlohmann::json::parse(line);
      births += record["new_singular"].get<int>();
      touching += record["touching"] > 0;
    }
    EXPECT_GT(births, 0) << "a crumple without a birth proves little";
    EXPECT_GT(touching, 0);
  }
}

TEST_F(ResumeTest, AStoppedBakeKeepsItsFramesAndResumes) {
  bake_whole("whole", {}, "1-40");
  EXPECT_EQ(bake_until(7, 0, SIGTERM, words("out", {}, "1-40")), 5);
  EXPECT_NE(read(folder / "stderr.txt").find("The bake was stopped."), std::string::npos);
  const auto summary = nlohmann::json::parse(read(folder / "out/cert/summary.json"));
  EXPECT_EQ(summary["exit_code"], 5);
  const int frames = summary["frames"];
  EXPECT_LT(frames, 40);
  EXPECT_EQ(run({"verify", folder / "out"}).code, 0);
  EXPECT_EQ(bake_until(4, 0, SIGINT, words("out", {}, "1-40")), 5);
  const Ended rest = run(words("out", {}, "1-40"));
  EXPECT_LT(simulated(rest), 40 - frames) << "nothing is simulated twice";
  expect_same("out", "whole");
}

TEST_F(ResumeTest, ResumeNeverSimulatesEveryFrame) {
  bake_whole("out", {}, "1-6");
  EXPECT_EQ(simulated(run(words("out", {"--resume", "never"}, "1-6"))), 6);
  EXPECT_TRUE(is_error(run(words("out", {"--resume", "always"}, "1-6")), 2, "--resume", "always"));
}

TEST_F(ResumeTest, AnotherPaperOrSeedStartsFromTheFirstFrame) {
  bake_whole("out", {}, "1-6");
  EXPECT_EQ(simulated(run(words("out", {"--seed", "3"}, "1-6"))), 6);
  EXPECT_EQ(simulated(run(words("out", {"--seed", "3", "--set", "thickness=1e-4"}, "1-6"))), 6);
  bake_whole("whole", {"--seed", "3", "--set", "thickness=1e-4"}, "1-6");
  expect_same("out", "whole");
}

TEST_F(ResumeTest, ADamagedCheckpointIsReportedAndTheOneBeforeItUsed) {
  const Words every{"--checkpoint", "4"};
  bake_whole("whole", every, "1-14");
  int damage = 0;
  for (const auto& spoil : std::vector<std::function<void(std::string&)>>{
           [](std::string& s) { s[s.size() / 2] ^= 4; },
           [](std::string& s) { s.resize(s.size() / 3); }, [](std::string& s) { s.clear(); },
           [](std::string& s) { s += "more"; }}) {
    const std::string out = fmt::format("out{}", damage++);
    fs::copy(folder / "whole", folder / out, fs::copy_options::recursive);
    ASSERT_EQ(checkpoints(out), (std::set<std::string>{"checkpoint.000004", "checkpoint.000008",
                                                       "checkpoint.000012", "checkpoint.000014"}));
    std::string bytes = read(folder / out / ".state/checkpoint.000012");
    spoil(bytes);
    write(folder / out / ".state/checkpoint.000012", bytes);
    fs::remove(folder / out / "report.html");
    const Ended again = run(words(out, every, "1-14"));
    EXPECT_NE(
        again.err.find("checkpoint.000012 is damaged: the frames after 8 are simulated again."),
        std::string::npos)
        << again.err;
    EXPECT_EQ(simulated(again), 6);
    expect_same(out, "whole");
  }
}

TEST_F(ResumePushTest, TwoSheetsThatPushEachOtherResumeTogetherAfterAStopOrAKill) {
  const Ended whole = run(pushed("whole", 2, 0.03, over));
  ASSERT_EQ(simulated(whole), 60) << whole.err;
  int touching = 0;
  for (const std::string& line : lines_of(read(folder / "whole/cert/frames.jsonl")))
    touching += nlohmann::json::parse(line)["touching_others"] > 0;
  ASSERT_GT(touching, 10);
  EXPECT_EQ(bake_until(40, 0, SIGTERM, pushed("out", 2, 0.03, over)), 5);
  const Ended rest = run(pushed("out", 2, 0.03, over));
  EXPECT_LE(simulated(rest), 20) << rest.err;
  EXPECT_GT(simulated(rest), 0);
  expect_same("out", "whole");
  EXPECT_EQ(bake_until(31, 0, SIGKILL, pushed("killed", 2, 0.03, over)), -1);
  Words two_threads = pushed("killed", 2, 0.03, over);
  two_threads.insert(two_threads.end(), {"--threads", "2"});
  EXPECT_LE(simulated(run(two_threads)), 48);
  expect_same("killed", "whole");
}

TEST_F(ResumePushTest, AChangeOfOneSheetResumesBothFromTheCheckpointBeforeIt) {
  run(pushed("out", 2, 0.03, over));
  run(pushed("whole", 2, 0.02, over));
  const Ended other = run(pushed("out", 2, 0.02, over));
  EXPECT_EQ(simulated(other), 24) << "from the checkpoint before the key: frame 18 of 30, both";
  expect_same("out", "whole");
}

TEST_F(ResumePushTest, AMovedKeyResumesFromTheCheckpointBeforeIt) {
  const auto bake_with = [&](const std::string& out, double lift) {
    return run(pushed(out, 1, lift));
  };
  const Ended first = bake_with("out", 0.03);
  ASSERT_TRUE(first.code == 0 || first.code == 4) << first.err;
  ASSERT_EQ(simulated(first), 30);
  const Ended moved = bake_with("out", 0.02);
  EXPECT_EQ(simulated(moved), 12) << moved.err;
  bake_with("whole", 0.02);
  expect_same("out", "whole");
}

TEST_F(ResumeTest, AFullDiskLosesNoSimulatedFrame) {
  const Words often{"--checkpoint", "2", "--method", "fem", "--triangles", "200"};
  bake_whole("whole", often, "1-12");
  rlimit before;
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{60000, before.rlim_max};
  ASSERT_GT(fs::file_size(folder / "whole/S4_crumple.abc"), small.rlim_cur);
  setrlimit(RLIMIT_FSIZE, &small);
  const Ended full = run(words("out", often, "1-12"));
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(full.code, 6);
  EXPECT_NE(full.err.find("paperbake: " + (folder / "out").string()), std::string::npos)
      << full.err;
  const Ended again = run(words("out", often, "1-12"));
  EXPECT_TRUE(again.code == 0 || again.code == 4) << again.err;
  EXPECT_EQ(simulated(again), 0) << again.err;
  expect_same("out", "whole");
}

TEST_F(ResumeTest, ADiskWithoutRoomForACheckpointKeepsNothingAndSaysSo) {
  const Words often{"--checkpoint", "2", "--method", "fem", "--triangles", "200"};
  rlimit before;
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{8000, before.rlim_max};  // what the bake tells has room, a frame has not
  setrlimit(RLIMIT_FSIZE, &small);
  const Ended full = run(words("out", often, "1-6"));
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(full.code, 6);
  ASSERT_LT(full.err.size(), small.rlim_cur);
  EXPECT_NE(full.err.find("What was simulated could not be kept. Of what was asked for "
                          "S4_crumple.abc has no frame;"),
            std::string::npos)
      << full.err;
  EXPECT_EQ(full.err.find("are kept"), std::string::npos) << full.err;
  EXPECT_EQ(simulated(run(words("out", often, "1-6"))), 6) << "that is so";
}

TEST_F(ResumeTest, AnUnwritableOutputFolderEndsWithSix) {
  EXPECT_TRUE(is_error(run({"bake", samples + "/S4_crumple.glb", "-o", "/proc/out", "--fps", "24"}),
                       6, "/proc/out", "cannot be made"));
}

TEST_F(ResumeTest, ACheckpointThatCannotBeWrittenIsReportedAndTheBakeGoesOn) {
  fs::create_directories(folder / "out/.state/checkpoint.000006/in_the_way");
  const Ended ended = run(words("out", {}, "1-6"));
  EXPECT_TRUE(ended.code == 0 || ended.code == 4) << ended.err;
  EXPECT_NE(ended.err.find("warning: what a later bake would go on from could not be kept"),
            std::string::npos)
      << ended.err;
  bake_whole("whole", {}, "1-6");
  fs::remove_all(folder / "out/.state/checkpoint.000006");
  expect_same("out", "whole");
}

}  // namespace
}  // namespace paperbake
