// Frames that were rendered, kept for a bake that goes on.

#include "baker/bake/rendered_frames.h"

#include "tests/own_folder.h"

#include <gtest/gtest.h>

#include <fstream>

namespace paperbake {
namespace {

namespace fs = std::filesystem;

std::vector<RenderedSheet> frame(int number) {
  RenderedSheet sheet;
  sheet.frame = number;
  sheet.record_index = static_cast<std::size_t>(number - 1);
  sheet.mesh.x = Points3::Random(4, 3);
  sheet.mesh.velocity = Points3::Random(4, 3);
  sheet.mesh.normal = Points3::Random(5, 3);
  sheet.mesh.crease = Eigen::VectorXd::Random(4);
  sheet.mesh.layers = {{"foldAngle", Eigen::VectorXd::Random(4)}};
  sheet.mesh.triangles = (Triangles(2, 3) << 0, 1, 2, 0, 2, 3).finished();
  sheet.mesh.normal_of_corner = (Triangles(2, 3) << 0, 1, 2, 0, 2, 4).finished();
  sheet.mesh.uv = Points2::Random(4, 2);
  static const auto surface = std::make_shared<const MeshSurface>(MeshSurface{
      {{"print", AttributeKind::uv, AttributeValues::Random(5, 2),
        (Triangles(2, 3) << 0, 1, 2, 0, 2, 4).finished()},
       {"dye", AttributeKind::colour, AttributeValues::Random(4, 4),
        (Triangles(2, 3) << 0, 1, 2, 0, 2, 3).finished()}},
      {"newsprint"},
      {0, -1},
      {{"page", 3.0}, {"paper", std::string("Times")}, {"size", std::vector<double>{2, 3}}}});
  sheet.mesh.surface = surface;
  sheet.statistics.stretch_max = 0.01 * number;
  sheet.judgement.inside_of = "collider.hand";
  sheet.judgement.crossings = number;
  sheet.handle_error = 1e-4 * number;
  round_to_32_bits(sheet.mesh);
  return {sheet, sheet};
}

void expect_equal(const std::vector<RenderedSheet>& a, const std::vector<RenderedSheet>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t s = 0; s < a.size(); ++s) {
    EXPECT_EQ(a[s].frame, b[s].frame);
    EXPECT_EQ(a[s].mesh.x, b[s].mesh.x);
    EXPECT_EQ(a[s].mesh.velocity, b[s].mesh.velocity);
    EXPECT_EQ(a[s].mesh.normal, b[s].mesh.normal);
    EXPECT_EQ(a[s].mesh.crease, b[s].mesh.crease);
    EXPECT_EQ(a[s].mesh.layers.at(0).values, b[s].mesh.layers.at(0).values);
    EXPECT_EQ(a[s].mesh.triangles, b[s].mesh.triangles);
    EXPECT_EQ(a[s].mesh.normal_of_corner, b[s].mesh.normal_of_corner);
    EXPECT_EQ(a[s].mesh.uv, b[s].mesh.uv);
    ASSERT_TRUE(a[s].mesh.surface);
    const MeshSurface &x = *a[s].mesh.surface, &y = *b[s].mesh.surface;
    ASSERT_EQ(x.attributes.size(), 2u);
    ASSERT_EQ(y.attributes.size(), 2u);
    for (int n : {0, 1}) {
      EXPECT_EQ(x.attributes[n].name, y.attributes[n].name);
      EXPECT_EQ(x.attributes[n].kind, y.attributes[n].kind);
      EXPECT_TRUE(same_entries(x.attributes[n].values, y.attributes[n].values));
      EXPECT_EQ(x.attributes[n].of_corner, y.attributes[n].of_corner);
    }
    EXPECT_EQ(x.materials, y.materials);
    EXPECT_EQ(x.material_of, y.material_of);
    EXPECT_EQ(x.properties, y.properties);
    EXPECT_EQ(a[s].statistics.stretch_max, b[s].statistics.stretch_max);
    EXPECT_EQ(a[s].judgement.inside_of, b[s].judgement.inside_of);
    EXPECT_EQ(a[s].judgement.crossings, b[s].judgement.crossings);
    EXPECT_EQ(a[s].handle_error, b[s].handle_error);
  }
}

class RenderedFramesTest : public testing::Test {
 protected:
  void SetUp() override { fs::remove(path); }
  const fs::path path = test::own_folder() / "rendered.0";
  const std::vector<std::vector<RenderedSheet>> all{frame(1), frame(2), frame(3)};
};

TEST_F(RenderedFramesTest, AreTakenInOrderAsTheyWereToTheLastBit) {
  {
    RenderedFrames kept(path, "key", Resume::automatic);
    EXPECT_FALSE(kept.take());
    for (int k : {0, 1}) kept.add(all[k]);
  }
  {
    RenderedFrames kept(path, "key", Resume::automatic);
    for (int k : {0, 1}) {
      const auto taken = kept.take();
      ASSERT_TRUE(taken);
      expect_equal(*taken, all[k]);
    }
    EXPECT_FALSE(kept.take());
    kept.add(all[2]);
  }
  RenderedFrames kept(path, "key", Resume::automatic);
  std::optional<std::vector<RenderedSheet>> taken;
  for (int k = 0; k < 3; ++k) taken = kept.take();
  ASSERT_TRUE(taken);
  expect_equal(*taken, all[2]);
}

TEST_F(RenderedFramesTest, AnotherKeyOrADamagedEndIsDropped) {
  {
    RenderedFrames kept(path, "key", Resume::automatic);
    for (int k : {0, 1}) kept.add(all[k]);
  }
  fs::resize_file(path, fs::file_size(path) - 7);
  {
    RenderedFrames kept(path, "key", Resume::automatic);
    EXPECT_TRUE(kept.take());
    EXPECT_FALSE(kept.take());
    kept.add(all[2]);
  }
  {
    RenderedFrames kept(path, "key", Resume::automatic);
    EXPECT_TRUE(kept.take());
    const auto after = kept.take();
    ASSERT_TRUE(after);
    EXPECT_EQ(after->front().frame, 3);
  }
  RenderedFrames other(path, "other", Resume::automatic);
  EXPECT_FALSE(other.take());
}

TEST_F(RenderedFramesTest, NothingIsTakenByABakeThatDoesNotResume) {
  RenderedFrames(path, "key", Resume::automatic).add(all[0]);
  EXPECT_FALSE(RenderedFrames(path, "key", Resume::never).take());
}

TEST_F(RenderedFramesTest, AnEntryThatIsLargerThanAnyMemoryIsDropped) {
  std::ofstream(path, std::ios::binary) << std::string(64, '\xff');
  RenderedFrames kept(path, "key", Resume::automatic);
  EXPECT_FALSE(kept.take());
  kept.add(all[0]);
  RenderedFrames again(path, "key", Resume::automatic);
  EXPECT_TRUE(again.take());
}

TEST_F(RenderedFramesTest, ALinkIsNotFollowed) {
  const fs::path precious = test::own_folder() / "precious";
  std::ofstream(precious) << "mine";
  fs::create_symlink(precious, path);
  RenderedFrames(path, "key", Resume::automatic).add(all[0]);
  EXPECT_EQ(fs::file_size(precious), 4u);
  EXPECT_FALSE(fs::is_symlink(path));
}

}  // namespace
}  // namespace paperbake
