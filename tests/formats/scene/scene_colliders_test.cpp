#include "formats/scene/scene_colliders.h"
#include "tests/formats/scene/scene_fixture.h"

#include <gtest/gtest.h>

namespace paperbake::test {
namespace {

TEST(SceneColliders, AreFoundByNameAndByProperty) {
  HeldSheet fixture;
  fixture.mesh("Collider_Table.001", grid(1, 1, 0.5, 0.5), R"({"paper_friction":0.25})");
  fixture.mesh("floor", grid(2, 2, 0.5, 0.5), R"({"paper_collider":true})");
  fixture.mesh("tree", grid(1, 1, 0.5, 0.5));
  const Scene scene = read_scene(fixture.write("colliders.gltf"));
  ASSERT_EQ(scene.colliders.size(), 2u);
  EXPECT_EQ(scene.colliders[0].friction, 0.25);
  EXPECT_EQ(scene.sheets.at(0).friction, std::nullopt);
  EXPECT_EQ(scene.colliders[1].name, "floor");
  EXPECT_EQ(scene.colliders[1].friction, 0.4);
  EXPECT_EQ(scene.colliders[1].triangles.rows(), 8);
  EXPECT_TRUE(scene.colliders[0].motion.empty());
}

TEST(SceneColliders, MoveWithTheirNodesAndKeepTheirSize) {
  HeldSheet fixture;
  const int table = fixture.mesh("collider", grid(1, 1, 0.5, 0.5));
  fixture.move(table, {1, 5}, {{0, 0, -0.1}, {0.4, 0, -0.1}});
  const int balloon = fixture.mesh("collider.balloon", grid(1, 1, 0.5, 0.5));
  fixture.scale(balloon, {1, 5}, {1, 2});
  const Scene scene = read_scene(fixture.write("moving.gltf"));
  ASSERT_EQ(scene.colliders.size(), 2u);
  ASSERT_EQ(scene.colliders[0].motion.size(), 5u);
  EXPECT_NEAR(scene.colliders[0].x.col(2).maxCoeff(), -0.1, 1e-6);
  EXPECT_NEAR((scene.colliders[0].motion[2].translation() - Vector3d(0.2, 0, 0)).norm(), 0, 1e-6);
  EXPECT_TRUE(scene.colliders[1].motion.empty());
  EXPECT_TRUE(has_warning(scene, "The size of the collider \"collider.balloon\" is keyed"));
}

TEST(SceneColliders, ASheetNeedsNoHandleBesideOne) {
  GltfFixture fixture;
  fixture.mesh("paper", grid(4, 4, 0.2, 0.2));
  EXPECT_THROW(read_scene(fixture.write("nothing.gltf")), Error);
  fixture.mesh("collider", grid(1, 1, 1, 1));
  EXPECT_TRUE(read_scene(fixture.write("falls.gltf")).sheets.at(0).handles.empty());
}

}  // namespace
}  // namespace paperbake::test
