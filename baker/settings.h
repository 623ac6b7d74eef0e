#pragma once

#include "core/paper.h"
#include "core/render_sheet.h"
#include "core/step1_elastic/elastic.h"
#include "formats/map_info.h"
#include "formats/scene_file.h"

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace paperbake {

/// Frames a, a + step, ... not beyond b.
struct FrameSpan {
  int first = 1, last = 1, step = 1;
  bool contains(int frame) const { return frame >= first && frame <= last && (frame - first) % step == 0; }
};
/// "A-B", "A-BxN" or "A". throws Error(Fault::command) naming `option`
FrameSpan parse_frames(const std::string& text, const std::string& option);
/// Spans separated by commas. throws as above
std::vector<FrameSpan> parse_frame_list(const std::string& text, const std::string& option);

enum class CacheMesh { render, simulation };
enum class Dynamics { automatic, off, on };

/// What the command line says about a bake. An empty option leaves the choice to scene, preset or default.
struct BakeSettings {
  std::filesystem::path scene, output;
  SceneOptions reading;
  std::optional<std::string> preset;                     // grade or file
  std::vector<std::pair<std::string, std::string>> set;  // --set key=value, in order
  std::string method = "hybrid";
  std::optional<unsigned> seed;
  std::optional<int> triangles;                          // fem: its mesh (1,700); hybrid: its cap (250)
  int base_triangles = 120;                              // of the hybrid
  std::optional<int> polish;                             // triangles of the fem that finishes every frame; 0: none
  std::optional<double> gravity;                         // [m/s2]
  double stop = 1e-5;                                    // [m]
  Dynamics dynamics = Dynamics::automatic;
  int probe_every = 0;                                   // [frames] 0: never
  std::optional<FrameSpan> frames;
  CacheMesh mesh = CacheMesh::render;                    // one for the whole shot, or as it is simulated
  Quality quality = Quality::shot;                       // of the render mesh
  std::set<std::string> formats{"abc", "maps", "cert", "report"};
  int map_size = 1024;                                   // [texels]
  MapLayout map_layout = MapLayout::scanline;
  std::optional<std::vector<FrameSpan>> map_frames;      // none: every 12th
  std::optional<std::filesystem::path> debug_pictures;   // folder
  double max_stretch_pct = 5;
  bool strict = false;
  int threads = 2;
};

/// One value as it was used and who said so: default, preset, scene or command line.
struct UsedValue {
  std::string key;     // table.key, as in job.lock.toml
  std::string value;   // TOML literal
  std::string origin;
};

/// The paper of one sheet and where each number came from.
struct ResolvedPaper {
  Paper paper;
  std::vector<UsedValue> used;
};

/// default < preset < scene < --set. A preset named on the command line replaces what the scene says of the paper.
/// A scene's paper_gsm scales the nearest grade: thickness and E h with the grammage, D with its cube; paper_thickness
/// then sets the thickness, E unchanged.
/// throws Error(Fault::command): unknown preset, unknown or bad --set key
ResolvedPaper resolve_paper(const BakeSettings&, const SceneSheet&);

/// TOML literals.
std::string toml_number(double);
std::string toml_string(const std::string&);

}  // namespace paperbake
