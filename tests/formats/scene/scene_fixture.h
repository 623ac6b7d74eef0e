#pragma once

#include "core/model/error.h"
#include "formats/scene/scene_file.h"
#include "tests/formats/scene/gltf_fixture.h"
#include "tests/own_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

/// Scene files for tests (samples, files of given bytes, files written by hand), and queries on the
/// scenes read from them.
namespace paperbake::test {

inline std::filesystem::path sample(const std::string& file) {
  return std::filesystem::path(PAPERBAKE_SAMPLES) / file;
}

inline std::string whole(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline std::filesystem::path temporary(const std::string& name, const std::string& text) {
  const auto path = own_folder() / name;
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

/// A sheet, by default a square of 0.2 m, with two handles, one of which moves by 2 cm from frame 1
/// to 5.
struct HeldSheet : GltfFixture {
  int paper = -1, fixed = -1, moved = -1;
  explicit HeldSheet(const FlatMesh& mesh = grid(4, 4, 0.2, 0.2),
                     const std::string& sheet_extras = "{}",
                     const std::string& handle_extras = "{}", double unit = 1,
                     const char* sheet_name = "paper") {
    paper = this->mesh(sheet_name, mesh, sheet_extras);
    fixed = node("handle.fixed", mesh.x.front());
    moved = node("handle.moved", mesh.x.back(), handle_extras);
    move(moved, {1, 5}, {mesh.x.back(), mesh.x.back() - Vector3d(0.02 * unit, 0, 0)});
  }
};

inline const Handle& handle(const Scene& scene, const std::string& name) {
  for (const SceneSheet& sheet : scene.sheets)
    for (const Handle& handle : sheet.handles)
      if (handle.name == name) return handle;
  throw std::runtime_error("no handle " + name);
}

inline bool has_warning(const Scene& scene, const std::string& words) {
  return std::any_of(scene.warnings.begin(), scene.warnings.end(),
                     [&](const std::string& w) { return w.find(words) != std::string::npos; });
}

/// The text of the error of reading a file, or "" when it can be read.
inline std::string error_of(const std::filesystem::path& path, const SceneOptions& options = {}) {
  try {
    read_scene(path, options);
  } catch (const Error& error) {
    EXPECT_EQ(error.code, ErrorCode::scene);
    EXPECT_FALSE(error.remedy.empty()) << error.what();
    return error.what();
  }
  return "";
}

/// Expects that the scene cannot be read, with an error that contains these words.
#define EXPECT_ERROR(path, words)                                           \
  EXPECT_NE(paperbake::test::error_of(path).find(words), std::string::npos) \
      << paperbake::test::error_of(path)

}  // namespace paperbake::test
