#pragma once

#include "core/geometry/collider.h"
#include "core/model/handles.h"
#include "core/model/pattern.h"
#include "formats/scene/scene_overrides.h"

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace paperbake {

/// What the command line may say about a scene file; what it leaves open is taken from the file.
struct SceneOptions {
  // [1/s]   else FBX's own, else paper_fps, else 24 with a warning
  std::optional<double> fps;
  // frame of the first key, else the file's; 1 with a warning where the file has lost it
  std::optional<int> start_frame;
  // [m]     length of one unit of the file, replaces the file's own
  std::optional<double> unit_scale;
  std::optional<std::string> take;      // name of the one animation to use; else all are merged
  std::vector<NodeOverride> overrides;  // of a job file
};

/// One sheet of the scene with the handles that hold it.
struct SceneSheet {
  std::string name;  // full name of the node
  Pattern pattern;   // outline and holes of the imported mesh
  // the imported mesh, welded, at the first frame: pattern, x, triangles
  Sheet start;
  std::vector<Handle> handles;  // in order of the file
  // handles whose release frame is where their keyed scale falls under half
  std::set<std::string> scale_releases;
  std::optional<std::string> preset;  // paper_preset
  std::optional<double> grammage;     // paper_gsm, as in the file       [g/m2]
  std::optional<double> thickness;    // paper_thickness                 [m]
  // paper_friction, of the sheet on itself and on other sheets [1]
  std::optional<double> friction;
  std::optional<unsigned> seed;  // paper_seed
  // of preset, gsm, thickness, friction, seed: those that the job file says
  std::set<std::string> overridden;
  SingularPointRules pins;
  // of each of pattern.prescribed_creases: job, the mesh, "crease.diagonal"
  std::vector<std::string> crease_origin;
};

/// A property that a handle has from a job file.
struct GivenProperty {
  std::string handle, key;  // mode
  PropertyValue value;
};

/// A DCC file as the baker needs it. World space: right-handed, z up, metres; whole frames.
struct Scene {
  std::string source;  // file name without folder: for messages
  std::vector<SceneSheet> sheets;
  std::vector<ColliderMesh> colliders;  // in order of the file
  double fps = 24;                      // [1/s]
  int first_frame = 1, last_frame = 1;
  std::optional<double> gravity;      // paper_gravity [m/s2], positive = downwards
  std::vector<std::string> warnings;  // one sentence each
  std::vector<GivenProperty> given;
  // fps, first_frame, unit, up axis, ...: where each value came from
  std::map<std::string, std::string> origin;
};

/// Reads an FBX, glTF or GLB file. throws Error(Fault::scene): missing or unreadable file, no
/// sheet, no handle, a node twice, a size that cannot be paper, a handle that jumps more than 4
/// diagonals of the sheet in one frame. source: design.md, import.md
Scene read_scene(const std::filesystem::path&, const SceneOptions& = {});

/// The same of a file that is imported already (scene_import.h).
Scene scene_of(ImportedFile, std::string source, const SceneOptions& = {});

/// World positions of the origin of every node and bone at every whole frame of the clip, raw
/// names. Needs no sheet.
struct Tracks {
  int first_frame = 1;
  std::vector<std::string> names;
  std::vector<Points3> positions;  // per node |F|x3 [m], z up
};
Tracks read_tracks(const std::filesystem::path&, const SceneOptions& = {});

}  // namespace paperbake
