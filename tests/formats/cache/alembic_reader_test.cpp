#include "formats/cache/alembic_reader.h"

#include "core/geometry/random.h"
#include "core/model/error.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

// The reader returns what the writer has written and refuses everything else. Whether the files are
// valid Alembic is tested with other programs in tests/interop/.

namespace paperbake {
namespace {

namespace fs = std::filesystem;

/// A square of two triangles at some height [m].
CacheFrame square(double height) {
  CacheFrame frame;
  frame.x.resize(4, 3);
  frame.uv.resize(4, 2);
  frame.triangles.resize(2, 3);
  for (int i = 0; i < 4; ++i) frame.uv.row(i) << i % 2, i / 2;
  frame.x << frame.uv, Eigen::Vector4d::Constant(height);
  frame.triangles << 0, 1, 3, 0, 3, 2;
  frame.normal = Eigen::RowVector3d::UnitZ().replicate(4, 1);
  frame.velocity = Eigen::RowVector3d(0, -2, 24).replicate(4, 1);
  return frame;
}

/// The same square with both diagonals and a vertex in the middle.
CacheFrame changed_square(double height) {
  CacheFrame frame = square(height);
  frame.x.conservativeResize(5, 3);
  frame.uv.conservativeResize(5, 2);
  frame.x.row(4) << 0.5, 0.5, height;
  frame.uv.row(4) << 0.5, 0.5;
  frame.triangles.resize(4, 3);
  frame.triangles << 0, 1, 4, 1, 3, 4, 3, 2, 4, 2, 0, 4;
  frame.normal = Eigen::RowVector3d::UnitZ().replicate(5, 1);
  frame.velocity = Eigen::RowVector3d(0, -2, 24).replicate(5, 1);
  return frame;
}

class AlembicReaderTest : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(testing::TempDir()) /
             testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::create_directories(folder);
    file = folder / "cache.abc";
  }
  void TearDown() override { fs::remove_all(folder); }

