#include "formats/cache/alembic_cache.h"
#include "core/model/error.h"
#include "formats/cache/alembic_reader.h"
#include "formats/cache/content_hash.h"

#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <sys/resource.h>
#include <vector>

// The guarantees of the writer. How other programs read the files is tested in tests/interop/.

namespace paperbake {
namespace {

namespace fs = std::filesystem;

/// A unit square of 2 * cells * cells triangles at some height [m].
CacheFrame square(int cells, double height) {
  CacheFrame frame;
  const int side = cells + 1;
  frame.x.resize(side * side, 3);
  frame.uv.resize(side * side, 2);
  frame.triangles.resize(2 * cells * cells, 3);
  for (int i = 0; i < side * side; ++i) {
    frame.uv.row(i) << double(i % side) / cells, double(i / side) / cells;
    frame.x.row(i) << frame.uv.row(i), height;
  }
  for (int cell = 0; cell < cells * cells; ++cell) {
    const int corner = cell % cells + cell / cells * side;
    frame.triangles.row(2 * cell) << corner, corner + 1, corner + side + 1;
    frame.triangles.row(2 * cell + 1) << corner, corner + side + 1, corner + side;
  }
  return frame;
}

std::string bytes_in(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

template <class Number>
Number number_at(const std::string& bytes, std::size_t position) {
  Number number{};
  std::memcpy(&number, bytes.data() + position, sizeof number);
  return number;
}

/// The number of samples in the second time sampling of the file. The samplings are the fifth child
/// of the root.
std::uint32_t frames_on_the_clock(const std::string& bytes) {
  const auto root = number_at<std::uint64_t>(bytes, 8);
  const auto samplings =
      number_at<std::uint64_t>(bytes, root + 8 + 4 * 8) & ~(std::uint64_t{1} << 63);
  // after the size and the first sampling
  return number_at<std::uint32_t>(bytes, samplings + 8 + 24);
}

class AlembicCacheTest : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(testing::TempDir()) /
             testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }

  /// The bytes of a cache of one sheet.
  std::string cache_of(const std::vector<CacheFrame>& frames) const {
    AlembicWriter writer(folder / "cache.abc", {}, {"paper"});
    for (const CacheFrame& frame : frames) writer.add_frame(0, frame);
    writer.finish();
    return bytes_in(folder / "cache.abc");
  }

