// The sheet and its pattern from meshes written by hand.

#include "core/geometry/pattern_mesh.h"
#include "core/model/segment2.h"
#include "formats/scene/scene_file.h"
#include "formats/scene/scene_properties.h"

#include "tests/formats/scene/scene_fixture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace paperbake {
namespace {

using test::error_of;
using test::FlatMesh;
using test::grid;
using test::handle;
using test::HeldSheet;

bool hole_in_the_middle(int i, int j) { return !(i == 2 && 1 <= j && j <= 2); }

// The orientation does not depend on the order of the faces, and the UVs need not have the
// proportions of the sheet.
TEST(SceneSheets, AnUnrolledSheetIsOrientedAsItsUvs) {
  for (int turned = 0; turned < 4; ++turned) {
    FlatMesh mesh = grid(3, 3, 0.2, 0.2);
    for (Vector2d& uv : mesh.uv) {
      for (int k = 0; k < turned; ++k) uv = Vector2d(1 - uv.y(), uv.x());
      uv = uv.cwiseProduct(Vector2d(1, 0.5)).eval();
    }
    std::rotate(mesh.corners.begin(), mesh.corners.begin() + 3 * turned, mesh.corners.end());
    HeldSheet held(mesh);
    const Vector2d corner = handle(read_scene(held.write("turned.gltf")), "handle.fixed").pattern;
    const Vector2d wanted[] = {{0, 0}, {0.2, 0}, {0.2, 0.2}, {0, 0.2}};
    EXPECT_NEAR((corner - wanted[turned]).norm(), 0, 1e-6) << turned;
  }
}

TEST(SceneSheets, AClosedMeshIsAnError) {
  FlatMesh box;
  for (int i = 0; i < 8; ++i)
    box.x.push_back(Vector3d(0.1 * (i & 1), 0.1 * (i >> 1 & 1), 0.001 * (i >> 2)));
  box.corners = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
  EXPECT_ERROR(HeldSheet(box).write("closed.gltf"),
               "The mesh is closed: a sheet of paper has a border.");
}

TEST(SceneSheets, HolesOfTheMeshAreHolesOfThePattern) {
  FlatMesh mesh = grid(5, 4, 0.25, 0.2, hole_in_the_middle);
  for (bool with_uv : {true, false}) {
    if (!with_uv) mesh.uv.clear();
    const Scene scene = read_scene(HeldSheet(mesh).write("hole.gltf"));
    const Pattern& pattern = scene.sheets.at(0).pattern;
    EXPECT_EQ(pattern.outline.size(), 4u);
    ASSERT_EQ(pattern.holes.size(), 1u);
    EXPECT_EQ(pattern.holes[0].size(), 4u);
    EXPECT_NEAR(area(pattern), 0.05 - 0.005, 1e-8);
    EXPECT_NEAR(longer_side(pattern), 0.25, 1e-7);
    EXPECT_FALSE(contains(pattern, {0.125, 0.1}));
  }
}

TEST(SceneSheets, AnLShapeKeepsItsReentrantCorner) {
  const Scene scene = read_scene(HeldSheet(grid(4, 4, 0.2, 0.2, [](int i, int j) {
                                   return i < 2 || j < 2;
                                 })).write("ell.gltf"));
  EXPECT_EQ(scene.sheets.at(0).pattern.outline.size(), 6u);
  EXPECT_NEAR(area(scene.sheets[0].pattern), 0.03, 1e-8);
}

/// Borders of a tray that lie in one line, apart from each other: rounding puts them to any side.
TEST(SceneSheets, ATrayDoesNotOverlapItself) {
  for (int k = 0; k < 100; ++k) {
    const double a = 0.03 + 0.001 * k, h = a / 2;
    FlatMesh tray;
    tray.x = {{0, 0, 0},     {a, 0, 0},     {a, a, 0},     {0, a, 0},     {0, -h, 0}, {a, -h, 0},
              {a + h, 0, 0}, {a + h, a, 0}, {a, a + h, 0}, {0, a + h, 0}, {-h, a, 0}, {-h, 0, 0}};
    tray.corners = {0, 1, 2, 0, 2, 3, 4, 5, 1, 4,  1, 0, 1,  6, 7,
                    1, 7, 2, 3, 2, 8, 3, 8, 9, 11, 0, 3, 11, 3, 10};
    const Eigen::AngleAxisd turn(0.1 * k, Vector3d::UnitZ());
    for (Vector3d& p : tray.x) p = turn * p;
    const Scene scene = read_scene(HeldSheet(tray).write("tray.gltf"));
    EXPECT_EQ(scene.sheets.at(0).pattern.outline.size(), 12u) << k;
  }
}

TEST(SceneSheets, ARolledSheetIsUnrolledWithoutUvs) {
  // a quarter turn of radius 0.1 in 40 chords of 2 r sin(pi / 160) each
  const auto roll = [](double u, double v) {
    return Vector3d(0.1 * std::sin(u / 0.1), v, 0.1 * std::cos(u / 0.1));
  };
  FlatMesh mesh = grid(40, 4, 0.05 * M_PI, 0.2, nullptr, roll);
  mesh.uv.clear();
  const Scene scene = read_scene(HeldSheet(mesh).write("roll.gltf"));
  const double arc = 40 * 0.2 * std::sin(M_PI / 160);
  EXPECT_NEAR(longer_side(scene.sheets.at(0).pattern), 0.2, 1e-6);
  // rounding of 32-bit positions adds up over 40 chords
  EXPECT_NEAR(shorter_side(scene.sheets[0].pattern), arc, 1e-6);
  EXPECT_EQ(scene.sheets[0].pattern.outline.size(), 4u);
}

TEST(SceneSheets, UvsThatDisagreeWithEdgeLengthsAreIgnored) {
  FlatMesh mesh = grid(4, 4, 0.2, 0.1);
  for (Vector2d& uv : mesh.uv) uv.y() *= 2;  // stretched to a square
  const Scene scene = read_scene(HeldSheet(mesh).write("stretched.gltf"));
  EXPECT_NEAR((extent(scene.sheets.at(0).pattern) - Vector2d(0.2, 0.1)).norm(), 0, 1e-7);
}

TEST(SceneSheets, MirroredUvsGiveAPatternSeenFromTheFront) {
  FlatMesh mesh = grid(4, 2, 0.2, 0.1);
  for (Vector2d& uv : mesh.uv) uv.x() = 1 - uv.x();
  const Scene scene = read_scene(HeldSheet(mesh).write("mirrored.gltf"));
  EXPECT_GT(area(scene.sheets.at(0).pattern), 0.0199);
  EXPECT_NEAR((handle(scene, "handle.fixed").pattern - Vector2d(0, 0)).norm(), 0, 1e-7);
  const Sheet& start = scene.sheets[0].start;
  const auto i = start.triangles.row(0);
  const Vector2d a = start.pattern.row(i(1)) - start.pattern.row(i(0)),
                 b = start.pattern.row(i(2)) - start.pattern.row(i(0));
  EXPECT_GT(cross(a, b), 1e-4);
}

TEST(SceneSheets, ASheetCutInItsUvsStaysCut) {
  // a closed tube: its first and last column coincide in space, but not in the UVs
  const auto tube = [](double u, double v) {
    return Vector3d(0.05 * std::cos(u / 0.05), 0.05 * std::sin(u / 0.05), v);
  };
  FlatMesh mesh = grid(36, 3, 0.1 * M_PI, 0.1, nullptr, tube);
  const Scene scene = read_scene(HeldSheet(mesh).write("tube.gltf"));
  EXPECT_EQ(scene.sheets.at(0).start.x.rows(), 37 * 4);
  // UVs measure arcs, edges are chords and 0.13 % shorter: the fitted scale lies between them
  EXPECT_GT(longer_side(scene.sheets[0].pattern), 36 * 0.1 * std::sin(M_PI / 36));
  EXPECT_LT(longer_side(scene.sheets[0].pattern), 0.1 * M_PI);
  mesh.uv.clear();
  EXPECT_ERROR(HeldSheet(mesh).write("closed_tube.gltf"), "closes on itself");
}

/// A square of 0.2 m that is cut without width from (0.1, 0) to (0.1, 0.05) and from (0.05, 0.1) to
/// (0.15, 0.1).
/// apart  [m] one side of each cut lies higher by this: vertices in one place would be welded
FlatMesh cut_sheet(double apart = 1e-5) {
  FlatMesh mesh = grid(4, 4, 0.2, 0.2);
  const auto cut = [&](int vertex, const std::function<bool(const Vector3d&)>& is_beyond) {
    const int copy = static_cast<int>(mesh.x.size());
    mesh.x.push_back(mesh.x[vertex] + Vector3d(0, 0, apart));
    if (!mesh.uv.empty()) mesh.uv.push_back(mesh.uv[vertex]);
    for (std::size_t t = 0; t < mesh.corners.size(); t += 3) {
      Vector3d middle(0, 0, 0);
      for (int k = 0; k < 3; ++k) middle += mesh.x[mesh.corners[t + k]] / 3;
      if (!is_beyond(middle)) continue;
      for (int k = 0; k < 3; ++k)
        if (static_cast<int>(mesh.corners[t + k]) == vertex) mesh.corners[t + k] = copy;
    }
  };
  const auto vertex_at = [&](double x, double y) {
    return static_cast<int>(std::min_element(mesh.x.begin(), mesh.x.end(),
                                             [&](const Vector3d& a, const Vector3d& b) {
                                               const Vector3d p(x, y, 0);
                                               return (a - p).norm() < (b - p).norm();
                                             }) -
                            mesh.x.begin());
  };
  cut(vertex_at(0.1, 0), [](const Vector3d& p) { return p.x() > 0.1; });
  cut(vertex_at(0.1, 0.1), [](const Vector3d& p) { return p.y() > 0.1; });
  return mesh;
}

TEST(SceneSheets, CutsWithoutWidthAreOpened) {
  const Scene scene = read_scene(HeldSheet(cut_sheet()).write("cuts.gltf"));
  const Pattern& pattern = scene.sheets.at(0).pattern;
  constexpr double half = 1e-4 * 0.2;  // width, where it is widest
  ASSERT_EQ(pattern.holes.size(), 1u);
  EXPECT_NEAR(area(pattern), 0.04 - 0.1 * half - 0.05 * half, 1e-8);
  const auto has_corner = [&](const std::vector<Vector2d>& polygon, const Vector2d& p) {
    return std::any_of(polygon.begin(), polygon.end(),
                       [&](const Vector2d& q) { return (p - q).norm() < 1e-7; });
  };
  for (const Vector2d& tip : {Vector2d(0.05, 0.1), Vector2d(0.15, 0.1)})
    EXPECT_TRUE(has_corner(pattern.holes[0], tip));
  EXPECT_TRUE(has_corner(pattern.outline, {0.1, 0.05})) << "the tip of the cut in the border";
  for (const double side : {-half, half}) {
    EXPECT_TRUE(has_corner(pattern.holes[0], {0.1, 0.1 + side}));
    EXPECT_TRUE(has_corner(pattern.outline, {0.1 + side, 0}));
  }
  EXPECT_NO_THROW(mesh_pattern(pattern, 0.01, {}));
  EXPECT_NO_THROW(mesh_pattern(pattern, 0.04, {}));
}

TEST(SceneSheets, CutsThatMeetInAStarAreOpened) {
  // wedges round a point, where each has a tip of its own; a ring of whole paper holds them
  constexpr int wedges = 16;
  FlatMesh mesh;
  const auto at = [&](double radius, double turn, double lift) {
    const double a = 2 * M_PI * turn / wedges;
    mesh.x.push_back(Vector3d(radius * std::cos(a), radius * std::sin(a), lift));
    return static_cast<int>(mesh.x.size()) - 1;
  };
  std::vector<int> inner, outer;
  for (int k = 0; k < wedges; ++k) {
    inner.push_back(at(0.08, k, 0));
    outer.push_back(at(0.1, k, 0));
  }
  const auto face = [&](int a, int b, int c) {
    for (const int v : {a, b, c}) mesh.corners.push_back(v);
  };
  for (int k = 0; k < wedges; ++k) {
    const int next = (k + 1) % wedges;
    face(at(0, 0, 1e-5 * k), inner[k], inner[next]);
    face(inner[k], outer[k], outer[next]);
    face(inner[k], outer[next], inner[next]);
  }
  const Scene scene = read_scene(HeldSheet(mesh).write("star.gltf"));
  const Pattern& pattern = scene.sheets.at(0).pattern;
  ASSERT_EQ(pattern.holes.size(), 1u);
  EXPECT_EQ(pattern.holes[0].size(), 2u * wedges);
  EXPECT_NO_THROW(mesh_pattern(pattern, 0.01, {}));
}

TEST(SceneSheets, TheTipOfAPennantIsNoCut) {
  // two long sides that meet at 2 degrees, with border edges of 1 mm
  FlatMesh mesh;
  constexpr int columns = 300;
  mesh.x.push_back(Vector3d(0, 0, 0));
  for (int k = 1; k <= columns; ++k)
    for (const double side : {-1, 1})
      mesh.x.push_back(Vector3d(1e-3 * k, side * 1e-3 * k * std::tan(M_PI / 180), 0));
  mesh.corners = {0, 1, 2};
  for (int k = 1; k < columns; ++k) {
    const int a = 2 * k - 1;
    for (const int v : {a, a + 2, a + 3, a, a + 3, a + 1}) mesh.corners.push_back(v);
  }
  const Scene scene = read_scene(HeldSheet(mesh).write("pennant.gltf"));
  EXPECT_EQ(scene.sheets.at(0).pattern.outline.size(), 3u);
}

TEST(SceneSheets, CutsWhoseSidesLieInOnePlaceAreJoinedWithAWarning) {
  const auto warning = [](const FlatMesh& mesh) {
    for (const std::string& said : read_scene(HeldSheet(mesh).write("joined.gltf")).warnings)
      if (said.find("as at a cut") != std::string::npos) return said;
    return std::string();
  };
  EXPECT_EQ(warning(cut_sheet(0)).find("At 3 edges of the sheet \"paper\""), 0u)
      << warning(cut_sheet(0));
  EXPECT_EQ(warning(cut_sheet()), "") << "its cuts are kept";
  EXPECT_EQ(warning(grid(4, 4, 0.2, 0.2)), "");
  // whole paper, of which an exporter has split all vertices, or those at the border of a uv island
  FlatMesh split, islands = grid(4, 4, 0.2, 0.2);
  for (const auto corner : islands.corners) {
    split.corners.push_back(static_cast<int>(split.x.size()));
    split.x.push_back(islands.x[corner]);
    split.uv.push_back(islands.uv[corner]);
  }
  EXPECT_EQ(warning(split), "");
  islands = cut_sheet(0);
  for (std::size_t v = 25; v < islands.x.size(); ++v) islands.uv[v] += Vector2d(2, 0);
  EXPECT_EQ(warning(islands), "");
}

TEST(SceneSheets, ABowlIsNotDevelopable) {
  const auto bowl = [](double u, double v) {
    return Vector3d(u, v, 5 * ((u - 0.1) * (u - 0.1) + (v - 0.1) * (v - 0.1)));
  };
  EXPECT_ERROR(HeldSheet(grid(4, 4, 0.2, 0.2, nullptr, bowl)).write("bowl.gltf"),
               "worst angle defect");
}

TEST(SceneSheets, MeshesThatCannotBeSheetsAreErrors) {
  FlatMesh two = grid(5, 4, 0.25, 0.2, [](int i, int) { return i != 2; });
  EXPECT_ERROR(HeldSheet(two).write("two.gltf"), "2 pieces");
  FlatMesh fin = grid(2, 2, 0.2, 0.2);
  fin.x.push_back({0.1, 0.1, 0.1});
  fin.uv.push_back({0, 0});
  fin.corners.insert(fin.corners.end(), {1, 4, 9});
  EXPECT_ERROR(HeldSheet(fin).write("fin.gltf"), "Three or more faces");
  FlatMesh thin = grid(2, 2, 0.2, 0.2);
  thin.corners.insert(thin.corners.end(), {0, 1, 2});
  EXPECT_ERROR(HeldSheet(thin).write("thin.gltf"), "no area");
  FlatMesh turned = grid(2, 2, 0.2, 0.2);
  std::swap(turned.corners[0], turned.corners[1]);
  EXPECT_ERROR(HeldSheet(turned).write("turned.gltf"), "disagree about the front");
}

TEST(SceneSheets, ASceneInCentimetresIsAnErrorWithTheUnitToUse) {
  const FlatMesh mesh = grid(4, 4, 20, 20);
  const std::string text = error_of(HeldSheet(mesh, "{}", "{}", 100).write("cm.gltf"));
  EXPECT_NE(text.find("20 x 20 m"), std::string::npos) << text;
  EXPECT_NE(
      text.find("The sheet would be 20 x 20 mm in millimetres (--unit-scale 0.001), 200 x 200 "
                "mm in centimetres (--unit-scale 0.01), 508 x 508 mm in inches"),
      std::string::npos)
      << text;
  SceneOptions options;
  options.unit_scale = 0.01;
  const Scene scene = read_scene(HeldSheet(mesh, "{}", "{}", 100).write("cm.gltf"), options);
  EXPECT_NEAR(longer_side(scene.sheets.at(0).pattern), 0.2, 1e-7);
  EXPECT_NEAR(handle(scene, "handle.moved").keyed(4, 0), 0.18, 1e-7);
}

TEST(SceneSheets, ANameWithAColonIsWholeUnlessItHasANamespace) {
  for (const char* name : {"Paper: Letter", "paper:letter", "shot:char:paper_01", "paper:Paper 2"})
    EXPECT_EQ(read_scene(HeldSheet(grid(2, 2, 0.2, 0.2), "{}", "{}", 1, name).write("colon.gltf"))
                  .sheets.at(0)
                  .name,
              name);
  EXPECT_EQ(matched_name("Rig:Handle_Left.001"), "handle.left");
  EXPECT_EQ(matched_name("rig:Grip_Left.001"), "grip.left");
  EXPECT_EQ(matched_name("paper:handle"), "handle");
  EXPECT_EQ(matched_name("Paper: Letter"), "paper: letter");
}

TEST(SceneSheets, TheInstanceOfACollectionIsToBeMadeReal) {
  HeldSheet fixture(grid(2, 2, 0.2, 0.2), "{}", "{}", 1, "table|paper|Dupli|");
  const std::string text = error_of(fixture.write("instance.gltf"));
  EXPECT_NE(text.find("this mesh is the instance of a collection"), std::string::npos) << text;
  EXPECT_NE(text.find("Make Instances Real"), std::string::npos) << text;
  HeldSheet beside;
  beside.mesh("table|collider.box|Dupli|", grid(1, 1, 0.5, 0.5));
  beside.mesh("table|box|Dupli|", grid(1, 1, 0.5, 0.5));
  const Scene scene = read_scene(beside.write("beside.gltf"));
  EXPECT_TRUE(test::has_warning(scene, "\"table|collider.box|Dupli|\" is ignored"));
  EXPECT_FALSE(test::has_warning(scene, "\"table|box|Dupli|\""));
}

/// The sheets of tests/data/deformed_sheets.py: its radius, its angle, and its size.
void expect_deformed_sheets(const std::string& file) {
  const Scene scene = read_scene(std::filesystem::path(PAPERBAKE_DATA) / file);
  ASSERT_EQ(scene.sheets.size(), 3u);
  for (const SceneSheet& sheet : scene.sheets) {
    EXPECT_NEAR((extent(sheet.pattern) - Vector2d(0.2, 0.1)).norm(), 0, 1e-6)
        << sheet.name << ": the chords of the roll do not make it shorter";
    const Points2& flat = sheet.start.pattern;
    const Points3 x = sheet.start.x.rowwise() - sheet.start.x.row(0);
    const bool rolled = sheet.name == "paper.rolled", folded = sheet.name == "paper.folded";
    EXPECT_EQ(sheet.deformed, rolled || folded) << sheet.name;
    for (Eigen::Index v = 0; v < x.rows(); ++v) {
      constexpr double radius = 0.08, angle = M_PI / 3;
      const double u = flat(v, 0), beyond = std::max(0.0, u - 0.1);
      const Vector2d along =
          rolled   ? Vector2d(radius * std::sin(u / radius), radius - radius * std::cos(u / radius))
          : folded ? Vector2d(u - beyond + beyond * std::cos(angle), beyond * std::sin(angle))
                   : Vector2d(u, 0);
      EXPECT_NEAR(x(v, 0), along.x(), 1e-5) << sheet.name << ' ' << v;
      EXPECT_NEAR(std::abs(x(v, 2)), along.y(), 1e-5) << sheet.name << ' ' << v;
    }
  }
  EXPECT_TRUE(test::has_warning(scene,
                                "give the sheet \"paper.bulged\" at frame 1 a shape that "
                                "paper does not have: it starts undeformed."));
  EXPECT_TRUE(test::has_warning(scene, "apply the deformation to the mesh"));
  EXPECT_TRUE(test::has_warning(scene, "go on to deform the sheet \"paper.rolled\""));
  EXPECT_FALSE(test::has_warning(scene, "go on to deform the sheet \"paper.folded\""));
}

TEST(SceneSheets, StartAsBonesAndShapeKeysPutThem) {
  expect_deformed_sheets("deformed_sheets.glb");
}

TEST(SceneSheets, OfAnFbxStartAsBonesAndShapeKeysPutThem) {
  const Scene scene = read_scene(std::filesystem::path(PAPERBAKE_DATA) / "deformed_sheets.fbx");
  if (scene.origin.at("curves").find("ufbx") == std::string::npos) GTEST_SKIP() << "needs ufbx";
  expect_deformed_sheets("deformed_sheets.fbx");
  for (const SceneSheet& sheet : scene.sheets)
    if (sheet.name == "paper.folded") {
      // glTF has no marks of edges
      ASSERT_EQ(sheet.pattern.prescribed_creases.size(), 1u) << "the marked edges lie on it";
      EXPECT_NEAR(std::abs(sheet.pattern.prescribed_creases[0].angle), M_PI / 3, 1e-4);
    }
}

TEST(SceneSheets, AShapeKeyBeyondAllNumbersIsNotFollowed) {
  ImportedFile file = import_in_process(HeldSheet().write("huge.gltf"));
  ImportedMesh& mesh = file.meshes.at(0);
  mesh.deformed = true;
  mesh.targets = {Points3::Constant(mesh.x.rows(), 3, 1e308)};
  mesh.target_weights = {10};
  const Scene scene = scene_of(std::move(file), "huge.gltf");
  EXPECT_TRUE(test::has_warning(scene, "A vertex is moved beyond all numbers."));
  EXPECT_TRUE(scene.sheets.at(0).start.x.allFinite());
}

TEST(SceneSheets, PaperSizeMustAgreeWithTheMesh) {
  EXPECT_EQ(
      error_of(
          HeldSheet(grid(2, 2, 0.2, 0.1), R"({"paper_size":[0.1,0.2]})").write("turned_size.gltf")),
      "");
  const std::string text =
      error_of(HeldSheet(grid(2, 2, 0.2, 0.1), R"({"paper_size":[0.21,0.1]})").write("size.gltf"));
  EXPECT_NE(text.find("0.2 x 0.1 m"), std::string::npos) << text;
  EXPECT_NE(text.find("0.21 x 0.1 m"), std::string::npos) << text;
  EXPECT_EQ(text.find("--unit-scale"), std::string::npos) << text;
  EXPECT_ERROR(HeldSheet(grid(2, 2, 2, 1), R"({"paper_size":[0.2,0.1]})").write("ten.gltf"),
               "--unit-scale 0.1");
  EXPECT_ERROR(HeldSheet(grid(2, 2, 20, 10), R"({"paper_size":[0.2,0.1]})").write("hundred.gltf"),
               "--unit-scale 0.01");
  EXPECT_ERROR(
      HeldSheet(grid(2, 2, 8, 4), R"({"paper_size":[0.2032,0.1016]})").write("inch.gltf"),
      "The file is probably in inches: bake with --unit-scale 0.0254, with which the sheet "
      "is 203.2 x 101.6 mm");
}

TEST(SceneSheets, OnlyUnitsThatGiveAUsualSizeAreProposed) {
  const auto with_side = [](double side) {
    return HeldSheet(grid(2, 2, side, 0.75 * side), "{}", "{}", side / 0.2).write("unit.gltf");
  };
  EXPECT_ERROR(with_side(200),
               "The file is probably in millimetres: bake with --unit-scale 0.001, "
               "with which the sheet is 200 x 150 mm");
  const std::string both = error_of(with_side(7.874));
  EXPECT_NE(both.find("78.74 x 59.06 mm in centimetres"), std::string::npos) << both;
  EXPECT_NE(both.find("200 x 150 mm in inches (--unit-scale 0.0254)"), std::string::npos) << both;
  EXPECT_EQ(both.find("millimetres"), std::string::npos) << both;
  EXPECT_ERROR(with_side(1e-5), "bake with --unit-scale and the length of one unit");
}

TEST(SceneSheets, ASheetLargerThanAnyThatIsSoldIsWarnedOf) {
  EXPECT_FALSE(test::has_warning(read_scene(HeldSheet(grid(2, 2, 1.189, 0.841)).write("a0.gltf")),
                                 "longer than A0"));
  const auto path = HeldSheet(grid(2, 2, 4, 3)).write("large.gltf");
  EXPECT_TRUE(test::has_warning(read_scene(path), "longer than A0: is that meant?"));
  SceneOptions options;
  options.unit_scale = 1;
  EXPECT_FALSE(test::has_warning(read_scene(path, options), "longer than A0"));
  options.unit_scale = 100;
  try {
    read_scene(path, options);
    ADD_FAILURE() << "a sheet of 400 m";
  } catch (const Error& error) {
    EXPECT_EQ(error.remedy, "Bake with another --unit-scale.");
  }
}

}  // namespace
}  // namespace paperbake
