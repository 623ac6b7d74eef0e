#pragma once

#include "baker/job/output_formats.h"
#include "core/model/paper.h"
#include "core/render/render_surface.h"
#include "core/step1_elastic/elastic.h"
#include "formats/config/job_file.h"
#include "formats/maps/map_info.h"
#include "formats/scene/scene_file.h"

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace paperbake {

/// Frames first, first + step, ... not beyond last.
struct FrameSpan {
  int first = 1, last = 1, step = 1;
  bool contains(int frame) const {
    return frame >= first && frame <= last && (frame - first) % step == 0;
  }
};
/// "A-B", "A-BxN" or "A". throws Error(ErrorCode::command) at `place`
FrameSpan parse_frames(const std::string& text, const std::string& place);
/// Spans separated by commas. throws as above
std::vector<FrameSpan> parse_frame_list(const std::string& text, const std::string& place);

enum class CacheMesh { render, simulation };
enum class Dynamics { automatic, off, on };
enum class ProgressMode { automatic, plain, json, none };
enum class Resume { automatic, never };

/// Who said a value, the later one wins.
enum class Origin { fallback, preset, scene, job, command };
const char* to_string(Origin);  // "default", ..., "command line"

/// "x,y,z". throws Error(ErrorCode::command) at `place`
Vector3d parse_wind(const std::string& text, const std::string& place);

/// One number of the paper, over preset and scene.
struct SetValue {
  std::string key;
  double value;  // SI
  Origin origin;
};

/// What job file and command line say about a bake. An empty option leaves the choice to scene,
/// preset or default.
struct BakeSettings {
  std::filesystem::path scene, output;
  // begins the names of the output files; empty: the scene's stem
  std::string name;
  std::string root = "/shot";  // prim of the USD layer below which the sheets are
  SceneOptions reading;
  std::optional<std::string> preset;  // grade or file
  std::vector<SetValue> set;          // in order
  std::string method = "hybrid";
  std::optional<unsigned> seed;
  // fem: its mesh (1,700); hybrid: the largest number (1,000)
  std::optional<int> triangles;
  int base_triangles = 120;  // of the hybrid
  // [% of the longer side] how exact the frames are to be: the size of the mesh is looked for
  std::optional<double> accuracy;
  std::optional<double> budget;  // [s] CPU time of the search and of the simulation
  // triangles of the fem that finishes every frame; 0: none
  std::optional<int> polish;
  std::optional<double> gravity;  // [m/s2]
  std::optional<double> air;      // [kg/m3]
  std::optional<Vector3d> wind;   // [m/s] besides those of the scene
  double stop = 1e-5;             // [m]
  bool twin = false;              // simulate a twin, to see where the scene branches
  Dynamics dynamics = Dynamics::automatic;
  int probe_every = 0;  // [frames] 0: never
  int attempts = 4;     // that are tried at most (baker/bake/attempts.h)
  std::optional<FrameSpan> frames;
  // one for the whole shot, or as it is simulated
  CacheMesh mesh = CacheMesh::render;
  bool guides = false;              // singular points and folds in the caches
  bool usd_layers = false;          // asset and animation of USD in layers of their own
  Quality quality = Quality::shot;  // of the render mesh
  std::set<std::string> formats = default_formats();
  int map_size = 1024;  // [texels]
  MapLayout map_layout = MapLayout::scanline;
  std::optional<std::vector<FrameSpan>> map_frames;     // none: every 12th
  std::optional<std::filesystem::path> debug_pictures;  // folder
  double max_stretch_pct = 5;
  bool strict = false;
  // go on from what an earlier bake left in the folder
  Resume resume = Resume::automatic;
  int checkpoint_every = 12;  // [frames]
  int threads = 2;
  ProgressMode progress = ProgressMode::automatic;
  std::optional<std::filesystem::path> log;  // file that gets a copy of what is told

  struct GivenOption {
    std::string text;  // canonical (formats/config/job_file.h)
    Origin origin;
  };
  // the options that were given, by name (baker/job/options.h)
  std::map<std::string, GivenOption> given;
  std::vector<JobSection> sheets, handles;  // of the job file, as it has them
  Origin origin(const std::string& option, Origin otherwise = Origin::fallback) const {
    const auto found = given.find(option);
    return found == given.end() ? otherwise : found->second.origin;
  }
};

/// key=value. throws Error(ErrorCode::command): unknown key (with the nearest name), no number,
/// none that paper has
SetValue parse_set(const std::string& text);

/// One value as it was used and who said so.
struct UsedValue {
  std::string key;     // table.key, as in job.lock.toml
  std::string value;   // TOML literal
  std::string origin;  // in words; or what decided it: auto
};

/// The paper of one sheet and where each number came from.
struct ResolvedPaper {
  Paper paper;
  std::string preset;  // grade or file that it was read from
  std::vector<UsedValue> used;
};

/// default < preset < scene < job < command line. A preset that the command line or the job names
/// replaces all that those before it say of the paper; in a job the preset of a [sheet] counts for
/// more than that for all, and [paper] for more than both. A sheet's gsm scales the nearest grade:
/// thickness and E h with the grammage, D with its cube; its thickness then sets the thickness, E
/// unchanged. throws Error(ErrorCode::command): unknown preset; Error(ErrorCode::scene): one that
/// the scene names, or a weight and thickness of the scene that scale a value beyond its range
ResolvedPaper resolve_paper(const BakeSettings&, const SceneSheet&);

}  // namespace paperbake
