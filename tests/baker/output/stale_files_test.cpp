// What is left of the bake before in an output folder.

#include "baker/output/file_hash.h"
#include "tests/baker/program_fixture.h"
#include "tests/own_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>

namespace paperbake {
namespace {

namespace fs = std::filesystem;
using test::CommandLine;
using test::samples;
using test::Words;
using test::write;

class StaleFilesTest : public CommandLine {
 protected:
  std::string bake_as(const Words& more,
                      const std::string& scene = samples + "/S4_crumple.glb") const {
    Words words{"bake", scene,      "-o",  output(),     "--method", "fem",       "--triangles",
                "100",  "--frames", "1-2", "--map-size", "8",        "--quality", "draft"};
    words.insert(words.end(), more.begin(), more.end());
    const test::Ended ended = run(words);
    EXPECT_EQ(ended.code, 0) << ended.err;
    return ended.err;
  }
  std::set<std::string> files() const {
    std::set<std::string> found;
    for (const auto& entry : fs::recursive_directory_iterator(output()))
      if (entry.is_regular_file())
        found.insert(fs::relative(entry.path(), output()).generic_string());
    return found;
  }
};

TEST_F(StaleFilesTest, ASecondBakeRemovesWhatOnlyTheFirstWroteAndNothingElse) {
  const fs::path pictures = fs::path(output()) / "pictures", out = output();
  bake_as({"--formats", "abc,usd,pc2,maps,cert,report", "--debug-pictures", pictures.string()});
  const auto first = files();
  for (const char* file :
       {"S4_crumple.usda", "S4_crumple.pc2", "S4_crumple.rest.obj", "maps/S4_crumple.final.exr",
        "report.html", "pictures/S4_crumple.0001.png"})
    ASSERT_TRUE(first.count(file)) << file;
  write(out / "notes.txt", "of the artist");
  write(out / "maps/S4_crumple.0007.exr", "of the artist, whatever its name");
  write(out / "report.html", "changed by the artist");
  bake_as({"--formats", "abc,cert"});
  EXPECT_EQ(files(), (std::set<std::string>{
                         ".state/cached", ".state/checkpoint.000002", ".state/done", ".state/lock",
                         ".state/written", "S4_crumple.abc", "cert/frames.jsonl",
                         "cert/handles.csv", "cert/summary.json", "job.lock.toml",
                         "maps/S4_crumple.0007.exr", "notes.txt", "report.html", "singular.csv"}));
  EXPECT_EQ(run({"verify", output()}).code, 0);
}

TEST_F(StaleFilesTest, ALineOfTheListDoesNotReachOutsideTheFolder) {
  const fs::path out = output(), beside = out.parent_path() / "victim.abc",
                 pictures = out.parent_path() / "pictures";
  bake_as({"--formats", "abc,cert", "--debug-pictures", pictures.string()});
  const fs::path picture = pictures / "S4_crumple.0001.png";
  ASSERT_TRUE(fs::exists(picture));
  write(beside, "of somebody else");
  const std::string key = file_hash(beside);
  std::ofstream(out / ".state/written", std::ios::app) << key << " ../victim.abc\n"
                                                       << key << ' ' << beside.string() << '\n';
  bake_as({"--formats", "abc,cert", "--frames", "1-1"});
  EXPECT_TRUE(fs::exists(beside));
  EXPECT_TRUE(fs::exists(picture)) << "of another folder, into which this bake does not write";
}

TEST_F(StaleFilesTest, ABakeIntoOneUsdLayerRemovesTheLayersOfTheBakeBefore) {
  bake_as({"--formats", "usdc,cert", "--usd-layers", "on"});
  ASSERT_TRUE(files().count("S4_crumple.asset.usdc"));
  ASSERT_TRUE(files().count("S4_crumple.animation.usdc"));
  EXPECT_EQ(run({"verify", output()}).code, 0);
  bake_as({"--formats", "usdc,cert"});
  EXPECT_TRUE(files().count("S4_crumple.usdc"));
  EXPECT_FALSE(files().count("S4_crumple.asset.usdc"));
  EXPECT_FALSE(files().count("S4_crumple.animation.usdc"));
}

TEST_F(StaleFilesTest, ABakeOfAnotherShotKeepsTheCachesOfTheFirst) {
  const fs::path folder = test::own_folder();
  for (const char* shot : {"sh010", "sh020"})
    fs::copy_file(samples + "/S4_crumple.glb", folder / (std::string(shot) + ".glb"));
  bake_as({"--formats", "abc,maps,cert,report"}, (folder / "sh010.glb").string());
  bake_as({"--formats", "abc,cert"}, (folder / "sh020.glb").string());
  EXPECT_TRUE(files().count("sh010.abc"));
  EXPECT_TRUE(files().count("maps/sh010.final.exr"));
  EXPECT_TRUE(files().count("sh020.abc"));
  EXPECT_FALSE(files().count("report.html")) << "which shows the other shot";
  EXPECT_EQ(run({"verify", output()}).code, 0);
}

TEST_F(StaleFilesTest, ABakeWithoutACertificateLeavesNoOldOneAndSaysSo) {
  EXPECT_EQ(bake_as({"--formats", "abc,cert"}).find("Removed"), std::string::npos);
  EXPECT_NE(bake_as({"--formats", "abc"})
                .find("Removed, because this bake does not write it: cert/frames.jsonl, "
                      "cert/handles.csv, cert/summary.json.\n"),
            std::string::npos);
  EXPECT_FALSE(fs::exists(fs::path(output()) / "cert"));
}

TEST_F(StaleFilesTest, AnOutputFolderThatIsALinkStays) {
  const fs::path real = test::own_folder() / "real";
  fs::create_directories(real);
  fs::create_directories(fs::path(output()).parent_path());
  fs::create_directory_symlink(real, output());
  bake_as({"--formats", "abc,cert"});
  bake_as({"--formats", "cert"});  // it removes a file beside the folders
  EXPECT_TRUE(fs::is_symlink(output()));
  EXPECT_TRUE(fs::exists(real / "cert/summary.json"));
  EXPECT_FALSE(fs::exists(real / "S4_crumple.abc"));
}

}  // namespace
}  // namespace paperbake