  fs::path folder;
};

std::vector<CacheFrame> rising(int frames, int cells) {
  std::vector<CacheFrame> sequence;
  for (int i = 0; i < frames; ++i) sequence.push_back(square(cells, 1 + i));
  return sequence;
}

// [bytes] references of a frame to P (data and dimensions) and to the box in mesh, Xform and
// archive
constexpr std::size_t references = 2 * 8 + 3 * 8;

TEST_F(AlembicCacheTest, TheSameCallsWriteTheSameBytes) {
  const std::string once = cache_of(rising(4, 3));
  ASSERT_GT(once.size(), 1000u);
  EXPECT_EQ(once.substr(0, 8), std::string("Ogawa\xFF\0\1", 8));  // finished, version 1
  EXPECT_EQ(cache_of(rising(4, 3)), once);
  EXPECT_NE(cache_of(rising(5, 3)), once);
}

/// [bytes] size of a frame of the only sheet with new positions and nothing else new.
std::size_t cost_of_positions(std::size_t vertices) {
  const std::size_t head = 8 + 16;  // size and key of a block
  return head + 12 * vertices + head + 6 * 8 + references;
}

TEST_F(AlembicCacheTest, AFrameOfConstantTopologyCostsPositionsAndBoundsOnly) {
  const std::size_t four = cache_of(rising(4, 20)).size(), five = cache_of(rising(5, 20)).size();
  EXPECT_EQ(five - four, cost_of_positions(21 * 21));  // no faces, no uv
}

TEST_F(AlembicCacheTest, ASheetThatNeverMovesCostsNothingPerFrame) {
  const std::string one = cache_of({square(5, 1)});
  EXPECT_EQ(cache_of(std::vector<CacheFrame>(9, square(5, 1))).size(), one.size());
}

TEST_F(AlembicCacheTest, AFrameSeenBeforeIsReferredTo) {
  std::vector<CacheFrame> frames = rising(4, 20);
  const std::size_t before = cache_of(frames).size();
  frames.push_back(frames[1]);
  EXPECT_EQ(cache_of(frames).size() - before, references);
}

TEST_F(AlembicCacheTest, ANewMeshStoresItsFacesAndUvOnce) {
  std::vector<CacheFrame> frames = rising(3, 6);
  frames.push_back(square(20, 4));
  const std::size_t cut = cache_of(frames).size();
  frames.push_back(square(20, 5));
  EXPECT_EQ(cache_of(frames).size() - cut, cost_of_positions(21 * 21));
}

TEST_F(AlembicCacheTest, AttributesAreParametersOfTheirTypeAndStoredOnce) {
  const auto with = [](const std::vector<MeshSurface::Attribute>& attributes, int frames) {
    std::vector<CacheFrame> all = rising(frames, 1);
    MeshSurface surface;
    surface.attributes = attributes;
    const auto shared = std::make_shared<const MeshSurface>(surface);
    for (CacheFrame& frame : all) {
      frame.surface = shared;
      frame.uv.resize(0, 2);  // only the attributes belong to corners
    }
    return all;
  };
  const auto metadata = [&](AttributeKind kind, int width) {
    const std::string bytes = cache_of(
        with({{"dye", kind, AttributeValues::Constant(1, width, 0.5), Triangles::Zero(2, 3)}}, 1));
    std::vector<std::string> found;
    for (std::size_t at = 0; (at = bytes.find("arrayExtent=", at)) != std::string::npos; ++at) {
      const std::string text = bytes.substr(at, bytes.find("float32_t", at) - at);
      if (text.find("fvr") != std::string::npos) found.push_back(text);
    }
    return found.empty() ? std::string() : found.front();
  };
  const auto expected = [](int list, const std::string& means, int extent) {
    return "arrayExtent=" + std::to_string(list) + ";geoScope=fvr" +
           (means.empty() ? "" : ";interpretation=" + means) +
           ";isGeomParam=true;podExtent=" + std::to_string(extent) + ";podName=";
  };
  EXPECT_EQ(metadata(AttributeKind::colour, 3), expected(1, "rgb", 3));
  EXPECT_EQ(metadata(AttributeKind::colour, 4), expected(1, "rgba", 4));
  EXPECT_EQ(metadata(AttributeKind::number, 1), expected(1, "", 1));
  EXPECT_EQ(metadata(AttributeKind::number, 2), expected(2, "", 1)) << "no V2f, which is a uv set";
  EXPECT_EQ(metadata(AttributeKind::number, 3), expected(1, "vector", 3));
  EXPECT_EQ(metadata(AttributeKind::number, 4), expected(4, "", 1));
  MeshSurface::Attribute dye{"dye", AttributeKind::colour, AttributeValues::Random(6, 4),
                             (Triangles(2, 3) << 0, 1, 2, 3, 4, 5).finished()};
  EXPECT_EQ(cache_of(with({dye}, 9)).size() - cache_of(with({dye}, 8)).size(),
            cache_of(with({}, 9)).size() - cache_of(with({}, 8)).size())
      << "what does not change costs nothing per frame";
}

TEST_F(AlembicCacheTest, TheContentHashIsThatOfTheYUpPositions) {
  CacheFrame point;
  point.x.resize(1, 3);
  point.x << 1, 2, 3;
  const float stored[] = {1, 3, -2};
  AlembicWriter writer(folder / "cache.abc", {}, {"paper"});
  EXPECT_EQ(writer.add_frame(0, point),
            hex(content_hash({reinterpret_cast<const char*>(stored), sizeof stored})));
}

TEST_F(AlembicCacheTest, NegativeZeroHasTheHashOfZero) {
  CacheFrame zero = square(1, 0), minus = zero;
  minus.x = -minus.x.array() * 0.0;
  zero.x.setZero();
  ASSERT_TRUE(std::signbit(minus.x(3, 0)));
  AlembicWriter writer(folder / "cache.abc", {}, {"paper"});
  EXPECT_EQ(writer.add_frame(0, zero), writer.add_frame(0, minus));
}

TEST_F(AlembicCacheTest, RefusesNonFiniteNumbersAndNamesSheetFrameAndVertex) {
  const double none = std::numeric_limits<double>::quiet_NaN(),
               endless = std::numeric_limits<double>::infinity();
  for (const double bad :
       {none, endless, -endless, 1e300}) {  // 1e300 is infinite as a 32-bit float
    CacheInfo info;
    info.first_frame = 1001;
    AlembicWriter writer(folder / "cache.abc", info, {"table", "letter.001"});
    writer.add_frame(1, square(2, 1));
    CacheFrame frame = square(2, 2);
    frame.x(7, 1) = bad;
    try {
      writer.add_frame(1, frame);
      FAIL() << bad << " was taken";
    } catch (const Error& error) {
      EXPECT_EQ(error.code, ErrorCode::simulation);
      EXPECT_EQ(error.place, "sheet \"letter.001\", frame 1002");
      EXPECT_NE(error.cause.find("position of vertex 7"), std::string::npos) << error.cause;
    }
  }
}

TEST_F(AlembicCacheTest, RefusesNonFiniteNumbersInEveryChannel) {
  AlembicWriter writer(folder / "cache.abc", {}, {"paper"});
  const double none = std::numeric_limits<double>::quiet_NaN();
  CacheFrame velocity = square(1, 1), normal = velocity, uv = velocity;
  velocity.velocity = velocity.x;
  velocity.velocity(0, 2) = none;
  normal.normal = normal.x;
  normal.normal(3, 0) = none;
  uv.uv(1, 1) = none;
  EXPECT_THROW(writer.add_frame(0, velocity), Error);
  EXPECT_THROW(writer.add_frame(0, normal), Error);
  EXPECT_THROW(writer.add_frame(0, uv), Error);
}

TEST_F(AlembicCacheTest, ARefusedFrameLeavesNoTrace) {
  const std::string good = cache_of(rising(2, 4));
  AlembicWriter writer(folder / "refused.abc", {}, {"paper"});
  for (const CacheFrame& frame : rising(2, 4)) writer.add_frame(0, frame);
  CacheFrame bad = square(4, 3);
  bad.uv(24, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(writer.add_frame(0, bad), Error);
  writer.finish();
  EXPECT_EQ(bytes_in(folder / "refused.abc"), good);
}

TEST_F(AlembicCacheTest, SheetsMayHaveDifferentNumbersOfFrames) {
  AlembicWriter writer(folder / "cache.abc", {}, {"long", "short", "none"});
  for (const CacheFrame& frame : rising(3, 2)) writer.add_frame(0, frame);
  for (const CacheFrame& frame : rising(2, 4)) writer.add_frame(1, frame);
  EXPECT_EQ(writer.finish(), (std::vector<std::size_t>{3, 2, 0}));
  EXPECT_EQ(frames_on_the_clock(bytes_in(folder / "cache.abc")), 3u);
  const AlembicReader reader(folder / "cache.abc");
  ASSERT_EQ(reader.sheets().size(), 2u);
  EXPECT_EQ(reader.sheets()[0].frames, 3u);
  EXPECT_EQ(reader.sheets()[1].frames, 2u);
}

TEST_F(AlembicCacheTest, KeepsTheFramesBeforeTheDiskIsFull) {
  const std::vector<CacheFrame> frames = rising(12, 30);  // about 23 kB a frame
  const std::string whole = cache_of(frames);
  rlimit before;
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{whole.size() / 2, before.rlim_max};  // simulates a disk that fills up
  const auto old = std::signal(SIGXFSZ, SIG_IGN);
  std::size_t given = 0;
  std::vector<std::size_t> kept;
  setrlimit(RLIMIT_FSIZE, &small);
  {
    AlembicWriter writer(folder / "full.abc", {}, {"paper"});
    try {
      for (; given < frames.size(); ++given) writer.add_frame(0, frames[given]);
    } catch (const Error& error) {
      EXPECT_EQ(error.code, ErrorCode::folder);
    }
    kept = writer.finish();
  }
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, old);
  ASSERT_LT(given, frames.size());
  ASSERT_EQ(kept.size(), 1u);
  EXPECT_GE(kept[0] + 2, given);  // one did not fit, and one made room for the index
  ASSERT_GE(kept[0], 3u);
  // the same bytes as the cache of a shorter shot
  EXPECT_EQ(bytes_in(folder / "full.abc"), cache_of({frames.begin(), frames.begin() + kept[0]}));
}

TEST_F(AlembicCacheTest, NamesBecomeLegalAndStayUnique) {
  AlembicWriter writer(folder / "cache.abc", {}, {"a.b", "a_b", "a/b"});
  for (std::size_t sheet = 0; sheet < 3; ++sheet) writer.add_frame(sheet, square(1, sheet));
  writer.finish();
  const std::string bytes = bytes_in(folder / "cache.abc");
  for (const char* name : {"a_bShape", "a_b_2Shape", "a_b_3Shape"})
    EXPECT_NE(bytes.find(name), std::string::npos) << name;
  EXPECT_EQ(bytes.find("a.b"), std::string::npos);
}

TEST_F(AlembicCacheTest, MetadataCannotBreakOutOfItsPair) {
  CacheInfo info;
  info.metadata = {{"job", "x;_ai_Application=other"}};
  AlembicWriter writer(folder / "cache.abc", info, {"paper"});
  writer.add_frame(0, square(1, 1));
  writer.finish();
  const std::string bytes = bytes_in(folder / "cache.abc");
  EXPECT_NE(bytes.find("_ai_Application=paperbake;job=x__ai_Application_other"), std::string::npos);
}

TEST_F(AlembicCacheTest, WithoutFinishThereIsNoFile) {
  {
    AlembicWriter writer(folder / "cache.abc", {}, {"paper"});
    writer.add_frame(0, square(10, 1));
    EXPECT_TRUE(fs::exists(folder / "cache.abc.part"));
    EXPECT_FALSE(fs::exists(folder / "cache.abc"));
  }
  EXPECT_TRUE(fs::is_empty(folder));
}

TEST_F(AlembicCacheTest, AnOldCacheStaysUntilTheNewOneIsFinished) {
  const std::string old = cache_of(rising(2, 2));
  AlembicWriter writer(folder / "cache.abc", {}, {"paper"});
  writer.add_frame(0, square(3, 1));
  EXPECT_EQ(bytes_in(folder / "cache.abc"), old);
  writer.finish();
  EXPECT_NE(bytes_in(folder / "cache.abc"), old);
  EXPECT_FALSE(fs::exists(folder / "cache.abc.part"));
}

TEST_F(AlembicCacheTest, AFolderThatCannotBeWrittenIsAFolderError) {
  std::ofstream(folder / "plain") << "a file, not a folder";
  for (const char* place : {"plain/cache.abc", "missing/cache.abc"}) try {
      AlembicWriter writer(folder / place, {}, {"paper"});
      FAIL() << place << " was made";
    } catch (const Error& error) {
      EXPECT_EQ(error.code, ErrorCode::folder);
      EXPECT_NE(error.place.find("cache.abc"), std::string::npos) << error.place;
    }
}

}  // namespace
}  // namespace paperbake
