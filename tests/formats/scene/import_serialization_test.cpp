// The result of the importing process: it is restored exactly, and invalid bytes are refused.

#include "formats/scene/import_serialization.h"

#include "tests/formats/scene/scene_fixture.h"

#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>
#include <string>

namespace paperbake {
namespace {

ImportResult held_sheet() {
  ImportResult result{
      import_in_process(
          test::HeldSheet(test::grid(2, 2, 0.2, 0.2),
                          R"({"paper_gsm":80,"paper_preset":"copy90","paper_size":[0.2,0.2]})")
              .write("message.gltf")),
      "", "", ""};
  result.file.meshes[0].attributes.push_back(
      {"Dye", AttributeKind::colour, AttributeValues::Constant(9, 4, 0.25)});
  result.file.meshes[0].attributes.push_back(
      {"Wear", AttributeKind::number, AttributeValues::Constant(9, 1, 7)});
  return result;
}

TEST(ImportSerialization, RestoresWhatWasWritten) {
  ImportResult result = held_sheet();
  result.place = "scene.glb";
  result.cause = "It is damaged.";
  const ImportResult back = deserialize(serialize(result));
  EXPECT_EQ(back.place, result.place);
  EXPECT_EQ(back.cause, result.cause);
  ASSERT_EQ(back.file.nodes.size(), 3u);
  EXPECT_EQ(back.file.nodes[0].name, "paper");
  EXPECT_EQ(back.file.nodes[0].properties, result.file.nodes[0].properties);
  ASSERT_EQ(result.file.nodes[0].properties.size(), 3u);  // a number, a text, a list
  EXPECT_TRUE(back.file.meshes.at(0).x == result.file.meshes[0].x &&
              back.file.meshes[0].triangles == result.file.meshes[0].triangles);
  ASSERT_EQ(back.file.meshes[0].attributes.size(), 3u);
  for (std::size_t n = 0; n < 3; ++n) {
    const AuthoredAttribute &a = back.file.meshes[0].attributes[n],
                            &b = result.file.meshes[0].attributes[n];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.kind, b.kind);
    EXPECT_TRUE(same_entries(a.values, b.values));
  }
  ASSERT_EQ(back.file.takes.at(0).motions.count(2), 1u);
  EXPECT_EQ(back.file.takes[0].motions.at(2).translation.keys.size(), 2u);
  EXPECT_EQ(serialize(back), serialize(result));
}

TEST(ImportSerialization, TruncatedDataIsRefused) {
  const std::string whole = serialize(held_sheet());
  for (std::size_t size = 0; size < whole.size(); size += 7)
    EXPECT_THROW(deserialize(std::string_view(whole).substr(0, size)), std::runtime_error) << size;
}

TEST(ImportSerialization, InvalidContentIsRefused) {
  const auto refused = [](const std::function<void(ImportedFile&)>& spoil) {
    ImportResult result = held_sheet();
    spoil(result.file);
    try {
      deserialize(serialize(result));
    } catch (const std::runtime_error&) {
      return true;
    }
    return false;
  };
  EXPECT_FALSE(refused([](ImportedFile&) {}));
  EXPECT_TRUE(refused([](ImportedFile& f) { f.nodes[0].parent = 0; }));
  EXPECT_TRUE(refused([](ImportedFile& f) { f.nodes[0].meshes[0] = 1; }));
  EXPECT_TRUE(refused([](ImportedFile& f) { f.nodes[1].local(0, 3) = NAN; }));
  EXPECT_TRUE(refused([](ImportedFile& f) { f.meshes[0].triangles(0, 0) = 9; }));
  EXPECT_TRUE(refused([](ImportedFile& f) { f.meshes[0].x(0, 0) = INFINITY; }));
  EXPECT_TRUE(
      refused([](ImportedFile& f) { f.meshes[0].attributes[0].values.conservativeResize(8, 2); }));
  EXPECT_TRUE(refused([](ImportedFile& f) { f.meshes[0].material_of = {0}; }));
  EXPECT_TRUE(refused([](ImportedFile& f) { f.meshes[0].attributes[1].values(3, 2) = NAN; }));
  EXPECT_TRUE(
      refused([](ImportedFile& f) { f.meshes[0].attributes[2].values = AttributeValues(); }));
  EXPECT_TRUE(refused([](ImportedFile& f) {
    f.meshes[0].attributes[2].kind = AttributeKind::colour;
  })) << "of one number";
  EXPECT_TRUE(refused([](ImportedFile& f) { f.meshes[0].attributes[2].kind = AttributeKind(3); }));
  EXPECT_TRUE(refused([](ImportedFile& f) {
    std::swap(f.meshes[0].attributes[0], f.meshes[0].attributes[1]);  // the uv set comes first
  }));
  EXPECT_TRUE(refused([](ImportedFile& f) {
    f.meshes[0].material_of.assign(f.meshes[0].triangles.rows(), 0);  // there is none
  }));
  EXPECT_TRUE(refused([](ImportedFile& f) { f.takes[0].motions[3]; }));
  EXPECT_TRUE(
      refused([](ImportedFile& f) { f.takes[0].motions.at(2).translation.keys[1].time = -1; }));
  EXPECT_TRUE(refused([](ImportedFile& f) { f.unit = 0; }));
}

}  // namespace
}  // namespace paperbake
