#pragma once

#include "core/model/sheet.h"
#include "tests/own_folder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace paperbake::test {

/// An animation curve for one component of a property: keys at frames, their interpolation, and the
/// extrapolation before the first and after the last key.
struct FbxCurve {
  std::vector<double> frames, values;
  // 4 linear, 2 constant, 258 constant with the value of the next key, 1032 cubic
  int flags = 4;
  std::vector<double> tangents = {};  // [1/s] for cubic: one per key, the same on both sides
  char before = 'C', after = 'C';     // C constant, K slope, R repeat, A repeat and add, M mirror
};

/// Writes small ASCII FBX files (y up, centimetres) with features that Maya and 3ds Max use and
/// Blender does not.
class FbxFixture {
 public:
  static constexpr std::int64_t second = 46186158000;
  double fps = 24;
  std::string settings = R"(P: "TimeMode", "enum", "", "",11)";  // 24 frames per second
  std::string creator = "FBX SDK/FBX Plugins version 2020.3";

  /// kind: Null, or LimbNode for a bone, whose attribute gets bone_properties. parent: 0 for a
  /// root.
  std::int64_t node(const std::string& name, std::int64_t parent = 0,
                    const std::string& properties = "", const std::string& kind = "Null",
                    const std::string& bone_properties = "") {
    const std::int64_t id = next_id_++;
    objects_ += fmt::format(
        "Model: {}, \"Model::{}\", \"{}\" {{\nVersion: 232\nProperties70: {{\n{}\n}}\n}}\n", id,
        name, kind, properties);
    connect(id, parent);
    if (kind == "LimbNode") {
      const std::int64_t bone = next_id_++;
      objects_ += fmt::format(
          "NodeAttribute: {}, \"NodeAttribute::\", \"LimbNode\" {{\nProperties70: "
          "{{\n{}\n}}\nTypeFlags: \"Skeleton\"\n}}\n",
          bone, bone_properties);
      connect(bone, id);
    }
    return id;
  }

  static std::string property(const std::string& name, const std::string& type,
                              const std::string& value) {
    return fmt::format("P: \"{}\", \"{}\", \"\", \"A+U\",{}\n", name, type, value);
  }
  static std::string vector(const std::string& name, const Vector3d& v) {
    return fmt::format("P: \"{}\", \"{}\", \"\", \"A+\",{},{},{}\n", name, name, v.x(), v.y(),
                       v.z());
  }

  std::int64_t stack(const std::string& name, double first, double last) {
    stack_ = next_id_++;
    objects_ += fmt::format(
        "AnimationStack: {}, \"AnimStack::{}\", \"\" {{\nProperties70: {{\nP: \"LocalStart\", "
        "\"KTime\", \"Time\", \"\",{}\nP: \"LocalStop\", \"KTime\", \"Time\", \"\",{}\n}}\n}}\n",
        stack_, name, ticks(first), ticks(last));
    return stack_;
  }
  /// Adds a layer to the last stack.
  std::int64_t layer(const std::string& properties = "") {
    const std::int64_t id = next_id_++;
    objects_ += fmt::format(
        "AnimationLayer: {}, \"AnimLayer::L{}\", \"\" {{\nProperties70: {{\n{}\n}}\n}}\n", id, id,
        properties);
    connect(id, stack_);
    return id;
  }
  /// Adds a curve. property: e.g. "Lcl Translation"; axis: X, Y or Z; rest: the property's value
  void curve(std::int64_t layer, std::int64_t node, const std::string& property, char axis,
             const FbxCurve& c, const Vector3d& rest = Vector3d::Zero()) {
    const std::int64_t values = next_id_++, id = next_id_++;
    objects_ += fmt::format(
        "AnimationCurveNode: {}, \"AnimCurveNode::T\", \"\" {{\nProperties70: {{\nP: \"d|X\", "
        "\"Number\", \"\", \"A\",{}\nP: \"d|Y\", \"Number\", \"\", \"A\",{}\nP: \"d|Z\", "
        "\"Number\", \"\", \"A\",{}\n}}\n}}\n",
        values, rest.x(), rest.y(), rest.z());
    const std::size_t n = c.frames.size();
    const std::vector<int> flags(n, c.flags), ones(n, 1);
    std::vector<std::int64_t> times;
    std::vector<int> data;  // tangents on the right and on the next key's left, weights of a third
    const auto slope = [&](std::size_t i) {
      return i < c.tangents.size() ? bits(float(c.tangents[i])) : 0;
    };
    for (std::size_t k = 0; k < n; ++k) {
      times.push_back(ticks(c.frames[k]));
      data.insert(data.end(), {slope(k), slope(k + 1), 218434821, 0});
    }
    const auto array = [](const char* name, const auto& list) {
      return fmt::format("{}: *{} {{\na: {}\n}}\n", name, list.size(), fmt::join(list, ","));
    };
    objects_ +=
        fmt::format("AnimationCurve: {}, \"AnimCurve::\", \"\" {{\nDefault: 0\nKeyVer: 4009\n",
                    id) +
        array("KeyTime", times) + array("KeyValueFloat", c.values) + array("KeyAttrFlags", flags) +
        array("KeyAttrDataFloat", data) + array("KeyAttrRefCount", ones);
    for (const auto& [name, mode] : {std::pair("Pre", c.before), std::pair("Post", c.after)})
      objects_ +=
          fmt::format("{}-Extrapolation: {{\nType: {}\nRepetition: -1\n}}\n", name, int(mode));
    objects_ += "}\n";
    connect(values, layer);
    connect(values, node, property);
    connect(id, values, std::string("d|") + axis);
  }

  std::filesystem::path write(const std::string& file_name) const {
    const auto path = own_folder() / file_name;
    std::ofstream(path) << fmt::format(
        "; FBX 7.7.0 project file\n; ----\n\nFBXHeaderExtension: {{\nFBXHeaderVersion: "
        "1004\nFBXVersion: 7700\nCreator: \"{}\"\n}}\nGlobalSettings: {{\nVersion: "
        "1000\nProperties70: {{\n"
        "P: \"UpAxis\", \"int\", \"Integer\", \"\",1\nP: \"UpAxisSign\", \"int\", \"Integer\", "
        "\"\",1\nP: \"FrontAxis\", \"int\", \"Integer\", \"\",2\nP: \"FrontAxisSign\", \"int\", "
        "\"Integer\", \"\",1\n"
        "P: \"CoordAxis\", \"int\", \"Integer\", \"\",0\nP: \"CoordAxisSign\", \"int\", "
        "\"Integer\", \"\",1\nP: \"UnitScaleFactor\", \"double\", \"Number\", \"\",1\n{}\n}}\n}}\n"
        "Objects: {{\n{}}}\nConnections: {{\n{}}}\n",
        creator, settings, objects_, connections_);
    return path;
  }

 private:
  std::int64_t ticks(double frame) const { return std::llround(frame / fps * second); }
  static int bits(float f) {
    int i;
    std::memcpy(&i, &f, sizeof i);
    return i;
  }
  void connect(std::int64_t what, std::int64_t to, const std::string& property = "") {
    connections_ += property.empty() ? fmt::format("C: \"OO\",{},{}\n", what, to)
                                     : fmt::format("C: \"OP\",{},{}, \"{}\"\n", what, to, property);
  }

  std::string objects_, connections_;
  std::int64_t next_id_ = 1000, stack_ = 0;
};

}  // namespace paperbake::test
