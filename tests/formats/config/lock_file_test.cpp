#include "formats/config/lock_file.h"

#include "core/model/error.h"
#include "tests/own_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace paperbake {
namespace {

std::filesystem::path written(const std::string& text) {
  const auto path = test::own_folder() / "lock_file_test.toml";
  std::ofstream(path) << text;
  return path;
}

const std::string lock = R"(program = "paperbake"
[scene]
fps = 25.0  # file
[bake]
method = "fem"
stop = 1e-06
gravity = 9.81
[paper."paper.left"]
preset = "copy90"
thickness = 0.00011
bending_stiffness = 0.0005
membrane_stiffness = 450000.0
poisson = 0.25
area_density = 0.09
apex_scatter = 0.004
yield_strain = 0.005
hardening = 0.2
seed = 3
)";

TEST(LockFile, HasTheSettingsOfTheSimulation) {
  const LockedJob job = read_lock(written(lock));
  EXPECT_EQ(job.method, "fem");
  EXPECT_EQ(job.fps, 25);
  EXPECT_EQ(job.stop, 1e-6);
  EXPECT_EQ(job.gravity, 9.81);
  ASSERT_EQ(job.papers.count("paper.left"), 1u);
  const Paper& paper = job.papers.at("paper.left");
  EXPECT_EQ(paper.name, "copy90");
  EXPECT_EQ(paper.bending_stiffness, 0.0005);
  EXPECT_EQ(paper.poisson, 0.25);
  EXPECT_EQ(paper.hardening, 0.2);
}

TEST(LockFile, AMissingKeyIsNamed) {
  std::string cut = lock;
  cut.replace(cut.find("thickness = 0.00011\n"), 20, "");
  for (const auto& [text, cause] : {std::pair<std::string, std::string>{cut, "thickness"},
                                    {"[bake\n", "]"},
                                    {"x = 1\n", "bake"}}) {
    try {
      read_lock(written(text));
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.code, ErrorCode::command);
      EXPECT_NE(std::string(error.what()).find(cause), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace paperbake
