// Prescribed creases from edges in the scene.

#include "formats/scene/scene_file.h"

#include "tests/formats/scene/scene_fixture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace paperbake {
namespace {

using test::error_of;
using test::grid;
using test::has_warning;
using test::HeldSheet;
using test::sample;

const std::filesystem::path data =
    std::filesystem::path(PAPERBAKE_SAMPLES).parent_path() / "tests" / "data";

using Line = std::vector<Vector2d>;

/// Largest distance [m] of corresponding points of two polylines, in either direction.
double max_distance(const Line& a, Line b) {
  if (a.size() != b.size()) return INFINITY;
  if ((a.front() - b.front()).norm() > (a.front() - b.back()).norm())
    std::reverse(b.begin(), b.end());
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, (a[i] - b[i]).norm());
  return worst;
}

/// The prescribed creases of the only sheet.
const std::vector<PrescribedCrease>& creases(const Scene& scene) {
  return scene.sheets.at(0).pattern.prescribed_creases;
}

TEST(SceneCreases, EdgesBecomeOnePolylineWithTheAngleOfTheirNode) {
  HeldSheet held;
  held.lines("crease.bend", {{0.05, 0, 0}, {0.05, 0.1, 0}, {0.05, 0.05, 0}, {0.2, 0.15, 0}},
             {0, 2, 2, 1, 1, 3}, R"({"paper_crease":30})");
  const Scene scene = read_scene(held.write("bend.gltf"));
  ASSERT_EQ(creases(scene).size(), 1u);
  EXPECT_LT(max_distance(creases(scene)[0].line, {{0.05, 0}, {0.05, 0.1}, {0.2, 0.15}}), 1e-7);
  EXPECT_NEAR(creases(scene)[0].angle, EIGEN_PI / 6, 1e-12);
  EXPECT_EQ(scene.sheets[0].crease_origin, std::vector<std::string>{"\"crease.bend\""});
  EXPECT_FALSE(has_warning(scene, "paper_crease"));
}

TEST(SceneCreases, BranchesAreSeparatePolylinesAndLoopsAreClosed) {
  HeldSheet held;
  const std::vector<Vector3d> star{{0.1, 0.1, 0}, {0, 0.1, 0}, {0.2, 0.1, 0}, {0.1, 0.2, 0}};
  held.lines("crease.star", star, {0, 1, 0, 2, 0, 3});
  EXPECT_EQ(creases(read_scene(held.write("star.gltf"))).size(), 3u);
  HeldSheet ring;
  ring.lines("crease.ring", {{0.05, 0.05, 0}, {0.15, 0.05, 0}, {0.1, 0.15, 0}}, {0, 1, 1, 2, 2, 0});
  const Scene scene = read_scene(ring.write("ring.gltf"));
  ASSERT_EQ(creases(scene).size(), 1u);
  ASSERT_EQ(creases(scene)[0].line.size(), 4u);
  EXPECT_EQ(creases(scene)[0].line.front(), creases(scene)[0].line.back());
}

TEST(SceneCreases, LieOnTheSheetAsItIsAtTheFirstFrame) {
  const double radius = 0.1;
  HeldSheet held(grid(40, 4, 0.2, 0.2, nullptr, [&](double u, double v) {
    return Vector3d(radius * std::sin(u / radius), v, radius * std::cos(u / radius));
  }));
  const auto at = [&](double u, double v) {
    return Vector3d(radius * std::sin(u / radius), v, radius * std::cos(u / radius));
  };
  held.lines("crease", {at(0.1, 0.05), at(0.1, 0.15)}, {0, 1});
  EXPECT_LT(max_distance(creases(read_scene(held.write("rolled.gltf"))).at(0).line,
                         {{0.1, 0.05}, {0.1, 0.15}}),
            1e-4);
}

// A sheet folded in a Z: its first fold points up, to the side of its normals, the second down.
TEST(SceneCreases, ModelledCreasesHaveTheAnglesOfTheSheetAtTheFirstFrame) {
  const double turn = 60 * EIGEN_PI / 180, run = 0.05 * std::cos(turn / 2),
               rise = 0.05 * std::sin(turn / 2);
  const auto at = [&](double u, double v) {
    const double parts = u / 0.05;
    const double height = parts < 1 ? parts : parts < 3 ? 2 - parts : parts - 4;
    return Vector3d(parts * run, v, height * rise);
  };
  HeldSheet held(grid(4, 2, 0.2, 0.1, nullptr, at));
  EXPECT_TRUE(has_warning(read_scene(held.write("unmarked_folds.gltf")),
                          "begins folded by 60 degrees at (50.0, "));
  held.lines("crease", {at(0.05, 0), at(0.05, 0.1), at(0.15, 0), at(0.15, 0.1)}, {1, 0, 2, 3},
             R"({"paper_crease":"modelled"})");
  const Scene scene = read_scene(held.write("modelled.gltf"));
  ASSERT_EQ(creases(scene).size(), 2u);
  for (const PrescribedCrease& crease : creases(scene))
    EXPECT_NEAR(crease.angle, crease.line[0].x() < 0.1 ? turn : -turn, 1e-5);
  EXPECT_FALSE(has_warning(scene, "begins folded")) << "each fold is a crease";
  EXPECT_FALSE(has_warning(scene, "paper_crease"));
}

