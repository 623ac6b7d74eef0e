// What a bake keeps when something cannot be written: what was simulated goes to all that still
// works.

#include "baker/output/write_failures.h"

#include "formats/cache/alembic_reader.h"
#include "tests/baker/program_fixture.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>
#include <sys/resource.h>
#include <vector>

namespace paperbake {
namespace {

namespace fs = std::filesystem;
using test::CommandLine;
using test::Ended;
using test::lines_of;
using test::read;
using test::Words;
using test::write;

TEST(WriteFailuresTest, AWriterThatFailedIsNotCalledAgainAndTheOthersAre) {
  WriteFailures failures;
  int calls = 0;
  EXPECT_FALSE(failures.try_write("a", [&] {
    ++calls;
    throw Error(ErrorCode::folder, "a", "full");
  }));
  EXPECT_FALSE(failures.try_write("a", [&] { ++calls; }));
  EXPECT_TRUE(failures.try_write("b", [&] { ++calls; }));
  EXPECT_FALSE(failures.try_write("c", [] { throw std::runtime_error("of a library"); }));
  EXPECT_EQ(calls, 2);
  ASSERT_EQ(failures.all().size(), 2u);
  failures.record_partial("a", "ends at frame 4", failures.all()[0].error);
  EXPECT_EQ(failures.summary(), "a ends at frame 4; there is no c");
}

class BakeFailureTest : public CommandLine {
 protected:
  Words words(const std::string& frames, const std::string& formats) const {
    return crumple(frames, {"--map-frames", frames, "--formats", formats});
  }
  fs::path file(const std::string& name) const { return fs::path(output()) / name; }
  std::vector<nlohmann::json> frames() const {
    std::vector<nlohmann::json> all;
    for (const std::string& line : lines_of(read(file("cert/frames.jsonl"))))
      all.push_back(nlohmann::json::parse(line));
    return all;
  }
  void expect_no_parts() const {
    for (const auto& entry : fs::recursive_directory_iterator(output()))
      EXPECT_NE(entry.path().extension(), ".part") << entry.path();
  }
};

TEST_F(BakeFailureTest, AMapsFolderThatCannotBeMadeEndsTheBakeBeforeItsFirstFrame) {
  fs::create_directories(output());
  write(file("maps"), "a file");
  const Ended ended = run(crumple("1-4", {"--fps", "24"}));
  EXPECT_TRUE(test::is_error(ended, 6, file("maps").string(), "a file is in the way"));
  EXPECT_EQ(ended.err.find("simulated"), std::string::npos);
}

TEST_F(BakeFailureTest, AMapThatCannotBeWrittenIsReportedAndEverythingElseIsThere) {
  fs::create_directories(file("maps/S4_crumple.0003.exr"));
  const Ended ended = run(words("1-6", "abc,maps,cert,report"));
  EXPECT_EQ(ended.code, 6);
  EXPECT_TRUE(ended.out.empty());
  EXPECT_NE(
      ended.err.find(
          "Frames up to 6 are kept. Of what was asked for there is no maps/S4_crumple.0003.exr."),
      std::string::npos)
      << ended.err;
  EXPECT_EQ(frames().size(), 6u);
  EXPECT_EQ(AlembicReader(file("S4_crumple.abc")).sheets()[0].frames, 6u);
  for (const char* name : {"maps/S4_crumple.0002.exr", "maps/S4_crumple.0004.exr",
                           "maps/S4_crumple.final.exr", "report.html"})
    EXPECT_TRUE(fs::is_regular_file(file(name))) << name;
  const auto summary = nlohmann::json::parse(read(file("cert/summary.json")));
  EXPECT_EQ(summary["exit_code"], 6);
  EXPECT_NE(std::string(summary["failure"]).find("0003.exr"), std::string::npos);
  EXPECT_EQ(run({"verify", output()}).code, 0);
  expect_no_parts();
}

TEST_F(BakeFailureTest, OneThreadKeepsAsManyFramesAsTwo) {
  fs::create_directories(file("maps/S4_crumple.0002.exr"));
  Words one = words("1-4", "abc,maps,cert");
  one.insert(one.end(), {"--threads", "1"});
  EXPECT_EQ(run(one).code, 6);
  EXPECT_EQ(frames().size(), 4u);
}

TEST_F(BakeFailureTest, ADiskFullInTheSecondPassKeepsTheCacheUpToThereAndTheWholeCertificate) {
  rlimit before;
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{4'000'000, before.rlim_max};  // stands for a disk that fills up
  setrlimit(RLIMIT_FSIZE, &small);
  const Ended ended = run(words("1-12", "abc,pc2,cert"));
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(ended.code, 6) << ended.err;
  EXPECT_NE(ended.err.find("S4_crumple.abc ends at frame "), std::string::npos) << ended.err;
  EXPECT_NE(ended.err.find("rendered frame 12"), std::string::npos);
  const auto all = frames();
  ASSERT_EQ(all.size(), 12u);
  std::size_t kept = 0;
  while (kept < 12 && all[kept]["content_hash"] != "") ++kept;
  EXPECT_GE(kept, 3u);
  EXPECT_LT(kept, 12u);
  for (std::size_t k = kept; k < 12; ++k) EXPECT_EQ(all[k]["content_hash"], "");
  EXPECT_EQ(AlembicReader(file("S4_crumple.abc")).sheets()[0].frames, kept);
  // 12 frames of 12,000 vertices fit
  EXPECT_GT(fs::file_size(file("S4_crumple.pc2")), 12 * 10000 * 12u);
  EXPECT_EQ(run({"verify", output()}).code, 0);
  expect_no_parts();
}

TEST_F(BakeFailureTest, TheCacheOfTheEarlierBakeStaysUntilABakeSucceeds) {
  ASSERT_EQ(run(words("1-2", "abc,usd,cert")).code, 0);
  const std::string old = read(file("S4_crumple.usda"));
  fs::create_directories(file("maps/S4_crumple.0002.exr"));
  EXPECT_EQ(run(words("1-2", "abc,maps,cert")).code, 6);
  EXPECT_EQ(read(file("S4_crumple.usda")), old);
  fs::remove(file("maps/S4_crumple.0002.exr"));
  EXPECT_EQ(run(words("1-2", "abc,maps,cert")).code, 0);  // all is well: now it goes
  EXPECT_FALSE(fs::exists(file("S4_crumple.usda")));
}

TEST_F(BakeFailureTest, ACertificateAloneHasNoRenderNumbers) {
  ASSERT_EQ(run(words("1-3", "cert")).code, 0);
  for (const auto& frame : frames()) {
    EXPECT_TRUE(frame["render_triangles"].is_null());
    EXPECT_TRUE(frame["render_stretch_max_pct"].is_null());
    EXPECT_GT(double(frame["stretch_max_pct"]), 0);
  }
  const auto summary = nlohmann::json::parse(read(file("cert/summary.json")));
  EXPECT_TRUE(summary["render_stretch_max_pct"].is_null());
  EXPECT_TRUE(summary["failure"].is_null());
  const Ended verdict = run({"verify", output()});
  EXPECT_EQ(verdict.code, 4) << "nothing is handed on that could be verified";
  EXPECT_NE(verdict.out.find("has no cache"), std::string::npos) << verdict.out;
}

}  // namespace
}  // namespace paperbake
