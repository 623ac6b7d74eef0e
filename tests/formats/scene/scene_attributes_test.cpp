// Colours and numbers that an artist has put on the vertices of a sheet, as files have them.

#include "formats/scene/flat_sheet.h"
#include "formats/scene/scene_import.h"
#include "formats/scene/welded_mesh.h"
#include "tests/formats/scene/scene_fixture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

namespace paperbake {
namespace {

constexpr int vertices = 9;  // of the sheet
const std::string normalized = R"(,"normalized":true)";

/// A number for each vertex and component.
template <class Number>
std::vector<Number> ramp(int width, double from, double step) {
  std::vector<Number> values;
  for (int i = 0; i < vertices * width; ++i) values.push_back(Number(from + step * i));
  return values;
}

/// A square of 0.2 m with what `fixture` has for the next mesh, and two handles.
std::filesystem::path file_of(test::GltfFixture fixture, const std::string& extras = "{}") {
  const test::FlatMesh mesh = test::grid(2, 2, 0.2, 0.2);
  fixture.mesh("paper", mesh, extras);
  fixture.node("handle.a", mesh.x.front());
  fixture.node("handle.b", mesh.x.back());
  return fixture.write("attributes.gltf");
}

Scene scene_of(const test::GltfFixture& fixture, const std::string& extras = "{}") {
  return read_scene(file_of(fixture, extras));
}

const AuthoredAttribute* find(const AuthoredSurface& authored, const std::string& name) {
  for (const AuthoredAttribute& attribute : authored.attributes)
    if (attribute.name == name) return &attribute;
  return nullptr;
}

std::vector<std::string> names(const AuthoredSurface& authored) {
  std::vector<std::string> found;
  for (const AuthoredAttribute& attribute : authored.attributes) found.push_back(attribute.name);
  return found;
}

/// The value of the vertex of the file at each corner, found by its place: column c of vertex v is
/// from + step (width v + c).
void expect_ramp(const AuthoredSurface& authored, const std::string& name, AttributeKind kind,
                 int width, double from, double step) {
  const AuthoredAttribute* attribute = find(authored, name);
  ASSERT_TRUE(attribute) << name;
  EXPECT_EQ(attribute->kind, kind) << name;
  ASSERT_EQ(attribute->values.cols(), width) << name;
  ASSERT_EQ(attribute->values.rows(), 3 * 8) << name;
  for (int t = 0; t < 8; ++t)
    for (int k = 0; k < 3; ++k) {
      const Vector2d p = authored.pattern.row(authored.triangles(t, k));
      const int v = static_cast<int>(std::lround(p.x() / 0.1) + 3 * std::lround(p.y() / 0.1));
      for (int c = 0; c < width; ++c)
        EXPECT_NEAR(attribute->values(3 * t + k, c), from + step * (width * v + c), 1e-6)
            << name << ", vertex " << v << ", number " << c;
    }
}

TEST(SceneAttributes, OfGltfAreReadWithTheNumbersOfTheirType) {
  test::GltfFixture fixture;
  fixture.attribute("COLOR_0", 5126, 4, ramp<float>(4, 0.1, 0.02));
  fixture.attribute("COLOR_1", 5121, 3, ramp<std::uint8_t>(3, 9, 5), normalized);
  fixture.attribute("COLOR_2", 5123, 4, ramp<std::uint16_t>(4, 100, 1000));
  fixture.attribute("_WEAR", 5126, 1, ramp<float>(1, -40, 12.5));
  fixture.attribute("_PAIR", 5123, 2, ramp<std::uint16_t>(2, 7, 300));
  fixture.attribute("_SHARE", 5121, 3, ramp<std::uint8_t>(3, 0, 2), normalized);
  fixture.attribute("_FOUR", 5126, 4, ramp<float>(4, 2, 1));
  const Scene scene = scene_of(fixture);
  const AuthoredSurface& authored = scene.sheets.at(0).authored;
  EXPECT_EQ(names(authored), (std::vector<std::string>{"UVMap", "Color", "Color.001", "Color.002",
                                                       "WEAR", "PAIR", "SHARE", "FOUR"}));
  expect_ramp(authored, "Color", AttributeKind::colour, 4, 0.1, 0.02);
  expect_ramp(authored, "Color.001", AttributeKind::colour, 3, 9 / 255., 5 / 255.);
  expect_ramp(authored, "Color.002", AttributeKind::colour, 4, 100 / 65535., 1000 / 65535.);
  expect_ramp(authored, "WEAR", AttributeKind::number, 1, -40, 12.5);
  expect_ramp(authored, "PAIR", AttributeKind::number, 2, 7, 300);
  expect_ramp(authored, "SHARE", AttributeKind::number, 3, 0, 2 / 255.);
  expect_ramp(authored, "FOUR", AttributeKind::number, 4, 2, 1);
}

TEST(SceneAttributes, GetTheNamesThatTheSheetTells) {
  test::GltfFixture fixture;
  fixture.attribute("COLOR_0", 5126, 4, ramp<float>(4, 0, 0.01));
  fixture.attribute("_DYE", 5126, 4, ramp<float>(4, 0, 0.02));
  fixture.attribute("_INK", 5126, 3, ramp<float>(3, 0, 0.03));
  fixture.attribute("_WEAR", 5126, 1, ramp<float>(1, 0, 1));
  const Scene scene = scene_of(
      fixture,
      R"({"paper_colours":"Color=Print\nDYE=My dye\nINK\nWEAR=None","paper_attributes":"WEAR=Wear=2"})");
  const AuthoredSurface& authored = scene.sheets.at(0).authored;
  expect_ramp(authored, "Print", AttributeKind::colour, 4, 0, 0.01);
  expect_ramp(authored, "My dye", AttributeKind::colour, 4, 0, 0.02);
  expect_ramp(authored, "INK", AttributeKind::colour, 3, 0, 0.03);
  expect_ramp(authored, "Wear=2", AttributeKind::number, 1, 0, 1);  // one number is no colour
  EXPECT_TRUE(authored.properties.empty());
  EXPECT_FALSE(test::has_warning(scene, "is unknown"));
}

TEST(SceneAttributes, AreNotCalledAsWhatCachesHaveBesides) {
  test::GltfFixture fixture;
  for (const char* semantic : {"_UVMap", "_crease", "_pattern", "_velocity"})
    fixture.attribute(semantic, 5126, 1, ramp<float>(1, 0, 1));
  EXPECT_EQ(names(scene_of(fixture).sheets.at(0).authored),
            (std::vector<std::string>{"UVMap", "UVMap_2", "crease_2", "pattern_2", "velocity_2"}));
}

TEST(SceneAttributes, ThatAreDamagedAreLeftOutWithAWarning) {
  const auto warnings = [](const char* semantic, int width, const std::vector<float>& values) {
    test::GltfFixture fixture;
    fixture.attribute(semantic, 5126, width, values);
    const Scene scene = scene_of(fixture);
    const std::vector<std::string> left = names(scene.sheets.at(0).authored);
    std::string text = left == std::vector<std::string>{"UVMap"} ? "" : "it is there: ";
    for (const std::string& warning : scene.warnings) text += warning;
    return text;
  };
  std::vector<float> values(vertices, 1.0f);
  EXPECT_EQ(warnings("_WEAR", 1, values).rfind("it is there", 0), 0u);
  values[0] = std::numeric_limits<float>::quiet_NaN();
  const std::string damaged = warnings("_WEAR", 1, values);
  EXPECT_NE(damaged.find("_WEAR is left out: a value is not a number"), std::string::npos)
      << damaged;
  EXPECT_EQ(damaged.find("it is there"), std::string::npos);
  values.assign(vertices - 1, 1.0f);
  EXPECT_NE(warnings("_WEAR", 1, values).find("a value for each vertex"), std::string::npos);
  EXPECT_NE(warnings("COLOR_0", 2, ramp<float>(2, 0, 1)).find("another number of values"),
            std::string::npos);
}

TEST(SceneAttributes, OfWhichAPartOfTheFileIsMissingAreLeftOutWithAWarning) {
  test::GltfFixture fixture;
  fixture.attribute("_WEAR", 5126, 1, ramp<float>(1, 0, 1));
  const std::filesystem::path path = file_of(fixture);
  std::string text = test::whole(path);
  const std::string first_view = R"("bufferViews":[{"buffer":)", end = "}]}";
  text.replace(text.find(first_view + "0"), first_view.size() + 1, first_view + "1");
  text.replace(text.rfind(end), end.size(), R"(},{"byteLength":36,"uri":"gone.bin"}]})");
  std::ofstream(path, std::ios::binary) << text;
  const Scene scene = read_scene(path);
  EXPECT_EQ(names(scene.sheets.at(0).authored), std::vector<std::string>{"UVMap"});
  std::string warnings;
  for (const std::string& warning : scene.warnings) warnings += warning;
  EXPECT_NE(
      warnings.find("_WEAR is left out: A part of the file, \"gone.bin\" beside it, cannot be "
                    "opened. Put it there"),
      std::string::npos)
      << warnings;
}

/// Two triangles side by side, each a mesh of its own.
ImportedFile two_parts() {
  ImportedFile file;
  file.meshes.resize(2);
  file.meshes[0].x = (Points3(3, 3) << 0, 0, 0, 0.2, 0, 0, 0.2, 0.2, 0).finished();
  file.meshes[1].x = (Points3(3, 3) << 0, 0, 0, 0.2, 0.2, 0, 0, 0.2, 0).finished();
  for (ImportedMesh& mesh : file.meshes) mesh.triangles = (Triangles(1, 3) << 0, 1, 2).finished();
  file.nodes.resize(1);
  file.nodes[0].meshes = {0, 1};
  return file;
}

TEST(SceneAttributes, OfSeveralPartsThoseComeBackThatAllHaveByName) {
  ImportedFile file = two_parts();
  const auto add = [&](int mesh, const char* name, AttributeKind kind, int width, double value) {
    file.meshes[static_cast<std::size_t>(mesh)].attributes.push_back(
        {name, kind, AttributeValues::Constant(3, width, value)});
  };
  add(0, "only here", AttributeKind::number, 1, 1);
  add(0, "Wear", AttributeKind::number, 1, 2);
  add(0, "Dye", AttributeKind::colour, 4, 3);
  add(0, "pair or more", AttributeKind::number, 2, 4);
  add(1, "Dye", AttributeKind::colour, 4, 5);
  add(1, "pair or more", AttributeKind::number, 3, 6);
  add(1, "Wear", AttributeKind::number, 1, 7);
  // loose edges have no attributes, and do not take them from the faces
  file.meshes.emplace_back();
  file.meshes[2].x = (Points3(2, 3) << 0, 0, 0, 0.2, 0.2, 0).finished();
  file.nodes[0].meshes = {2, 0, 1};
  const Eigen::Affine3d here = Eigen::Affine3d::Identity();
  const AuthoredSurface authored =
      flat_sheet(file, 0, here, combined_mesh(file, 0, here).x, "sheet").authored;
  EXPECT_EQ(names(authored), (std::vector<std::string>{"Wear", "Dye"}));
  ASSERT_EQ(authored.triangles.rows(), 2);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(find(authored, "Wear")->values(k, 0), 2);
    EXPECT_EQ(find(authored, "Wear")->values(3 + k, 0), 7);
    EXPECT_EQ(find(authored, "Dye")->values(k, 3), 3);
    EXPECT_EQ(find(authored, "Dye")->values(3 + k, 3), 5);
  }
}

/// A quad with two sets of colours, "Dye" by its corners and "Ink" by its vertices.
const char* const coloured_fbx = R"(; FBX 7.7.0 project file
FBXHeaderExtension: {
FBXHeaderVersion: 1004
FBXVersion: 7700
}
GlobalSettings: {
Version: 1000
}
Objects: {
Geometry: 1, "Geometry::paper", "Mesh" {
Vertices: *12 {
a: 0,0,0,20,0,0,20,20,0,0,20,0
}
PolygonVertexIndex: *4 {
a: 0,1,2,-4
}
LayerElementColor: 0 {
Version: 101
Name: "Dye"
MappingInformationType: "ByPolygonVertex"
ReferenceInformationType: "IndexToDirect"
Colors: *8 {
a: 0.25,0.5,0.75,1,1,0,0,0.5
}
ColorIndex: *4 {
a: 0,1,1,0
}
}
LayerElementColor: 1 {
Version: 101
Name: "Ink"
MappingInformationType: "ByVertice"
ReferenceInformationType: "Direct"
Colors: *16 {
a: 0,0,0,1,0.1,0,0,1,0.2,0,0,1,0.3,0,0,1
}
}
Layer: 0 {
Version: 100
LayerElement: {
Type: "LayerElementColor"
TypedIndex: 0
}
}
Layer: 1 {
Version: 100
LayerElement: {
Type: "LayerElementColor"
TypedIndex: 1
}
}
}
Model: 2, "Model::paper", "Mesh" {
Version: 232
}
}
Connections: {
C: "OO",2,0
C: "OO",1,2
}
)";

