#pragma once

#include "formats/scene/scene_file.h"
#include "formats/scene/scene_import.h"

#include <Eigen/Geometry>

#include <map>
#include <string>
#include <vector>

namespace paperbake {

/// The nodes of a DCC file in time and space as the baker has them: whole frames, metres, z up.
struct SceneNodes {
  std::string source;  // file name without folder
  ImportedFile file;
  // per node, times in frames; all parts empty: the node keeps its local transform
  std::vector<Motion> motions;
  double unit = 1;                                // [m] of one unit of the file
  double fps = 24;                                // [1/s]
  int first_frame = 1, last_frame = 1;            // first and last key
  int first_clip_frame = 1, last_clip_frame = 1;  // the keys and the length the file gives its clip
  std::vector<std::string> warnings;
  std::map<std::string, std::string> origin;
};

/// Merges the takes of a file (for each node one that moves it, if it can from where the node
/// stands, with most keys), sets frames, unit and axes. frame = seconds x fps, rounded to the
/// nearest whole frame when within 0.01; FBX times begin at options.start_frame, else 1. throws
/// Error(Fault::scene): an unknown take, an fps, unit or clip length that cannot be meant
SceneNodes scene_nodes(ImportedFile, std::string source, const SceneOptions&);

/// World transform of every node at a frame, in metres, z up; between keys linear, rotations along
/// the shorter arc. The columns of its linear part are as long as one unit of the node's own space
/// in metres.
std::vector<Eigen::Affine3d> world_at(const SceneNodes&, int frame);

/// Origin of a node in the world; in FBX files without the offset that is meant for its mesh alone.
/// [m]
Vector3d origin_of(const SceneNodes&, const std::vector<Eigen::Affine3d>& world, int node);

}  // namespace paperbake
