#pragma once

#include "core/geometry/collider.h"
#include "core/model/air.h"
#include "core/model/authored_surface.h"
#include "core/model/handles.h"
#include "core/model/pattern.h"
#include "formats/scene/scene_overrides.h"
#include "formats/scene/scene_parts.h"

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace paperbake {

/// Settings of the command line for reading a scene file; what is not given comes from the file.
struct SceneOptions {
  // [1/s] default: that of an FBX file, else paper_fps, else 24 with a warning
  std::optional<double> fps;
  // frame of the first key; default: that of the file, or 1 with a warning where it is not known
  std::optional<int> start_frame;
  // [m] length of one unit of the file; default: what the file says
  std::optional<double> unit_scale;
  std::optional<std::string> take;      // name of the only take to use; default: all are merged
  std::vector<NodeOverride> overrides;  // from a job file
  Parts parts = Parts::of_its_folder;   // which files a .gltf may name as parts of it
};

/// A sheet of the scene with the handles that hold it.
struct SceneSheet {
  std::string name;  // full name of the node
  Pattern pattern;   // outline and holes of the imported mesh, and the prescribed creases
  // the imported mesh, welded, at the first frame: pattern, x, triangles
  Sheet start;
  // whether `start` is as bones and blend shapes put the mesh
  bool deformed = false;
  AuthoredSurface authored;     // attributes and materials of the imported mesh
  std::vector<Handle> handles;  // in order of the file
  // names of the handles that are released because their keyed scale falls below half
  std::set<std::string> scale_releases;
  std::optional<std::string> preset;  // paper_preset
  std::optional<double> grammage;     // [g/m2] paper_gsm
  std::optional<double> thickness;    // [m] paper_thickness
  // [1] paper_friction: coefficient of friction of the sheet on itself and on other sheets
  std::optional<double> friction;
  std::optional<unsigned> seed;  // paper_seed
  // those of preset, gsm, thickness, friction and seed that come from a job file
  std::set<std::string> overridden;
  SingularPointRules singular_point_rules;
  // where each prescribed crease comes from: "job", "edges marked in the mesh", the name of a node
  std::vector<std::string> crease_origin;
  // a sentence for each handle that is not on the sheet where it begins, one of the warnings too
  std::vector<std::string> handles_off;
};

/// A property of a handle that comes from a job file.
struct GivenProperty {
  std::string handle, key;  // key without paper_: mode
  PropertyValue value;
};

/// The content of a DCC file that the baker needs: sheets, handles, colliders and settings. World
/// space is right-handed, z up, in metres; times are whole frames.
struct Scene {
  std::string source;  // file name without folder, for messages
  std::vector<SceneSheet> sheets;
  std::vector<ColliderMesh> colliders;  // in order of the file
  double fps = 24;                      // [1/s]
  int first_frame = 1, last_frame = 1;
  std::optional<double> gravity;      // [m/s2] paper_gravity, positive downwards
  std::optional<double> air;          // [kg/m3] paper_air
  std::vector<Wind> winds;            // in order of the file
  std::vector<std::string> warnings;  // one sentence each
  std::vector<GivenProperty> given;
  // for fps, first_frame, unit, up_axis, ...: where the value comes from
  std::map<std::string, std::string> origin;
};

/// Reads the scene of an FBX, glTF or GLB file.
/// throws Error(ErrorCode::scene): a missing or unreadable file, no sheet, no handle, two sheets or
/// two handles of one name, a size that no sheet has, a handle that jumps more than 4 diagonals of
/// the sheet in one frame
Scene read_scene(const std::filesystem::path&, const SceneOptions& = {});

/// The scene of a file that has been imported (scene_import.h). Throws as read_scene does.
Scene scene_of(ImportedFile, std::string source, const SceneOptions& = {});

/// World positions of the origin of every node and bone at every whole frame of the clip, under
/// their full names. The file needs no sheet.
struct Tracks {
  int first_frame = 1;
  std::vector<std::string> names;
  std::vector<Points3> positions;  // |F|x3 [m] of each node, z up
};
Tracks read_tracks(const std::filesystem::path&, const SceneOptions& = {});

}  // namespace paperbake
