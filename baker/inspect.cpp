#include "baker/inspect.h"

#include "baker/plan.h"
#include "core/reach.h"
#include "formats/certificate.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace paperbake {
namespace {

using Json = nlohmann::ordered_json;

Json handle_json(const Handle& handle) {
  Json j{{"name", handle.name}, {"u_m", handle.pattern.x()}, {"v_m", handle.pattern.y()},
         {"mode", handle.mode == HandleMode::relative ? "relative" : "absolute"}};
  if (handle.grab_frame != std::numeric_limits<int>::min()) j["grab_frame"] = handle.grab_frame;
  if (handle.release_frame != std::numeric_limits<int>::max()) j["release_frame"] = handle.release_frame;
  if (handle.radius) j["radius_m"] = *handle.radius;
  if (handle.stiffness > 0) j["stiffness_N_per_m"] = handle.stiffness;
  return j;
}

std::vector<SheetImpossible> impossible_pairs(const Scene& scene) {
  std::vector<SheetImpossible> all;
  for (const SceneSheet& sheet : scene.sheets)
    for (ImpossiblePair& pair : Reach(sheet.pattern, sheet.handles).impossible_pairs(sheet.handles, scene.first_frame, scene.last_frame))
      all.push_back({sheet.name, std::move(pair)});
  return all;
}

Json scene_json(const Scene& scene) {
  Json sheets = Json::array(), impossible = Json::array();
  for (const SceneSheet& sheet : scene.sheets) {
    Json handles = Json::array();
    for (const Handle& handle : sheet.handles) handles.push_back(handle_json(handle));
    Json j{{"name", sheet.name}, {"width_m", extent(sheet.pattern).x()}, {"height_m", extent(sheet.pattern).y()},
           {"outline_corners", sheet.pattern.outline.size()}, {"holes", sheet.pattern.holes.size()},
           {"vertices", sheet.start.x.rows()}, {"triangles", sheet.start.triangles.rows()}};
    if (sheet.preset) j["paper_preset"] = *sheet.preset;
    if (sheet.grammage) j["paper_gsm"] = *sheet.grammage;
    if (sheet.thickness) j["paper_thickness"] = *sheet.thickness;
    if (sheet.seed) j["paper_seed"] = *sheet.seed;
    j["handles"] = std::move(handles);
    sheets.push_back(std::move(j));
  }
  for (const SheetImpossible& i : impossible_pairs(scene))
    impossible.push_back({{"sheet", i.sheet}, {"handles", {i.pair.a, i.pair.b}}, {"frame", i.pair.frame},
                          {"overshoot_mm", 1e3 * (i.pair.apart - i.pair.allowed)}, {"text", describe(i)}});
  Json j{{"file", scene.source}, {"fps", scene.fps}, {"first_frame", scene.first_frame}, {"last_frame", scene.last_frame}};
  if (scene.gravity) j["gravity"] = *scene.gravity;
  j["origin"] = scene.origin;
  j["sheets"] = std::move(sheets);
  j["impossible_handles"] = std::move(impossible);
  j["warnings"] = scene.warnings;
  return j;
}

std::string scene_text(const Scene& scene) {
  std::string text = fmt::format("{}: frames {}-{} at {} fps\n", scene.source, scene.first_frame, scene.last_frame, scene.fps);
  for (const auto& [key, origin] : scene.origin) text += fmt::format("  {:<12} from {}\n", key, origin);
  for (const SceneSheet& sheet : scene.sheets) {
    text += fmt::format("sheet \"{}\": {:.2f} x {:.2f} mm, {} corners, {} holes; mesh of {} vertices, {} triangles\n", sheet.name,
                        1e3 * extent(sheet.pattern).x(), 1e3 * extent(sheet.pattern).y(), sheet.pattern.outline.size(),
                        sheet.pattern.holes.size(), sheet.start.x.rows(), sheet.start.triangles.rows());
    for (const Handle& h : sheet.handles) {
      text += fmt::format("  handle \"{}\" at ({:.2f}, {:.2f}) mm, {}", h.name, 1e3 * h.pattern.x(), 1e3 * h.pattern.y(),
                          h.mode == HandleMode::relative ? "relative" : "absolute");
      if (h.grab_frame != std::numeric_limits<int>::min()) text += fmt::format(", from frame {}", h.grab_frame);
      if (h.release_frame != std::numeric_limits<int>::max()) text += fmt::format(", until frame {}", h.release_frame);
      text += '\n';
    }
  }
  for (const SheetImpossible& i : impossible_pairs(scene)) text += "impossible: " + describe(i) + "\n";
  for (const std::string& warning : scene.warnings) text += "warning: " + warning + "\n";
  return text;
}

}  // namespace

std::string inspect_scene(const std::filesystem::path& path, const SceneOptions& options, bool json) {
  const Scene scene = read_scene(path, options);
  return json ? scene_json(scene).dump(1, ' ', false, Json::error_handler_t::replace) + "\n" : scene_text(scene);
}

std::string tracks_csv(const std::filesystem::path& path, const SceneOptions& options) {
  const Tracks tracks = read_tracks(path, options);
  std::string text = "frame,node,x,y,z\n";
  const long frames = tracks.positions.empty() ? 0 : tracks.positions.front().rows();
  for (long f = 0; f < frames; ++f)
    for (std::size_t n = 0; n < tracks.names.size(); ++n) {
      const auto p = tracks.positions[n].row(f);
      text += fmt::format("{},{},{:.9g},{:.9g},{:.9g}\n", tracks.first_frame + f, csv_field(tracks.names[n]), p.x(), p.y(), p.z());
    }
  return text;
}

}  // namespace paperbake