  /// Writes two sheets: one that rises with pauses, and one whose mesh changes. Returns the content
  /// hashes of the first.
  std::vector<std::string> write() const {
    AlembicWriter writer(file, CacheInfo{25, 1001, 2, {{"paperbake_job", "abc"}}},
                         {"paper", "paper.two"});
    std::vector<std::string> keys;
    for (int i = 0; i < 6; ++i) {
      keys.push_back(writer.add_frame(0, square(heights[i])));
      writer.add_frame(1, i < 3 ? square(i) : changed_square(i));
    }
    writer.finish();
    return keys;
  }
  std::string bytes() const {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void write(const std::string& bytes) const { std::ofstream(file, std::ios::binary) << bytes; }

  static constexpr double heights[6] = {0, 0, 0, 0.25, 0.25, 0.5};
  fs::path folder, file;
};

TEST_F(AlembicReaderTest, GivesBackWhatWasWritten) {
  const std::vector<std::string> keys = write();
  const AlembicReader cache(file);
  EXPECT_EQ(cache.info().fps, 25);
  EXPECT_EQ(cache.info().first_frame, 1001);
  EXPECT_EQ(cache.info().frame_step, 2);
  EXPECT_EQ(std::count(cache.info().metadata.begin(), cache.info().metadata.end(),
                       std::pair<std::string, std::string>("paperbake_job", "abc")),
            1);
  ASSERT_EQ(cache.sheets().size(), 2u);
  EXPECT_EQ(cache.sheets()[0].name, "paper");
  EXPECT_EQ(cache.sheets()[1].name, "paper_two");
  EXPECT_TRUE(cache.sheets()[0].constant_topology);
  EXPECT_FALSE(cache.sheets()[1].constant_topology);
  for (std::size_t i = 0; i < 6; ++i) {
    ASSERT_EQ(cache.sheets()[0].frames, 6u);
    for (std::size_t sheet : {0, 1}) {
      const CacheFrame read = cache.frame(sheet, i), given = sheet == 0 ? square(heights[i])
                                                             : i < 3    ? square(i)
                                                                        : changed_square(i);
      EXPECT_TRUE(read.x == given.x && read.velocity == given.velocity &&
                  read.normal == given.normal && read.uv == given.uv)
          << i;
      EXPECT_TRUE(read.triangles == given.triangles) << i;  // starting with the same corner
    }
    EXPECT_EQ(cache.content_hash(0, i), keys[i]);
  }
}

TEST_F(AlembicReaderTest, RefusesDamagedAndUnfinishedCaches) {
  write();
  const std::string whole = bytes();
  const auto refused = [&](const std::string& damaged) {
    write(damaged);
    try {
      const AlembicReader cache(file);
      for (std::size_t s = 0; s < cache.sheets().size(); ++s)
        for (std::size_t i = 0; i < cache.sheets()[s].frames; ++i) cache.frame(s, i);
    } catch (const Error& error) {
      EXPECT_EQ(error.code, ErrorCode::scene);
      EXPECT_EQ(error.place, file.string());
      return true;
    }
    return false;
  };
  EXPECT_FALSE(refused(whole));
  EXPECT_TRUE(refused(""));
  EXPECT_TRUE(refused("Ogawa"));
  EXPECT_TRUE(refused(whole.substr(0, whole.size() - 1)));
  std::string unfinished = whole;
  unfinished[5] = 0;
  EXPECT_TRUE(refused(unfinished));
  fs::remove(file);
  EXPECT_THROW(AlembicReader{file}, Error);
  EXPECT_THROW(AlembicReader{folder}, Error);
}

// A few bytes can claim an endless number of equal frames; a loop over all frames must end.
TEST_F(AlembicReaderTest, RefusesAnImplausibleNumberOfFrames) {
  AlembicWriter writer(file, CacheInfo{}, {"paper"});
  for (int i = 0; i < 70000; ++i) writer.add_frame(0, square(0));
  writer.finish();
  std::string whole = bytes();
  EXPECT_EQ(AlembicReader(file).sheets()[0].frames, 70000u);
  // 70000, little-endian
  const std::string count{"\x70\x11\x01\0", 4}, absurd{"\xff\xff\xff\x7f", 4};
  int found = 0;
  for (std::size_t at = 0; (at = whole.find(count, at)) != std::string::npos; at += 4, ++found)
    whole.replace(at, 4, absurd);
  ASSERT_GT(found, 0);
  write(whole);
  try {
    const AlembicReader cache(file);
    ADD_FAILURE() << cache.sheets()[0].frames;
  } catch (const Error& error) {
    EXPECT_NE(error.cause.find("2147483647 frames"), std::string::npos) << error.what();
  }
}

// Damaged values are always detected by their hashes; any other damage must not crash the reader.
TEST_F(AlembicReaderTest, ReturnsOrThrowsOnAnyBytes) {
  write();
  const std::string whole = bytes();
  int refused = 0, rounds = 600;
  for (int round = 0; round < rounds; ++round) {
    std::string damaged = whole;
    const std::uint64_t draw = 10 * static_cast<std::uint64_t>(round);
    for (std::uint64_t k = 0; k <= draw % 3; ++k)
      damaged[scramble(draw + 2 * k) % whole.size()] =
          static_cast<char>(scramble(draw + 2 * k + 1));
    if (round % 10 == 0) damaged.resize(damaged.size() / 2);
    write(damaged);
    try {
      const AlembicReader cache(file);
      for (std::size_t s = 0; s < cache.sheets().size(); ++s)
        for (std::size_t i = 0; i < std::min<std::size_t>(cache.sheets()[s].frames, 100); ++i)
          cache.frame(s, i);
    } catch (const Error& error) {
      ++refused;
    }
  }
  EXPECT_GT(refused, rounds / 2);  // the rest hits metadata, bounds and names
}

}  // namespace
}  // namespace paperbake
