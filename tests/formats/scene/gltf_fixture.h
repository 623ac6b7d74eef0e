#pragma once

#include "core/model/sheet.h"
#include "tests/own_folder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace paperbake::test {

/// A mesh for a glTF file. Here z is up; it is written with y up.
struct FlatMesh {
  std::vector<Vector3d> x;   // units of the file
  std::vector<Vector2d> uv;  // or empty
  std::vector<int> corners;  // three per triangle
};

/// A sheet of nx x ny cells of two triangles each. keep: which cells are paper, default all; bend:
/// maps points of the pattern to space.
inline FlatMesh grid(int nx, int ny, double width, double height,
                     const std::function<bool(int, int)>& keep = nullptr,
                     const std::function<Vector3d(double, double)>& bend = nullptr) {
  FlatMesh mesh;
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) {
      const double u = width * i / nx, v = height * j / ny;
      mesh.x.push_back(bend ? bend(u, v) : Vector3d(u, v, 0));
      mesh.uv.push_back(Vector2d(u, v) / std::max(width, height));
    }
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      if (keep && !keep(i, j)) continue;
      const int a = j * (nx + 1) + i, b = a + 1, c = a + nx + 1, d = c + 1;
      mesh.corners.insert(mesh.corners.end(), {a, b, d, a, d, c});
    }
  return mesh;
}

/// Writes small .gltf files, also with content that no exporter would write.
class GltfFixture {
 public:
  /// extras: JSON object, e.g. {"paper_gsm": 70}
  int mesh(const std::string& name, const FlatMesh& mesh, const std::string& extras = "{}") {
    std::vector<float> x, uv;
    for (const Vector3d& p : mesh.x) append(x, p);
    // glTF counts v downwards
    for (const Vector2d& p : mesh.uv) uv.insert(uv.end(), {float(p.x()), float(1 - p.y())});
    std::string attributes = fmt::format(R"("POSITION":{})", floats(x, "VEC3", 3));
    if (!uv.empty()) attributes += fmt::format(R"(,"TEXCOORD_0":{})", floats(uv, "VEC2", 2));
    attributes += std::exchange(attributes_, "");
    meshes_.push_back(
        fmt::format(R"({{"name":"{}","primitives":[{{"attributes":{{{}}},"indices":{}}}]}})", name,
                    attributes, indices(mesh.corners)));
    return node(name, Vector3d::Zero(), extras, fmt::format(R"("mesh":{},)", meshes_.size() - 1));
  }

  /// Gives the next mesh another attribute.
  /// component  5121 for bytes, 5123 for shorts, 5126 for floats
  /// values     width numbers for each vertex
  /// members    further members of the accessor's JSON, each after a comma
  template <class Number>
  void attribute(const std::string& semantic, int component, std::size_t width,
                 const std::vector<Number>& values, const std::string& members = "") {
    const std::string type = width == 1 ? "SCALAR" : fmt::format("VEC{}", width);
    attributes_ += fmt::format(R"(,"{}":{})", semantic,
                               accessor(values.data(), values.size() * sizeof(Number), component,
                                        values.size() / width, type.c_str(), members));
  }

  /// A mesh of lines without faces. corners: two per line
  int lines(const std::string& name, const std::vector<Vector3d>& points,
            const std::vector<int>& corners, const std::string& extras = "{}") {
    std::vector<float> x;
    for (const Vector3d& p : points) append(x, p);
    meshes_.push_back(fmt::format(
        R"({{"name":"{}","primitives":[{{"mode":1,"attributes":{{"POSITION":{}}},"indices":{}}}]}})",
        name, floats(x, "VEC3", 3), indices(corners)));
    return node(name, Vector3d::Zero(), extras, fmt::format(R"("mesh":{},)", meshes_.size() - 1));
  }

  /// members: further members of the node's JSON, each followed by a comma
  int node(const std::string& name, const Vector3d& at, const std::string& extras = "{}",
           const std::string& members = "") {
    nodes_.push_back(fmt::format(R"({{{}"name":"{}","translation":[{},{},{}],"extras":{}}})",
                                 members, name, at.x(), at.z(), -at.y(), extras));
    roots_.push_back(static_cast<int>(nodes_.size()) - 1);
    return roots_.back();
  }

  void make_child(int node) { roots_.erase(std::find(roots_.begin(), roots_.end(), node)); }

