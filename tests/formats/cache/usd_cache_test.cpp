#include "formats/cache/usd_cache.h"

#include "formats/files/atomic_file.h"
#include "tests/own_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

namespace paperbake {
namespace {

namespace fs = std::filesystem;

/// A strip of `cells` squares, waving.
CacheFrame strip(int cells, int frame) {
  CacheFrame f;
  f.x.resize(2 * cells + 2, 3);
  f.triangles.resize(2 * cells, 3);
  for (int i = 0; i <= cells; ++i)
    for (const int side : {0, 1}) {
      f.x.row(2 * i + side) << 0.01 * i, 0.01 * side, 0.002 * std::sin(0.3 * i + 0.2 * frame);
    }
  for (int i = 0; i < cells; ++i) {
    f.triangles.row(2 * i) << 2 * i, 2 * i + 2, 2 * i + 1;
    f.triangles.row(2 * i + 1) << 2 * i + 1, 2 * i + 2, 2 * i + 3;
  }
  f.velocity = Points3::Constant(f.x.rows(), 3, 0.25 * frame);
  f.layers = {{"foldPeak", Eigen::VectorXd::Constant(f.x.rows(), 0.5)}};
  return f;
}

std::string layer(const fs::path& path, UsdEncoding encoding, int frames) {
  fs::remove(path);
  UsdWriter writer(path, encoding, {}, {"paper.A", "paper B"});
  for (int k = 0; k < frames; ++k)
    for (const std::size_t sheet : {0, 1}) writer.add_frame(sheet, strip(200, k));
  EXPECT_FALSE(fs::exists(path)) << "before it is whole";
  writer.finish();
  return read_file(path).value_or("");
}

TEST(UsdCache, TheSameCallsWriteTheSameBytes) {
  for (const auto encoding : {UsdEncoding::text, UsdEncoding::crate}) {
    const std::string first = layer(test::own_folder() / "first", encoding, 3);
    ASSERT_GT(first.size(), 1000u);
    EXPECT_EQ(first, layer(test::own_folder() / "second", encoding, 3));
  }
}

TEST(UsdCache, ABinaryLayerStoresEqualValuesOnce) {
  const fs::path path = test::own_folder() / "once.usdc";
  const std::size_t two = layer(path, UsdEncoding::crate, 2).size(),
                    ten = layer(path, UsdEncoding::crate, 10).size();
  // both sheets wave alike: a frame adds positions, velocities and a box, and what refers to them
  EXPECT_LT(ten - two, 8 * (2 * 402 * 12 + 1000));
  EXPECT_GT(ten - two, 8 * 2 * 402 * 12);
}

/// What stands after `begin` at the beginning of lines, up to a character of `end`.
std::vector<std::string> names_after(const std::string& text, const std::string& begin,
                                     const char* end) {
  std::vector<std::string> found;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    line.erase(0, std::min(line.find_first_not_of(' '), line.size()));
    if (line.compare(0, begin.size(), begin) == 0)
      found.push_back(
          line.substr(begin.size(), line.find_first_of(end, begin.size()) - begin.size()));
  }
  return found;
}

TEST(UsdCache, NamesThatBecomeTheSameIdentifierStayApart) {
  // two prims or attributes of one name make a layer that USD cannot open
  CacheFrame frame = strip(2, 0);
  MeshSurface surface;
  surface.materials = {"Paper.001", "Paper_001", "\u8868", "\u88cf"};
  surface.material_of = {0, 1, 2, 3};
  for (const char* name : {"st", "st", "foldPeak", "map.1", "map_1"})
    surface.attributes.push_back(
        {name, AttributeKind::uv, AttributeValues::Zero(1, 2), Triangles::Zero(4, 3)});
  surface.properties = {{"shot.name", std::string("a")}, {"shot_name", 2.0}};
  frame.surface = std::make_shared<MeshSurface>(surface);
  const fs::path path = test::own_folder() / "names.usda";
  UsdWriter writer(path, UsdEncoding::text, {}, {"paper"});
  writer.add_frame(0, frame);
  writer.finish();
  const std::string text = read_file(path).value_or("");
  const std::vector<std::string> materials{"Paper_001", "Paper_001_2", "_", "__2"};
  EXPECT_EQ(names_after(text, "def GeomSubset \"", "\""), materials);
  EXPECT_EQ(names_after(text, "def Material \"", "\""), materials);
  EXPECT_EQ(names_after(text, "rel material:binding = </shot/materials/", ">"), materials);
  EXPECT_EQ(names_after(text, "texCoord2f[] primvars:", " "),
            (std::vector<std::string>{"st", "st_2", "foldPeak_2", "map_1", "map_1_2"}));
  EXPECT_EQ(names_after(text, "custom string userProperties:", " "),
            std::vector<std::string>{"shot_name"});
  EXPECT_EQ(names_after(text, "custom double userProperties:", " "),
            std::vector<std::string>{"shot_name_2"});
}

TEST(UsdCache, AttributesHaveTheTypeOfTheirNumbers) {
  CacheFrame frame = strip(2, 0);
  frame.uv = Points2::Zero(frame.x.rows(), 2);
  MeshSurface surface;
  const auto add = [&](const char* name, AttributeKind kind, int width) {
    surface.attributes.push_back(
        {name, kind, AttributeValues::Constant(1, width, 0.5), Triangles::Zero(4, 3)});
  };
  add("Dye", AttributeKind::colour, 4);
  add("Tint", AttributeKind::colour, 3);
  for (int width = 1; width <= 4; ++width)
    add(("n" + std::to_string(width)).c_str(), AttributeKind::number, width);
  frame.surface = std::make_shared<MeshSurface>(surface);
  const fs::path path = test::own_folder() / "attributes.usda";
  UsdWriter writer(path, UsdEncoding::text, {}, {"paper"});
  writer.add_frame(0, frame);
  writer.finish();
  const std::string text = read_file(path).value_or("");
  for (const char* line :
       {"color4f[] primvars:Dye = [(0.5, 0.5, 0.5, 0.5)]",
        "color3f[] primvars:Tint = [(0.5, 0.5, 0.5)]", "float[] primvars:n1 = [0.5]",
        "float2[] primvars:n2 = [(0.5, 0.5)]", "float3[] primvars:n3 = [(0.5, 0.5, 0.5)]",
        "float4[] primvars:n4 = [(0.5, 0.5, 0.5, 0.5)]"})
    EXPECT_NE(text.find(line), std::string::npos) << line;
  EXPECT_EQ(names_after(text, "texCoord2f[] primvars:", " "),
            (std::vector<std::string>{"pattern", "st"}))
      << "there is no uv set: the pattern is it";
}

TEST(UsdCache, WithoutAnEndThereIsNoFile) {
  for (const auto encoding : {UsdEncoding::text, UsdEncoding::crate}) {
    const fs::path folder = test::own_folder() / "unfinished";
    fs::create_directory(folder);
    {
      UsdWriter writer(folder / "shot", encoding, {}, {"paper"});
      writer.add_frame(0, strip(10, 0));
      EXPECT_TRUE(fs::exists(folder / "shot.part"));
    }
    EXPECT_TRUE(fs::is_empty(folder));
  }
}

}  // namespace
}  // namespace paperbake