TEST(SceneCreases, TheSheetIsTheNearestOrTheOneNamed) {
  HeldSheet held;
  test::FlatMesh above = grid(2, 2, 0.2, 0.2);
  for (Vector3d& p : above.x) p.z() += 5e-4;
  held.mesh("paper.above", above);
  held.lines("crease.near", {{0, 0.1, 5e-4}, {0.2, 0.1, 5e-4}}, {0, 1});
  held.lines("crease.told", {{0.1, 0, 5e-4}, {0.1, 0.2, 5e-4}}, {0, 1},
             R"({"paper_target":"paper"})");
  const Scene scene = read_scene(held.write("two.gltf"));
  EXPECT_EQ(scene.sheets.at(0).crease_origin, std::vector<std::string>{"\"crease.told\""});
  EXPECT_EQ(scene.sheets.at(1).crease_origin, std::vector<std::string>{"\"crease.near\""});
}

TEST(SceneCreases, EdgesThatCannotBeCreasesAreErrors) {
  const auto with = [](const std::vector<Vector3d>& points, const std::string& extras = "{}",
                       const std::string& name = "crease.x") {
    HeldSheet held(grid(4, 4, 0.2, 0.2, [](int i, int j) { return i < 2 || j < 2; }));
    held.lines(name, points, {0, 1}, extras);
    return held.write("wrong_crease.gltf");
  };
  EXPECT_ERROR(with({{0.05, 0.05, 0.003}, {0.05, 0.1, 0}}),
               "crease \"crease.x\"\n  The crease is 3 mm off the sheet \"paper\", at (0.05, 0.05, "
               "0.003) m.");
  EXPECT_ERROR(with({{0.2, 0.05, 0}, {0.05, 0.2, 0}}), "leaves the sheet \"paper\"");
  EXPECT_ERROR(with({{0.05, 0, 0}, {0.05, 0.1, 0}}, R"({"paper_crease":200})"), "from -170 to 170");
  EXPECT_ERROR(with({{0.05, 0, 0}, {0.05, 0.1, 0}}, R"({"paper_crease":"as folded"})"),
               "The property paper_crease is \"as folded\", not a number or \"modelled\".");
  EXPECT_ERROR(with({{0.05, 0, 0}, {0.05, 0.1, 0}}, R"({"paper_target":"papre"})"),
               "not a sheet of the scene");
  EXPECT_TRUE(has_warning(read_scene(with({{0, 0, 0}, {0.1, 0, 0}})), "lies along the border"));
  HeldSheet held;
  held.mesh("fold", grid(1, 1, 0.1, 0.1), R"({"paper_crease":0})");
  EXPECT_ERROR(held.write("faces_only.gltf"),
               "crease \"fold\"\n  The mesh has no edges without faces");
  HeldSheet lost;  // as Blender exports a mesh of edges with Loose Edges off
  lost.node("crease.lost", {0, 0, 0}, R"({"paper_crease":0})");
  EXPECT_ERROR(lost.write("no_mesh.gltf"),
               "crease \"crease.lost\"\n  The object has no edges without faces");
  EXPECT_TRUE(has_warning(
      read_scene(HeldSheet(grid(4, 4, 0.2, 0.2), R"({"paper_crease":20})").write("unmarked.gltf")),
      "no edge within it is marked"));
}

// Written by Blender's own exporters from one scene. In FBX the edges of the sheet's mesh at y =
// 0.1 have a crease weight and an angle of 40 degrees; in both files an object of two loose edges
// runs from a corner to the middle and on to the opposite side.
TEST(SceneCreases, BlendersCreasesAreRead) {
  const Scene fbx = read_scene(data / "creases.fbx"), gltf = read_scene(data / "creases.glb");
  const Line drawn{{0, 0}, {0.1, 0.05}, {0.2, 0.05}}, marked{{0, 0.1}, {0.2, 0.1}};
  ASSERT_EQ(creases(fbx).size(), 2u);
  ASSERT_EQ(creases(gltf).size(), 1u);
  EXPECT_LT(max_distance(creases(fbx)[0].line, drawn), 1e-6);
  EXPECT_LT(max_distance(creases(fbx)[1].line, marked), 1e-6);
  EXPECT_NEAR(creases(fbx)[1].angle * 180 / EIGEN_PI, 40, 1e-6);
  EXPECT_EQ(fbx.sheets[0].crease_origin[1], "edges marked in the mesh");
  EXPECT_LT(max_distance(creases(gltf)[0].line, drawn), 1e-6);
  EXPECT_NEAR(creases(gltf)[0].angle * 180 / EIGEN_PI, -20, 1e-6);
}

}  // namespace
}  // namespace paperbake
