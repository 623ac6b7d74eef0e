#include "formats/scene/scene_winds.h"
#include "tests/formats/scene/scene_fixture.h"

#include <gtest/gtest.h>

namespace paperbake::test {
namespace {

TEST(SceneWinds, AreEmptiesWhoseAxisIsTheirDirection) {
  HeldSheet fixture;
  fixture.node("Wind.001", {0, 0, 0}, R"({"paper_speed":3,"paper_gust":0.2,"paper_seed":7})");
  fixture.node("wind_side", {0, 0, 0}, R"({"paper_axis":"-x"})");
  fixture.node("window", {0, 0, 0});
  fixture.mesh("wind.mill", grid(1, 1, 0.5, 0.5));
  const Scene scene = read_scene(fixture.write("winds.gltf"));
  ASSERT_EQ(scene.winds.size(), 2u);
  EXPECT_LT((scene.winds[0].velocity.row(0) - Eigen::RowVector3d(0, 0, 3)).norm(), 1e-6);
  EXPECT_EQ(scene.winds[0].gust, 0.2);
  EXPECT_EQ(scene.winds[0].seed, 7u);
  EXPECT_LT((scene.winds[1].velocity.row(0) - Eigen::RowVector3d(-1, 0, 0)).norm(), 1e-6);
}

TEST(SceneWinds, TurnAndRiseWithTheirKeys) {
  HeldSheet fixture;
  fixture.scale(fixture.node("wind.rises", {0, 0, 0}, R"({"paper_speed":4})"), {1, 5}, {0, 0.5});
  const float s = std::sqrt(0.5f);
  // a quarter of a turn about x of the file: from +y (up) to +z (towards -y of the world)
  fixture.animate(fixture.node("wind.turns", {0, 0, 0}), "rotation", {1 / 24.0, 5 / 24.0},
                  {0, 0, 0, 1, s, 0, 0, s});
  const Scene scene = read_scene(fixture.write("keyed_wind.gltf"));
  ASSERT_EQ(scene.winds.size(), 2u);
  const Points3 &rises = scene.winds[0].velocity, &turns = scene.winds[1].velocity;
  ASSERT_EQ(rises.rows(), 5);
  EXPECT_LT(rises.row(0).norm(), 1e-6);
  EXPECT_NEAR(rises.row(2).norm(), 2, 1e-4);
  EXPECT_LT((rises.row(4) - Eigen::RowVector3d(0, 0, 4)).norm(), 1e-4);
  EXPECT_LT((turns.row(0) - Eigen::RowVector3d(0, 0, 1)).norm(), 1e-4);
  EXPECT_LT((turns.row(4) - Eigen::RowVector3d(0, -1, 0)).norm(), 1e-4);
}

TEST(SceneWinds, ASheetNeedsNoHandleInTheWind) {
  GltfFixture fixture;
  fixture.mesh("paper", grid(4, 4, 0.2, 0.2));
  fixture.node("wind", {0, 0, 0});
  EXPECT_TRUE(read_scene(fixture.write("blown.gltf")).sheets.at(0).handles.empty());
}

TEST(SceneWinds, AnAxisThatIsNoneIsAnError) {
  HeldSheet fixture;
  fixture.node("wind", {0, 0, 0}, R"({"paper_axis":"up"})");
  EXPECT_THROW(read_scene(fixture.write("odd_wind.gltf")), Error);
}

}  // namespace
}  // namespace paperbake::test
