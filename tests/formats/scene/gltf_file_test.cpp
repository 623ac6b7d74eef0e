// Features of glTF files that the exporters used for the other tests do not write.

#include "formats/scene/scene_import.h"

#include "tests/formats/scene/scene_fixture.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <sys/stat.h>
#include <vector>

namespace paperbake {
namespace {

using test::error_of;
using test::temporary;

/// A data URI with the bytes of numbers, escaped instead of base64.
template <class Number>
std::string data_uri(const std::vector<Number>& numbers,
                     const std::string& head = "data:application/octet-stream,") {
  const auto* bytes = reinterpret_cast<const unsigned char*>(numbers.data());
  std::string uri = head;
  for (std::size_t i = 0; i < numbers.size() * sizeof(Number); ++i)
    uri += fmt::format("%{:02X}", bytes[i]);
  return uri;
}

std::filesystem::path file(const std::string& name, const std::string& members) {
  return temporary(name, R"({"asset":{"version":"2.0"},)" + members + "}");
}

std::string buffer(const std::string& uri, std::size_t bytes) {
  return fmt::format(R"({{"byteLength":{},"uri":"{}"}})", bytes, uri);
}

/// Members of a file with one triangle. positions: the accessor of its corners.
std::string triangle(const std::string& positions, const std::string& more = "") {
  return R"("nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"accessors":[)" +
         positions + "]" + more;
}

const Points3 corners = (Points3(3, 3) << 0, 0, 0, 0.5, 0, 0, 0, 0, -1).finished();

TEST(GltfFile, SparseAccessorsReplaceElements) {
  // three corners, and the replacement of the second
  const std::vector<float> numbers{0, 0, 0, 9, 9, 9, 0, 0, -1, 0.5f, 0, 0};
  const auto path = file(
      "sparse.gltf",
      triangle(
          R"({"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":1,)"
          R"("indices":{"bufferView":2,"componentType":5121},"values":{"bufferView":1}}})",
          R"(,"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":12},{"buffer":1,"byteLength":1}],"buffers":[)" +
              buffer(data_uri(numbers), 48) + "," +
              buffer(data_uri(std::vector<std::uint8_t>{1}), 1) + "]"));
  const ImportedFile imported = import_in_process(path);
  EXPECT_EQ(imported.meshes.at(0).x, corners);
  EXPECT_EQ(imported.meshes.at(0).triangles, (Triangles(1, 3) << 0, 1, 2).finished());
  EXPECT_EQ(imported.nodes.at(0).name, "nodes[0]");  // without scenes all roots are imported
}

TEST(GltfFile, QuantizedPositionsAreNumbersOrFractions) {
  const std::vector<std::int16_t> numbers{0, 0, 0, 0, 16384, 0, 0, 0, 0, 0, -32767, 0};
  for (const bool fraction : {false, true}) {
    const auto path = file(
        "quantized.gltf",
        triangle(
            fmt::format(
                R"({{"bufferView":0,"componentType":5122,"normalized":{},"count":3,"type":"VEC3"}})",
                fraction),
            R"(,"extensionsRequired":["KHR_mesh_quantization"],"bufferViews":[{"buffer":0,"byteLength":24,"byteStride":8}],"buffers":[)" +
                buffer(data_uri(numbers), 24) + "]"));
    EXPECT_NEAR(
        (import_in_process(path).meshes.at(0).x * (fraction ? 1 : 1 / 32767.0) - corners).norm(), 0,
        1e-4)
        << fraction;
  }
}

TEST(GltfFile, StripsAndFansAreTriangles) {
  const std::vector<float> numbers{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
  const auto with = [&](int mode) {
    return import_in_process(
               file(
                   "strip.gltf",
                   fmt::format(
                       R"("nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"mode":{},"attributes":{{"POSITION":0}}}}]}}],"accessors":[{{"bufferView":0,)"
                       R"("componentType":5126,"count":4,"type":"VEC3"}}],"bufferViews":[{{"buffer":0,"byteLength":48}}],"buffers":[{}])",
                       mode, buffer(data_uri(numbers), 48))))
        .meshes.at(0)
        .triangles;
  };
  EXPECT_EQ(with(5), (Triangles(2, 3) << 0, 1, 2, 1, 3, 2).finished());
  EXPECT_EQ(with(6), (Triangles(2, 3) << 1, 2, 0, 2, 3, 0).finished());
}

TEST(GltfFile, BuffersAreFoundByEscapedAndByPlainNames) {
  const std::vector<float> numbers{0, 0, 0, 0.5f, 0, 0, 0, 0, -1};
  temporary("a part.bin", std::string(reinterpret_cast<const char*>(numbers.data()), 36));
  const std::string accessor = R"({"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"})",
                    view = R"(,"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[)";
  for (const char* uri : {"a%20part.bin", "a part.bin", "./a%20part.bin"})
    EXPECT_EQ(
        import_in_process(file("beside.gltf", triangle(accessor, view + buffer(uri, 36) + "]")))
            .meshes.at(0)
            .x,
        corners)
        << uri;
  EXPECT_ERROR(file("gone.gltf", triangle(accessor, view + buffer("gone%20part.bin", 36) + "]")),
               "\"gone part.bin\" beside it, cannot be opened");
  EXPECT_ERROR(file("net.gltf", triangle(accessor, view + buffer("https://a.org/b.bin", 36) + "]")),
               "elsewhere: \"https://a.org/b.bin\"");
}