TEST(SceneAttributes, ColoursOfFbxAreReadCornerByCorner) {
  const ImportedFile file = import_in_process(test::temporary("coloured.fbx", coloured_fbx));
  ASSERT_EQ(file.meshes.size(), 1u);
  const ImportedMesh& mesh = file.meshes[0];
  ASSERT_EQ(mesh.attributes.size(), 2u);
  const bool named = mesh.attributes[0].name == "Dye";  // assimp drops the names
  EXPECT_TRUE(named || mesh.attributes[0].name == "Color");
  EXPECT_EQ(mesh.attributes[1].name, named ? "Ink" : "Color.001");
  for (Eigen::Index i = 0; i < mesh.x.rows(); ++i) {
    const bool right = mesh.x(i, 0) > 10, above = mesh.x(i, 1) > 10;
    const Eigen::RowVector4d dye =
        right ? Eigen::RowVector4d(1, 0, 0, 0.5) : Eigen::RowVector4d(0.25, 0.5, 0.75, 1);
    EXPECT_LT((mesh.attributes[0].values.row(i) - dye).norm(), 1e-6);
    const double ink = above ? (right ? 0.2 : 0.3) : (right ? 0.1 : 0);
    EXPECT_NEAR(mesh.attributes[1].values(i, 0), ink, 1e-6);
  }
}

}  // namespace
}  // namespace paperbake
