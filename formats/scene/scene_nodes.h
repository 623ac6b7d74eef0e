#pragma once

#include "formats/scene/scene_file.h"
#include "formats/scene/scene_import.h"

#include <Eigen/Geometry>

#include <map>
#include <string>
#include <vector>

namespace paperbake {

/// The nodes of a DCC file with times in frames, and what is needed to place them in a world in
/// metres with z up.
struct SceneNodes {
  std::string source;  // file name without folder
  ImportedFile file;
  // of each node, with times in frames; without any keys the node keeps its local transform
  std::vector<Motion> motions;
  // of each node, with times in frames: x of each track is the weight of one blend shape
  std::vector<std::vector<Track<Vector3d>>> shapes;
  double unit = 1;                                // [m] of one unit of the file
  double fps = 24;                                // [1/s]
  int first_frame = 1, last_frame = 1;            // of the keys, or of curves that go on
  int first_clip_frame = 1, last_clip_frame = 1;  // of the clip, which includes the keys
  std::vector<std::string> warnings;
  std::map<std::string, std::string> origin;
};

/// Merges the takes of a file and determines frames, unit and axes. Each node follows one take:
/// preferably one that moves it, then one that passes through its rest position, then the one with
/// most keys. frame = seconds x fps, rounded to the nearest whole frame when within 0.01. The first
/// key is moved to options.start_frame, if given; else a file that has lost its start frame begins
/// at frame 1.
/// throws Error(ErrorCode::scene) for an unknown take, or an implausible fps, unit or clip length
SceneNodes scene_nodes(ImportedFile, std::string source, const SceneOptions&);

/// World transform of every node at a frame, in metres with z up. The columns of its linear part
/// are as long [m] as one unit of the node's own space.
std::vector<Eigen::Affine3d> world_at(const SceneNodes&, int frame);

/// Origin of a node in the world [m], without the offset that FBX applies to its mesh only.
Vector3d origin_of(const SceneNodes&, const std::vector<Eigen::Affine3d>& world, int node);

}  // namespace paperbake