TEST(GltfFile, BuffersOutsideTheFolderOfTheSceneAreReadOnlyWhenAllowed) {
  namespace fs = std::filesystem;
  const std::vector<float> numbers{0, 0, 0, 0.5f, 0, 0, 0, 0, -1};
  const std::string bytes(reinterpret_cast<const char*>(numbers.data()), 36);
  const fs::path outside = temporary("secret.bin", bytes), folder = test::own_folder() / "scene";
  fs::create_directories(folder / "below");
  fs::copy_file(outside, folder / "below/part.bin", fs::copy_options::overwrite_existing);
  fs::remove(folder / "link.bin");
  fs::create_symlink(outside, folder / "link.bin");
  const auto scene = [&](const std::string& uri) {
    return file("scene/outside.gltf",
                triangle(R"({"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"})",
                         R"(,"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[)" +
                             buffer(uri, 36) + "]"));
  };
  for (const char* uri : {"below/part.bin", "./below/../below/part.bin"})
    EXPECT_EQ(import_file(scene(uri)).meshes.at(0).x, corners) << uri;
  for (const std::string& uri :
       {std::string("../secret.bin"), std::string("..%2Fsecret.bin"), outside.string(),
        std::string("link.bin"), std::string("below/../../secret.bin")}) {
    EXPECT_ERROR(scene(uri), "lies outside its folder");
    EXPECT_EQ(import_file(scene(uri), {}, Parts::anywhere).meshes.at(0).x, corners) << uri;
  }
  fs::remove(folder / "fifo.bin");
  ASSERT_EQ(mkfifo((folder / "fifo.bin").c_str(), 0666), 0);
  EXPECT_ERROR(scene("fifo.bin"), "is a FIFO");
}

TEST(GltfFile, PropertiesOfSupportedTypesAreRead) {
  const ImportedFile imported = import_in_process(file(
      "extras.gltf",
      R"("nodes":[{"extras":"text"},{"extras":[1]},{"mesh":0,"extras":{"a":1,"b":true,"c":"[1, 2]","d":null,"e":{"f":1},"g":[3,4],"h":"x"}}],)"
      R"("meshes":[{"extras":{"h":"of the mesh","i":5},"primitives":[]}])"));
  EXPECT_TRUE(imported.nodes.at(0).properties.empty() && imported.nodes.at(1).properties.empty());
  const std::map<std::string, PropertyValue> wanted{
      {"a", 1.0}, {"b", 1.0}, {"c", std::vector<double>{1, 2}}, {"g", std::vector<double>{3, 4}},
      {"h", "x"}, {"i", 5.0}};
  EXPECT_EQ(imported.nodes.at(2).properties, wanted);
}

TEST(GltfFile, DamageAndOtherVersionsAreErrors) {
  EXPECT_ERROR(temporary("old.gltf", R"({"asset":{"version":"1.0"}})"), "glTF of version 1.0");
  EXPECT_ERROR(temporary("half.gltf", R"({"asset":{"version":"2.0"},"nodes":[)"),
               "damaged at byte");
  EXPECT_ERROR(file("large.gltf", R"("nodes":[{"translation":[1e999,0,0]}])"),
               "a number in its JSON is too large");
  EXPECT_ERROR(file("other.gltf", R"("nodes":[{"mesh":0}],"meshes":[{"primitives":[7]}])"),
               "its JSON is not that of glTF 2");
  EXPECT_ERROR(
      file(
          "ring.gltf",
          R"("scenes":[{"nodes":[0]}],"nodes":[{"name":"a","children":[1]},{"name":"b","children":[0]}])"),
      "node \"a\" is in it twice");
  EXPECT_ERROR(file("faces.gltf", triangle(R"({"componentType":5126,"count":2,"type":"VEC2"})")),
               "not of type VEC3");
}

TEST(GltfFile, PointersToNodesMoveThem) {
  const std::vector<float> numbers{0, 1, 0, 0, 0, 1, 0, 0};  // two times, two places
  const auto path = file(
      "pointer.gltf",
      R"("nodes":[{"name":"a"}],"animations":[{"samplers":[{"input":0,"output":1}],"channels":[{"sampler":0,"target":{"path":"pointer","extensions":)"
      R"({"KHR_animation_pointer":{"pointer":"/nodes/0/translation"}}}},{"sampler":0,"target":{"path":"pointer","extensions":)"
      R"({"KHR_animation_pointer":{"pointer":"/materials/0/alphaCutoff"}}}}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":2,"type":"SCALAR"},)"
      R"({"bufferView":0,"byteOffset":8,"componentType":5126,"count":2,"type":"VEC3"}],"bufferViews":[{"buffer":0,"byteLength":32}],"buffers":[)" +
          buffer(data_uri(numbers), 32) + "]");
  const ImportedFile imported = import_in_process(path);
  ASSERT_EQ(imported.takes.at(0).motions.size(), 1u);
  EXPECT_EQ(imported.takes[0].motions.at(0).translation.keys.at(1).value, Vector3d(1, 0, 0));
}

}  // namespace
}  // namespace paperbake
