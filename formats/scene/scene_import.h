#pragma once

#include "core/model/error.h"
#include "core/model/sheet.h"
#include "formats/scene/scene_tracks.h"

#include <Eigen/Geometry>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace paperbake {

/// A custom property of a node. Whole numbers and truth values come as numbers, arrays of numbers
/// as lists.
using PropertyValue = std::variant<double, std::string, std::vector<double>>;

/// What one take says about one node: its local transform is T R S, each part keyed by itself; an
/// empty part is the identity.
struct Motion {
  Track<Vector3d> translation, scale;
  Track<Eigen::Quaterniond> rotation;
  // [as the tracks] what was keyed, in order: tracks may be sampled between these
  std::vector<double> key_times;
};

struct ImportedNode {
  // raw; for a pivot: that of the node it belongs to
  std::string name;
  int parent = -1;                                      // comes before its children; -1: none
  Eigen::Affine3d local = Eigen::Affine3d::Identity();  // where no take moves it, but for `scale`
  Vector3d scale = Vector3d::Ones();
  // the parent's scale moves its origin, but does not scale it (FBX InheritType RrSs, Rrs)
  bool own_scale = false;
  // then: the node above whose scale it is multiplied by; -1: none
  int scale_from = -1;
  // a part of an FBX node's transform, no node of the file
  bool pivot = false;
  // a pivot that moves the mesh, not the node (FBX geometric transform)
  bool offsets_mesh_only = false;
  std::vector<int> meshes;
  std::map<std::string, PropertyValue> properties;
};

/// Ends of edges, as vertices.
using Edges = Eigen::Matrix<int, Eigen::Dynamic, 2, Eigen::RowMajor>;

/// A mesh in the space of its node.
struct ImportedMesh {
  Points3 x;   // |V|x3  units of the file
  Points2 uv;  // |V|x2  or empty
  Triangles triangles;
  // |E|x2  edges that are marked as creases, or that belong to no face
  Edges creases;
  // by bones or blend shapes, which are not followed
  bool deformed = false;
};

/// A stack (FBX) or animation (glTF).
struct Take {
  std::string name;
  double begin = 0, end = 0;      // [s] as the file says; equal: it does not
  std::map<int, Motion> motions;  // node -> motion
};

/// A DCC file as it is: its own units, axes and seconds.
struct ImportedFile {
  bool fbx = false;  // else glTF
  // times count from the clip's start, and its frame is not known
  bool start_lost = false;
  std::string reader;                 // for messages: what read the curves
  std::vector<std::string> warnings;  // one sentence each
  std::vector<ImportedNode> nodes;    // in order of the file
  std::vector<ImportedMesh> meshes;
  std::vector<Take> takes;
  double unit = 1;  // [m]    length of one unit
  double fps = 0;   // [1/s]  0: the file does not say
  Eigen::Matrix3d to_z_up = Eigen::Matrix3d::Identity();
  std::string up_axis;  // for messages: "y up"
};

/// The remedy for a damaged file.
inline const char* const export_again =
    "Export the file again as FBX, glTF or GLB and check that it opens in the DCC.";

/// The error of a file of another kind.
Error foreign_file(const std::filesystem::path&);

/// Reads an FBX, glTF or GLB file. Every number in it is finite and every triangle has its
/// vertices. The importer, which trusts what it reads, works in a process of its own
/// (formats/scene/sandbox.h) within limits of memory and time. fps: of the frames that will be
/// asked for, where it is not the file's own; curves of FBX are sampled there throws
/// Error(Fault::scene): missing, damaged or foreign file, one that the importer does not survive.
/// source: import.md
ImportedFile import_file(const std::filesystem::path&, std::optional<double> fps = {});

/// The same in this process, which a damaged file may end.
ImportedFile import_in_process(const std::filesystem::path&, std::optional<double> fps = {});

}  // namespace paperbake
