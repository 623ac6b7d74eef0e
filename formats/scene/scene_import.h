#pragma once

#include "core/model/authored_surface.h"
#include "core/model/error.h"
#include "core/model/sheet.h"
#include "formats/scene/scene_parts.h"
#include "formats/scene/scene_tracks.h"

#include <Eigen/Geometry>

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace paperbake {

/// The value of a custom property. Integers and booleans are stored as numbers, arrays of numbers
/// as lists.
using PropertyValue = std::variant<double, std::string, std::vector<double>>;

/// The motion of a node in a take: its local transform is T R S with separately keyed parts; a part
/// without keys is the identity.
struct Motion {
  Track<Vector3d> translation, scale;
  Track<Eigen::Quaterniond> rotation;
  // [s] times of the original keys, in order; the tracks may be samples between them
  std::vector<double> key_times;
};

/// Visits the three tracks of a motion.
template <class AnyMotion, class Visit>
void for_each_track(AnyMotion& motion, Visit visit) {
  visit(motion.translation);
  visit(motion.rotation);
  visit(motion.scale);
}

struct ImportedNode {
  // full name; for a pivot that of the node to which it belongs
  std::string name;
  int parent = -1;                                      // comes before its children; -1 for a root
  Eigen::Affine3d local = Eigen::Affine3d::Identity();  // at rest, without `scale`
  Vector3d scale = Vector3d::Ones();
  // the parent's scale acts on its origin only (FBX InheritType RrSs, Rrs)
  bool own_scale = false;
  // for own_scale: the ancestor by whose scale its own is multiplied; -1: none
  int scale_from = -1;
  // a part of the transform of an FBX node, not a node of the file
  bool pivot = false;
  // a pivot that moves the mesh but not the node (FBX geometric transform)
  bool offsets_mesh_only = false;
  std::vector<int> meshes;
  std::map<std::string, PropertyValue> properties;
};

/// Edges by the indices of their end vertices.
using Edges = Eigen::Matrix<int, Eigen::Dynamic, 2, Eigen::RowMajor>;

/// How bones move the vertices of a mesh: sum over its influences of
/// weight x bone's place x to_bone x vertex, over the sum of the weights.
struct Skin {
  std::vector<int> bones;                // nodes
  std::vector<Eigen::Affine3d> to_bone;  // of each: from the space of the mesh to that of the bone
  Eigen::Matrix<int, Eigen::Dynamic, 2, Eigen::RowMajor> influences;  // vertex, index into bones
  Eigen::VectorXd weights;                                            // [1] of each influence
};

/// A mesh in the space of its node.
struct ImportedMesh {
  Points3 x;  // |V|x3 in units of the file
  // a row for each vertex: the uv sets in order of the file, then the others
  std::vector<AuthoredAttribute> attributes;
  Triangles triangles;
  std::vector<std::string> materials;  // names
  // |T| of each triangle, in `materials`; -1: none. Empty without materials
  std::vector<int> material_of;
  // |E|x2 edges that are marked as creases or belong to no face
  Edges creases;
  // it has bones, blend shapes or a cache
  bool deformed = false;
  // what of that is not followed, in words; empty: all is
  std::string not_followed = {};
  Skin skin = {};                           // without bones: there is none
  std::vector<Points3> targets = {};        // |V|x3 displacements of each blend shape at weight 1
  std::vector<double> target_weights = {};  // of each, at rest
};

/// An animation of the scene: a stack (FBX) or animation (glTF).
struct Take {
  std::string name;
  double begin = 0, end = 0;      // [s] as stated in the file; equal when it is not
  std::map<int, Motion> motions;  // by index of the node
  // by index of the node: x of each track is the weight of one blend shape of its meshes
  std::map<int, std::vector<Track<Vector3d>>> shapes = {};
};

/// The content of a DCC file in its own units and axes, with times in seconds.
struct ImportedFile {
  bool fbx = false;  // else glTF
  // times count from the start of the clip, whose frame is not known
  bool start_lost = false;
  std::string reader;                 // how the curves were read, for messages
  std::vector<std::string> warnings;  // one sentence each
  std::vector<ImportedNode> nodes;    // in order of the file
  std::vector<ImportedMesh> meshes;
  std::vector<Take> takes;
  double unit = 1;  // [m] length of one unit
  double fps = 0;   // [1/s] 0 when the file does not state it
  Eigen::Matrix3d to_z_up = Eigen::Matrix3d::Identity();
  std::string up_axis;  // "y up", for messages
};

/// The remedy for a damaged file.
inline const char* const export_again =
    "Export the file again as FBX, glTF or GLB and check that it opens in the DCC.";

/// The error for a file that is neither FBX nor glTF.
Error foreign_file(const std::filesystem::path&);

/// Reads an FBX, glTF or GLB file in a sandboxed process with limited memory and time (sandbox.h),
/// so that a malformed file cannot crash this one. In the result every number is finite, every
/// triangle has its vertices and every node comes after its parent.
/// fps     [1/s] rate of the frames at which curves of FBX are sampled, default: that of the file
/// throws  Error(ErrorCode::scene) for a missing file, one of another format, a damaged file, or
///         one whose import crashes or exceeds the limits
ImportedFile import_file(const std::filesystem::path&, std::optional<double> fps = {},
                         Parts = Parts::of_its_folder);

/// The same within this process, which a malformed file may crash. For the sandboxed process
/// itself, and for tests.
ImportedFile import_in_process(const std::filesystem::path&, std::optional<double> fps = {},
                               Parts = Parts::of_its_folder);

}  // namespace paperbake
