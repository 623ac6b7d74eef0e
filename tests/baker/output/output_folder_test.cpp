// Where a bake writes: what is in its way, what is left of an earlier one, who else is there.
// Everything is checked from outside.

#include "tests/baker/program_fixture.h"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <filesystem>
#include <set>
#include <string>
#include <sys/file.h>
#include <unistd.h>

namespace paperbake {
namespace {

namespace fs = std::filesystem;
using OutputFolderTest = test::CommandLine;
using test::Ended;
using test::is_error;
using test::read;
using test::samples;
using test::Words;
using test::write;

TEST_F(OutputFolderTest, MapsAndCertificateOfAnEarlierBakeDoNotStayBesideANewOne) {
  ASSERT_EQ(bake({"--map-frames", "1-2"}).code, 0);
  const fs::path maps = fs::path(output()) / "maps", cert = fs::path(output()) / "cert";
  write(maps / "notes.txt", "mine");
  ASSERT_TRUE(fs::exists(maps / "S4_crumple.0002.exr"));
  ASSERT_EQ(bake({"--formats", "abc,maps"}).code, 0);
  EXPECT_FALSE(fs::exists(maps / "S4_crumple.0002.exr"));
  EXPECT_FALSE(fs::exists(cert / "frames.jsonl"));
  EXPECT_TRUE(fs::exists(maps / "S4_crumple.0001.exr"));
  EXPECT_TRUE(fs::exists(maps / "notes.txt"));
}

TEST_F(OutputFolderTest, AFileInTheWayOfTheOutputFolderEndsWithSix) {
  fs::create_directories(folder / "out");
  write(output(), "I was here first.");
  EXPECT_TRUE(is_error(bake({}), 6, output(), "file is in the way"));
  EXPECT_EQ(read(output()), "I was here first.");
}

TEST_F(OutputFolderTest, AFileInTheWayOfAParentFolderEndsWithSix) {
  write(folder / "out", "I was here first.");
  EXPECT_TRUE(is_error(bake({}), 6, output(), "file is in the way"));
}

TEST_F(OutputFolderTest, AFolderInTheWayOfAnOutputFileEndsWithSix) {
  fs::create_directories(fs::path(output()) / "S4_crumple.abc" / "full");
  EXPECT_TRUE(is_error(bake({}), 6, output() + "/S4_crumple.abc", ""));
}

TEST_F(OutputFolderTest, ABusyOutputFolderEndsWithSixUntilItIsFree) {
  const fs::path state = fs::path(output()) / ".state";
  fs::create_directories(state);
  const int lock = ::open((state / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  ASSERT_GE(lock, 0);
  ASSERT_EQ(::flock(lock, LOCK_EX | LOCK_NB), 0);
  EXPECT_TRUE(is_error(bake({}), 6, output(), "Another bake"));
  ::close(lock);
  EXPECT_EQ(bake({}).code, 0);
}

TEST_F(OutputFolderTest, DebugPicturesAreOfTheFramesOfTheMapsAndOfTheLast) {
  const std::string pictures = folder / "pictures" / "here";
  const Words words{"bake",
                    samples + "/S4_crumple.glb",
                    "-o",
                    output(),
                    "--triangles",
                    "100",
                    "--frames",
                    "1-9",
                    "--map-size",
                    "8",
                    "--debug-pictures"};
  const auto draw = [&](const std::string& into, const Words& more) {
    Words all = words;
    all.push_back(into);
    all.insert(all.end(), more.begin(), more.end());
    return run(all).code;
  };
  ASSERT_EQ(draw(pictures, {}), 0);
  std::set<std::string> found;
  for (const auto& entry : fs::directory_iterator(pictures)) found.insert(entry.path().filename());
  EXPECT_EQ(found, (std::set<std::string>{"S4_crumple.0001.png", "S4_crumple.0007.png",
                                          "S4_crumple.0009.png"}));
  const std::string bytes = read(pictures + "/S4_crumple.0007.png");
  EXPECT_EQ(bytes.substr(1, 3), "PNG");

  const std::string others = folder / "others";
  ASSERT_EQ(draw(others, {"--map-frames", "3-7x4", "--threads", "1"}), 0);
  EXPECT_FALSE(fs::exists(others + "/S4_crumple.0001.png"));
  EXPECT_TRUE(fs::exists(others + "/S4_crumple.0003.png"));
  EXPECT_EQ(read(others + "/S4_crumple.0007.png"), bytes) << "same frame, same picture";
}

TEST_F(OutputFolderTest, AFileInTheWayOfTheDebugPicturesEndsWithSix) {
  write(folder / "pictures", "I was here first.");
  const Ended ended = bake({"--debug-pictures", folder / "pictures"});
  EXPECT_TRUE(is_error(ended, 6, folder / "pictures", "file is in the way"));
  EXPECT_NE(ended.err.find("--debug-pictures"), std::string::npos) << ended.err;
}

}  // namespace
}  // namespace paperbake
