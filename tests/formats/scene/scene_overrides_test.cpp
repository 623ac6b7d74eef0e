#include "formats/scene/scene_overrides.h"

#include "core/model/error.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

ImportedFile scene_with(const std::vector<std::string>& names) {
  ImportedFile file;
  for (const std::string& name : names) {
    file.nodes.emplace_back();
    file.nodes.back().name = name;
  }
  return file;
}

double radius_of(const ImportedNode& node) {
  const auto found = node.properties.find("paper_radius");
  return found == node.properties.end() ? -1 : std::get<double>(found->second);
}

NodeOverride radius(const std::string& pattern, double value) {
  return {NodeOverride::handle, pattern, "job.toml:1:1", {{"paper_radius", value}}, {}};
}

TEST(SceneOverrides, NamesMatchAPatternWithoutNamespaceCaseAndNumber) {
  EXPECT_TRUE(name_is_like("rig:Grip_Left.001", "GRIP*"));
  EXPECT_TRUE(name_is_like("rig:Grip_Left.001", "grip.l?ft"));
  EXPECT_TRUE(name_is_like("handle-a-b-a-b", "*a?b"));
  EXPECT_TRUE(name_is_like("handle", "h**e"));
  EXPECT_FALSE(name_is_like("handle", "hand"));
  EXPECT_FALSE(name_is_like("handle", "handle?"));
  EXPECT_FALSE(name_is_like("handle.b", "*a"));
  EXPECT_FALSE(name_is_like(std::string(3000, 'a') + "b", "*a*a*a*a*a*a*a*a*c"))
      << "and it comes to an end";
}

TEST(SceneOverrides, AFullNameMatchesOneNodeAndALaterSectionWins) {
  ImportedFile file = scene_with({"handle", "handle.001", "handle.002", "table"});
  const auto given = apply_overrides(file, {radius("handle*", 1), radius("handle.001", 2)});
  EXPECT_EQ(radius_of(file.nodes[0]), 1);
  EXPECT_EQ(radius_of(file.nodes[1]), 2);
  EXPECT_EQ(radius_of(file.nodes[2]), 1);
  EXPECT_EQ(radius_of(file.nodes[3]), -1) << "no handle";
  EXPECT_EQ(given[2].places.at("paper_radius"), "job.toml:1:1");
}

TEST(SceneOverrides, APointMakesABoneAHandleButNotTheLeafAtItsEnd) {
  ImportedFile file = scene_with({"arm", "arm_end"});
  file.nodes[1].parent = 0;
  apply_overrides(
      file,
      {{NodeOverride::handle, "arm*", "job.toml:1:1", {{"paper_point", std::string("tail")}}, {}}});
  EXPECT_EQ(file.nodes[0].properties.count("paper_point"), 1u);
  EXPECT_EQ(file.nodes[1].properties.count("paper_point"), 0u);
}

TEST(SceneOverrides, APresetReplacesThePaperPropertiesOfTheScene) {
  ImportedFile file = scene_with({"paper"});
  file.nodes[0].meshes = {0};
  file.nodes[0].properties = {{"paper_gsm", 200.0}, {"paper_thickness", 1e-4}, {"paper_seed", 3.0}};
  apply_overrides(file, {{NodeOverride::sheet,
                          "paper",
                          "job.toml:1:1",
                          {{"paper_preset", std::string("copy90")}, {"paper_thickness", 2e-4}},
                          {}}});
  EXPECT_EQ(file.nodes[0].properties.count("paper_gsm"), 0u);
  EXPECT_EQ(std::get<double>(file.nodes[0].properties.at("paper_thickness")), 2e-4);
  EXPECT_EQ(file.nodes[0].properties.count("paper_seed"), 1u);
}

TEST(SceneOverrides, APatternWithoutAMatchIsAnErrorThatListsTheNames) {
  ImportedFile file = scene_with({"handle.a", "handle.b"});
  try {
    apply_overrides(file, {radius("grip", 1)});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code, ErrorCode::command);
    EXPECT_EQ(error.place, "job.toml:1:1");
    EXPECT_NE(error.remedy.find("\"handle.a\", \"handle.b\""), std::string::npos) << error.remedy;
  }
}

}  // namespace
}  // namespace paperbake
