#include "formats/scene/scene_colliders.h"
#include "tests/formats/scene/scene_fixture.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include <fstream>
#include <string>
#include <utility>
#include <vector>

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
  EXPECT_TRUE(scene.colliders[0].frames.empty());
}

TEST(SceneColliders, MoveTurnAndGrowWithTheirNodes) {
  HeldSheet fixture;
  const int table = fixture.mesh("collider", grid(1, 1, 0.5, 0.5));
  fixture.move(table, {1, 5}, {{0, 0, -0.1}, {0.4, 0, -0.1}});
  const int balloon = fixture.mesh("collider.balloon", grid(1, 1, 0.5, 0.5));
  fixture.scale(balloon, {1, 5}, {1, 2});
  const int mirror = fixture.mesh("collider.mirror", grid(1, 1, 0.5, 0.5));
  fixture.animate(mirror, "scale", {1 / 24.0, 5 / 24.0}, {1, 1, 1, -1, 3, 1});
  const Scene scene = read_scene(fixture.write("moving.gltf"));
  ASSERT_EQ(scene.colliders.size(), 3u);
  const ColliderMesh &moved = scene.colliders[0], &grown = scene.colliders[1],
                     &mirrored = scene.colliders[2];
  ASSERT_EQ(moved.frames.size(), 5u);
  EXPECT_NEAR(moved.x.col(2).maxCoeff(), -0.1, 1e-6);
  EXPECT_LT((moved.frames[2] - (moved.x.rowwise() + Eigen::RowVector3d(0.2, 0, 0))).norm(), 1e-6);
  ASSERT_EQ(grown.frames.size(), 5u);
  EXPECT_LT((grown.frames[2] - 1.5 * grown.x).norm(), 1e-6);  // about the origin of its node
  ASSERT_EQ(mirrored.frames.size(), 5u);
  EXPECT_LT((mirrored.frames[4].col(0) + mirrored.x.col(0)).norm(), 1e-6);
  EXPECT_FALSE(has_warning(scene, "collider"));
}

/// [m] The largest distance of a vertex that Blender evaluates from the nearest of a collider, over
/// all frames and colliders. tests/data/deforming_collider.py writes both.
double off_blender(const std::string& file) {
  const std::filesystem::path data = PAPERBAKE_DATA;
  const Scene scene = read_scene(data / file);
  const auto truth = nlohmann::json::parse(std::ifstream(data / "deforming_collider.json"));
  EXPECT_EQ(scene.colliders.size(), 2u);
  EXPECT_FALSE(has_warning(scene, "collider"));
  double most = 0;
  for (const ColliderMesh& collider : scene.colliders) {
    const auto& frames = truth.at(collider.name);
    EXPECT_EQ(collider.frames.size(), frames.size());
    for (std::size_t f = 0; f < collider.frames.size(); ++f)
      for (const auto& p : frames.at(f))
        most = std::max(most, (collider.frames[f].rowwise() - Eigen::RowVector3d(p[0], p[1], p[2]))
                                  .rowwise()
                                  .norm()
                                  .minCoeff());
  }
  return most;
}

TEST(SceneColliders, AreWhereBlenderPutsThemInEveryFrame) {
  EXPECT_LT(off_blender("deforming_collider.glb"), 1e-5);
}

TEST(SceneColliders, AreWhereBlenderPutsThemInEveryFrameOfAnFbx) {
  const Scene scene = read_scene(std::filesystem::path(PAPERBAKE_DATA) / "deforming_collider.fbx");
  if (scene.origin.at("curves").find("ufbx") == std::string::npos) GTEST_SKIP() << "needs ufbx";
  EXPECT_LT(off_blender("deforming_collider.fbx"), 1e-5);
}

/// A held sheet and meshes of these names in an empty, which is half a metre above the origin.
HeldSheet with_group(const std::string& empty, const std::string& extras,
                     const std::vector<std::pair<std::string, std::string>>& meshes) {
  HeldSheet fixture;
  std::vector<int> children;
  for (const auto& [name, own] : meshes) {
    children.push_back(fixture.mesh(name, grid(1, 1, 0.5, 0.5), own));
    fixture.make_child(children.back());
  }
  fixture.node(empty, {0, 0, 0.5}, extras,
               fmt::format(R"("children":[{}],)", fmt::join(children, ",")));
  return fixture;
}

TEST(SceneColliders, AnEmptyMakesCollidersOfTheMeshesBelowIt) {
  for (const auto& [empty, extras] :
       {std::pair("collider_hand", R"({"paper_friction":0.25})"),
        std::pair("hand", R"({"paper_collider":"outside","paper_friction":0.25})")}) {
    const HeldSheet fixture = with_group(empty, extras,
                                         {{"palm", "{}"},
                                          {"finger", R"({"paper_friction":0.5})"},
                                          {"ring", R"({"paper_collider":0})"}});
    const Scene scene = read_scene(fixture.write("group.gltf"));
    ASSERT_EQ(scene.colliders.size(), 2u) << empty;
    EXPECT_EQ(scene.colliders[0].name, "palm");
    EXPECT_EQ(scene.colliders[0].friction, 0.25);
    EXPECT_EQ(scene.colliders[1].friction, 0.5);
    EXPECT_EQ(scene.colliders[0].x.col(2).minCoeff(), 0.5) << "it goes with its empty";
    EXPECT_EQ(scene.colliders[0].paper_side == ColliderMesh::PaperSide::outside,
              std::string(empty) == "hand");
    EXPECT_FALSE(has_warning(scene, "collider"));
  }
}

TEST(SceneColliders, ASheetAndAHandleInAGroupStayWhatTheyAre) {
  const Scene scene =
      read_scene(with_group("collider.all", "{}",
                            {{"paper.above", "{}"}, {"handle.grip", "{}"}, {"box", "{}"}})
                     .write("roles.gltf"));
  EXPECT_EQ(scene.sheets.size(), 2u);
  EXPECT_EQ(handle(scene, "handle.grip").name, "handle.grip");
  ASSERT_EQ(scene.colliders.size(), 1u);
  EXPECT_EQ(scene.colliders[0].name, "box");
}

TEST(SceneColliders, WhatIsMeantAsOneAndIsNoneIsSaid) {
  HeldSheet fixture(grid(4, 4, 0.2, 0.2), R"({"paper_collider":true})");
  fixture.node("collider_lost", {0, 0, 0});
  const Scene scene = read_scene(fixture.write("lost.gltf"));
  EXPECT_TRUE(has_warning(scene, "\"collider_lost\" has no mesh"));
  EXPECT_TRUE(has_warning(scene, "\"paper\" is a sheet because of its name"));
  for (const char* word : {"insid", "[1, 2]"}) {
    HeldSheet typo;
    typo.mesh("box", grid(1, 1, 0.5, 0.5), fmt::format(R"({{"paper_collider":"{}"}})", word));
    EXPECT_ERROR(typo.write("typo.gltf"), "collider \"box\"\n  paper_collider is");
  }
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