  /// Adds an animation that moves a node, with frames of 1/24 s.
  void move(int node, const std::vector<int>& frames, const std::vector<Vector3d>& positions) {
    std::vector<float> values;
    for (const Vector3d& p : positions) append(values, p);
    animate(node, "translation", seconds(frames), values);
  }
  void scale(int node, const std::vector<int>& frames, const std::vector<double>& scales) {
    std::vector<float> values;
    for (double s : scales) values.insert(values.end(), 3, float(s));
    animate(node, "scale", seconds(frames), values);
  }

  /// Adds an animation with one sampler, in the axes of the file.
  /// path  translation, rotation or scale
  void animate(int node, const char* path, const std::vector<double>& seconds,
               const std::vector<float>& values, const char* interpolation = "LINEAR",
               int component = 5126) {
    const std::vector<float> times(seconds.begin(), seconds.end());
    const std::size_t width = std::string(path) == "rotation" ? 4 : 3;
    const char* type = width == 4 ? "VEC4" : "VEC3";
    int output;
    if (component == 5122) {  // normalized integers
      std::vector<std::int16_t> shorts;
      for (const float v : values)
        shorts.push_back(static_cast<std::int16_t>(std::lround(32767 * v)));
      output = accessor(shorts.data(), shorts.size() * 2, component, shorts.size() / width, type);
    } else {
      output = floats(values, type, width);
    }
    animations_.push_back(fmt::format(
        R"({{"name":"move {} {}","channels":[{{"sampler":0,"target":{{"node":{},"path":"{}"}}}}],"samplers":[{{"input":{},"output":{},"interpolation":"{}"}}]}})",
        node, char('a' + animations_.size()), node, path, floats(times, "SCALAR", 1), output,
        interpolation));
  }

  std::filesystem::path write(const std::string& file_name) const {
    const auto path = own_folder() / file_name;
    std::ofstream(path) << fmt::format(
        R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[{}]}}],"nodes":[{}],"meshes":[{}],"animations":[{}],"accessors":[{}],"bufferViews":[{}],)"
        R"("buffers":[{{"byteLength":{},"uri":"data:application/octet-stream;base64,{}"}}]}})",
        fmt::join(roots_, ","), fmt::join(nodes_, ","), fmt::join(meshes_, ","),
        fmt::join(animations_, ","), fmt::join(accessors_, ","), fmt::join(views_, ","),
        bytes_.size(), base64());
    return path;
  }

 private:
  static void append(std::vector<float>& to, const Vector3d& p) {
    to.insert(to.end(), {float(p.x()), float(p.z()), float(-p.y())});
  }

  static std::vector<double> seconds(const std::vector<int>& frames) {
    std::vector<double> seconds;
    for (int frame : frames) seconds.push_back(frame / 24.0);
    return seconds;
  }

  int floats(const std::vector<float>& values, const char* type, std::size_t width) {
    return accessor(values.data(), values.size() * 4, 5126, values.size() / width, type);
  }
  int indices(const std::vector<int>& values) {
    return accessor(values.data(), values.size() * 4, 5125, values.size(), "SCALAR");
  }
  int accessor(const void* data, std::size_t size, int component, std::size_t count,
               const char* type, const std::string& members = "") {
    views_.push_back(
        fmt::format(R"({{"buffer":0,"byteOffset":{},"byteLength":{}}})", bytes_.size(), size));
    accessors_.push_back(
        fmt::format(R"({{"bufferView":{},"componentType":{},"count":{},"type":"{}"{}}})",
                    views_.size() - 1, component, count, type, members));
    bytes_.append(static_cast<const char*>(data), size);
    return static_cast<int>(accessors_.size()) - 1;
  }

  std::string base64() const {
    const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes_.size(); i += 3) {
      unsigned group = 0;
      for (std::size_t k = 0; k < 3; ++k)
        group =
            group << 8 | (i + k < bytes_.size() ? static_cast<unsigned char>(bytes_[i + k]) : 0u);
      for (std::size_t k = 0; k < 4; ++k)
        text += i + k > bytes_.size() ? '=' : digits[group >> (18 - 6 * k) & 63];
    }
    return text;
  }

  std::string bytes_, attributes_;
  std::vector<std::string> nodes_, meshes_, animations_, accessors_, views_;
  std::vector<int> roots_;
};

}  // namespace paperbake::test
