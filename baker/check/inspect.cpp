#include "baker/check/inspect.h"

#include "baker/check/inspect_colliders.h"
#include "baker/job/plan.h"
#include "baker/job/plan_warnings.h"
#include "core/model/degrees.h"
#include "formats/files/certificate.h"
#include "formats/files/json.h"

#include <algorithm>
#include <fmt/format.h>
#include <limits>

namespace paperbake {
namespace {

const char* release_origin(const SceneSheet& sheet, const Handle& handle) {
  return sheet.scale_releases.count(handle.name) ? "keyed scale" : "paper_release_frame";
}

Json handle_json(const SceneSheet& sheet, const Handle& handle) {
  Json j{{"name", handle.name},
         {"u_m", handle.pattern.x()},
         {"v_m", handle.pattern.y()},
         {"mode", handle.mode == HandleMode::relative ? "relative" : "absolute"}};
  if (handle.grab_frame != std::numeric_limits<int>::min()) j["grab_frame"] = handle.grab_frame;
  if (handle.release_frame != std::numeric_limits<int>::max()) {
    j["release_frame"] = handle.release_frame;
    j["release_from"] = release_origin(sheet, handle);
  }
  if (handle.radius) j["radius_m"] = *handle.radius;
  if (handle.stiffness > 0) j["stiffness_N_per_m"] = handle.stiffness;
  return j;
}

Json crease_json(const CreaseLine& crease, std::size_t number) {
  Json line = Json::array();
  for (const Vector2d& p : crease.line) line.push_back({p.x(), p.y()});
  return {{"id", number},
          {"line_m", std::move(line)},
          {"angle_deg", degrees_of(crease.angle)},
          {"expected", crease.expected},
          {"from", crease.origin}};
}

std::vector<CreaseLine> creases_of(const SceneSheet& sheet, const Scene& scene) {
  return crease_lines(sheet, expected_creases(sheet, scene.first_frame));
}

/// [m/s] speed of the wind in each frame
Eigen::VectorXd speeds_of(const Wind& wind) { return wind.velocity.rowwise().norm(); }

Json wind_json(const Wind& wind) {
  const Eigen::RowVector3d first = wind.velocity.row(0);
  const Eigen::VectorXd speeds = speeds_of(wind);
  return {{"name", wind.name},
          {"first_velocity_m_per_s", {first.x(), first.y(), first.z()}},
          {"least_speed_m_per_s", speeds.minCoeff()},
          {"most_speed_m_per_s", speeds.maxCoeff()},
          {"gust", wind.gust},
          {"seed", wind.seed}};
}

std::string wind_text(const Wind& wind) {
  // rounded to the digits that are printed, so that nothing is -0
  const Eigen::RowVector3d first = (1e3 * wind.velocity.row(0)).array().round() / 1e3 + 0.0;
  const Eigen::VectorXd speeds = speeds_of(wind);
  std::string text =
      fmt::format("wind \"{}\": ({:.3f}, {:.3f}, {:.3f}) m/s in the first frame, speed {:.3g}",
                  wind.name, first.x(), first.y(), first.z(), speeds.minCoeff());
  if (speeds.maxCoeff() > speeds.minCoeff()) text += fmt::format(" to {:.3g}", speeds.maxCoeff());
  text += " m/s";
  if (wind.gust > 0) text += fmt::format("; gusts of {:g} % (seed {})", 100 * wind.gust, wind.seed);
  return text + "\n";
}

Json sheet_json(const SceneSheet& sheet, const Scene& scene) {
  Json creases = Json::array(), handles = Json::array();
  for (const CreaseLine& crease : creases_of(sheet, scene))
    creases.push_back(crease_json(crease, creases.size() + 1));
  for (const Handle& handle : sheet.handles) handles.push_back(handle_json(sheet, handle));
  Json j{{"name", sheet.name},
         {"width_m", extent(sheet.pattern).x()},
         {"height_m", extent(sheet.pattern).y()},
         {"outline_corners", sheet.pattern.outline.size()},
         {"holes", sheet.pattern.holes.size()},
         {"vertices", sheet.start.x.rows()},
         {"triangles", sheet.start.triangles.rows()}};
  if (sheet.preset) j["paper_preset"] = *sheet.preset;
  if (sheet.grammage) j["paper_gsm"] = *sheet.grammage;
  if (sheet.thickness) j["paper_thickness"] = *sheet.thickness;
  if (sheet.friction) j["paper_friction"] = *sheet.friction;
  if (sheet.seed) j["paper_seed"] = *sheet.seed;
  j["creases"] = std::move(creases);
  j["handles"] = std::move(handles);
  return j;
}

/// plan  of a bake of the scene
Json scene_json(const Scene& scene, const BakePlan& plan) {
  Json sheets = Json::array(), impossible = Json::array();
  for (const SceneSheet& sheet : scene.sheets) sheets.push_back(sheet_json(sheet, scene));
  for (const UnreachablePairOfSheet& i : plan.impossible)
    impossible.push_back({{"sheet", i.sheet},
                          {"handles", {i.pair.a, i.pair.b}},
                          {"frame", i.pair.frame},
                          {"overshoot_mm", 1e3 * (i.pair.apart - i.pair.allowed)},
                          {"around", i.pair.around.empty() ? Json() : Json(i.pair.around)},
                          {"text", describe(i)}});
  Json j{{"file", scene.source},
         {"fps", scene.fps},
         {"first_frame", scene.first_frame},
         {"last_frame", scene.last_frame}};
  if (scene.gravity) j["gravity"] = *scene.gravity;
  j["origin"] = scene.origin;
  j["sheets"] = std::move(sheets);
  j["colliders"] = Json::array();
  for (const InspectedCollider& collider : inspected_colliders(scene))
    j["colliders"].push_back(collider_json(collider));
  j["winds"] = Json::array();
  for (const Wind& wind : scene.winds) j["winds"].push_back(wind_json(wind));
  j["impossible_handles"] = std::move(impossible);
  j["warnings"] = plan.warnings;
  return j;
}

std::string scene_text(const Scene& scene, const BakePlan& plan) {
  std::string text = fmt::format("{}: frames {}-{} at {} fps\n", scene.source, scene.first_frame,
                                 scene.last_frame, scene.fps);
  for (const auto& [key, origin] : scene.origin)
    text += fmt::format("  {:<12} from {}\n", key, origin);
  for (const SceneSheet& sheet : scene.sheets) {
    text += fmt::format(
        "sheet \"{}\": {:.2f} x {:.2f} mm, {} corners, {} holes; mesh of {} vertices, {} "
        "triangles\n",
        sheet.name, 1e3 * extent(sheet.pattern).x(), 1e3 * extent(sheet.pattern).y(),
        sheet.pattern.outline.size(), sheet.pattern.holes.size(), sheet.start.x.rows(),
        sheet.start.triangles.rows());
    std::size_t number = 0;
    for (const CreaseLine& crease : creases_of(sheet, scene))
      text += "  " + describe(crease, ++number) + "\n";
    for (const Handle& h : sheet.handles) {
      text += fmt::format("  handle \"{}\" at ({:.2f}, {:.2f}) mm, {}", h.name, 1e3 * h.pattern.x(),
                          1e3 * h.pattern.y(),
                          h.mode == HandleMode::relative ? "relative" : "absolute");
      if (h.grab_frame != std::numeric_limits<int>::min())
        text += fmt::format(", from frame {}", h.grab_frame);
      if (h.release_frame != std::numeric_limits<int>::max())
        text += fmt::format(", until frame {} ({})", h.release_frame, release_origin(sheet, h));
      text += '\n';
    }
  }
  for (const InspectedCollider& collider : inspected_colliders(scene))
    text += collider_text(collider);
  for (const Wind& wind : scene.winds) text += wind_text(wind);
  for (const UnreachablePairOfSheet& i : plan.impossible)
    text += "impossible: " + describe(i) + "\n";
  for (const std::string& warning : plan.warnings) text += "warning: " + warning + "\n";
  return text;
}

}  // namespace

std::string inspect_job(const BakeSettings& settings, bool json) {
  const Scene scene = read_scene(settings.scene, settings.reading);
  const BakePlan plan = plan_bake(settings, scene);
  if (!json) {
    std::string text = scene_text(scene, plan) + "values:\n";
    for (const UsedValue& value : plan.used)
      text += fmt::format("  {} = {}  # {}\n", value.key, value.value, value.origin);
    return text;
  }
  Json j = scene_json(scene, plan);
  for (const UsedValue& value : plan.used)
    j["values"].push_back({{"key", value.key}, {"value", value.value}, {"origin", value.origin}});
  return json_lines(j) + "\n";
}

std::string inspect_scene(const std::filesystem::path& path, const SceneOptions& options,
                          bool json) {
  const Scene scene = read_scene(path, options);
  BakeSettings settings;
  settings.scene = path;
  settings.reading = options;
  const BakePlan plan = plan_bake(settings, scene);
  return json ? json_lines(scene_json(scene, plan)) + "\n" : scene_text(scene, plan);
}

std::string tracks_csv(const std::filesystem::path& path, const SceneOptions& options) {
  const Tracks tracks = read_tracks(path, options);
  std::string text = "frame,node,x,y,z\n";
  const long frames = tracks.positions.empty() ? 0 : tracks.positions.front().rows();
  for (long f = 0; f < frames; ++f)
    for (std::size_t n = 0; n < tracks.names.size(); ++n) {
      const auto p = tracks.positions[n].row(f);
      text += fmt::format("{},{},{:.9g},{:.9g},{:.9g}\n", tracks.first_frame + f,
                          csv_field(tracks.names[n]), p.x(), p.y(), p.z());
    }
  return text;
}

}  // namespace paperbake
