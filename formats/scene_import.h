#pragma once

#include "core/sheet.h"

#include <Eigen/Geometry>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace paperbake {

/// A custom property of a node. Whole numbers and truth values come as numbers, arrays of numbers as lists.
using PropertyValue = std::variant<double, std::string, std::vector<double>>;

template <class Value>
struct Key {
  double time;                                      // [s] in a file, frames in a scene
  Value value;
};

/// What one take says about one node: its local transform is T R S, each part keyed by itself; an empty part is the identity.
struct Motion {
  std::vector<Key<Vector3d>> translation, scale;
  std::vector<Key<Eigen::Quaterniond>> rotation;
};

struct ImportedNode {
  std::string name;                                 // raw; for a pivot: that of the node it belongs to
  int parent = -1;                                  // comes before its children; -1: none
  Eigen::Affine3d local;                            // where no take moves it
  bool pivot = false;                               // a part of an FBX node's transform, no node of the file
  bool offsets_mesh_only = false;                   // a pivot that moves the mesh, not the node (FBX geometric transform)
  std::vector<int> meshes;
  std::map<std::string, PropertyValue> properties;
};

/// A mesh in the space of its node.
struct ImportedMesh {
  Points3 x;                                        // |V|x3  units of the file
  Points2 uv;                                       // |V|x2  or empty
  Triangles triangles;
  bool deformed = false;                            // by bones or blend shapes, which are not followed
};

/// A stack (FBX) or animation (glTF).
struct Take {
  std::string name;
  double seconds = 0;                               // length; in FBX from its start, which is time 0
  std::map<int, Motion> motions;                    // node -> motion
};

/// A DCC file as it is: its own units, axes and seconds.
struct ImportedFile {
  bool fbx = false;                                 // else glTF
  std::vector<ImportedNode> nodes;                  // in order of the file
  std::vector<ImportedMesh> meshes;
  std::vector<Take> takes;
  double unit = 1;                                  // [m]    length of one unit
  double fps = 0;                                   // [1/s]  0: the file does not say
  Eigen::Matrix3d to_z_up = Eigen::Matrix3d::Identity();
  std::string up_axis;                              // for messages: "y up"
};

/// Reads an FBX, glTF or GLB file. Every number in it is finite and every triangle has its vertices.
/// The importer, which trusts what it reads, works in a process of its own (formats/apart.h) within limits of memory and time.
/// throws Error(Fault::scene): missing, damaged or foreign file, one that the importer does not survive. source: import.md
ImportedFile import_file(const std::filesystem::path&);

/// The same in this process, which a damaged file may end.
ImportedFile import_here(const std::filesystem::path&);

}  // namespace paperbake
