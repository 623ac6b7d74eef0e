#include "baker/check/inspect.h"

#include "baker/job/plan.h"
#include "baker/job/plan_warnings.h"
#include "core/animation/blocked_ways.h"
#include "formats/cache/alembic_reader.h"
#include "formats/files/certificate.h"
#include "formats/files/json.h"

#include <algorithm>
#include <array>
#include <cmath>
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
          {"angle_deg", crease.angle * 180 / M_PI},
          {"expected", crease.expected},
          {"from", crease.origin}};
}

std::vector<CreaseLine> creases_of(const SceneSheet& sheet, const Scene& scene) {
  return crease_lines(sheet, expected_creases(sheet, scene.first_frame));
}

std::vector<SheetImpossible> impossible_pairs(const Scene& scene) {
  std::vector<SheetImpossible> all;
  for (const SceneSheet& sheet : scene.sheets)
    for (ImpossiblePair& pair :
         all_impossible_pairs(sheet.pattern, sheet.handles, scene.first_frame, scene.last_frame))
      all.push_back({sheet.name, std::move(pair)});
  return all;
}

/// A collider of the scene as the bake will see it.
struct InspectedCollider {
  struct Beside {
    std::string sheet;
    bool holds;       // the sheet stays inside the collider
    double distance;  // [m] least in the first frame; negative: the sheet begins in the collider
  };
  const ColliderMesh* mesh;
  bool closed;
  const char* motion;
  Vector3d size;  // [m] of its box in the first frame
  std::vector<Beside> sheets;

  const Beside& nearest() const {
    return *std::min_element(sheets.begin(), sheets.end(), [](const Beside& a, const Beside& b) {
      return a.distance < b.distance;
    });
  }
};

/// Points spread evenly over the triangles of a sheet, its vertices among them. [m]
std::vector<Vector3d> samples_of(const Sheet& sheet) {
  constexpr double about = 1000;
  const int parts = std::max(
      1, static_cast<int>(std::sqrt(2 * about / std::max<double>(1, sheet.triangles.rows()))));
  std::vector<Vector3d> points;
  for (Eigen::Index t = 0; t < sheet.triangles.rows(); ++t) {
    const auto corner = [&](int k) { return Vector3d(sheet.x.row(sheet.triangles(t, k))); };
    for (int i = 0; i <= parts; ++i)
      for (int j = 0; i + j <= parts; ++j)
        points.push_back(corner(0) + (corner(1) - corner(0)) * i / parts +
                         (corner(2) - corner(0)) * j / parts);
  }
  return points;
}

/// What the collider does in the shot.
const char* motion_of(const ColliderMesh& mesh) {
  constexpr double same_length = 1e-6;  // [m]
  if (mesh.frames.empty()) return "stands still";
  for (const Points3& x : mesh.frames)
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t)
      for (int i = 0; i < 3; ++i) {
        const int a = mesh.triangles(t, i), b = mesh.triangles(t, (i + 1) % 3);
        if (std::abs((x.row(a) - x.row(b)).norm() - (mesh.x.row(a) - mesh.x.row(b)).norm()) >
            same_length)
          return "deforms";
      }
  return "moves";
}

InspectedCollider::Beside beside(const ColliderMesh& mesh, const SceneSheet& sheet) {
  constexpr double anywhere = 1e6;  // [m]
  std::vector<ColliderMesh> facing{mesh};
  face_the_sheet(facing, sheet.start.x, Points3(0, 3));
  const Collider collider(facing.front());
  InspectedCollider::Beside found{sheet.name,
                                  facing.front().paper_side == ColliderMesh::PaperSide::inside,
                                  std::numeric_limits<double>::infinity()};
  for (const Vector3d& p : samples_of(sheet.start)) {
    const double distance = collider.nearest(p, anywhere, 1).distance;
    // the front of an open mesh turns to the sheet
    found.distance = std::min(found.distance, collider.closed() ? distance : std::abs(distance));
  }
  return found;
}

std::vector<InspectedCollider> inspected_colliders(const Scene& scene) {
  std::vector<InspectedCollider> all;
  for (const ColliderMesh& mesh : scene.colliders) {
    InspectedCollider& found = all.emplace_back(
        InspectedCollider{&mesh,
                          Collider(mesh).closed(),
                          motion_of(mesh),
                          (mesh.x.colwise().maxCoeff() - mesh.x.colwise().minCoeff()).transpose(),
                          {}});
    for (const SceneSheet& sheet : scene.sheets) found.sheets.push_back(beside(mesh, sheet));
  }
  return all;
}

std::string collider_text(const InspectedCollider& c) {
  const Vector3d mm = 1e3 * c.size;
  std::string text = fmt::format(
      "collider \"{}\": {:.1f} x {:.1f} x {:.1f} mm, {} triangles, {}; {}; friction {:g}; in the "
      "first frame ",
      c.mesh->name, mm.x(), mm.y(), mm.z(), c.mesh->triangles.rows(),
      c.closed ? "closed" : "open, keeps the paper on the side where it begins", c.motion,
      c.mesh->friction);
  for (const InspectedCollider::Beside& b : c.sheets) {
    if (&b != &c.sheets.front()) text += ", ";
    text +=
        b.distance < 0
            ? fmt::format("the sheet \"{}\" reaches {:.2f} mm into it", b.sheet, -1e3 * b.distance)
            : fmt::format("the sheet \"{}\" is {:.2f} mm away", b.sheet, 1e3 * b.distance);
    if (c.closed) text += b.holds ? " and stays inside" : " and stays outside";
  }
  return text + "\n";
}

Json collider_json(const InspectedCollider& c) {
  Json sheets = Json::array();
  for (const InspectedCollider::Beside& b : c.sheets)
    sheets.push_back({{"sheet", b.sheet},
                      {"side", !c.closed ? "front"
                               : b.holds ? "inside"
                                         : "outside"},
                      {"distance_m", b.distance}});
  return {{"name", c.mesh->name},
          {"triangles", c.mesh->triangles.rows()},
          {"closed", c.closed},
          {"moves", !c.mesh->frames.empty()},
          {"motion", c.motion},
          {"friction", c.mesh->friction},
          {"size_m", {c.size.x(), c.size.y(), c.size.z()}},
          {"nearest_sheet", c.nearest().sheet},
          {"distance_m", c.nearest().distance},
          {"sheets", std::move(sheets)}};
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

Json scene_json(const Scene& scene) {
  Json sheets = Json::array(), impossible = Json::array();
  for (const SceneSheet& sheet : scene.sheets) sheets.push_back(sheet_json(sheet, scene));
  for (const SheetImpossible& i : impossible_pairs(scene))
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
  j["warnings"] = scene.warnings;
  return j;
}

std::string scene_text(const Scene& scene) {
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
  for (const SheetImpossible& i : impossible_pairs(scene))
    text += "impossible: " + describe(i) + "\n";
  for (const std::string& warning : scene.warnings) text += "warning: " + warning + "\n";
  return text;
}

/// Of one sheet of a cache, over its frames.
struct CacheSpread {
  // least, most
  std::array<Eigen::Index, 2> vertices{std::numeric_limits<Eigen::Index>::max(), 0},
      triangles = vertices;
  // [m]
  Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  // [m/s]
  double fastest = 0;
};

CacheSpread spread_of(const AlembicReader& cache, std::size_t sheet) {
  CacheSpread s;
  const auto widen = [](std::array<Eigen::Index, 2>& range, Eigen::Index n) {
    range = {std::min(range[0], n), std::max(range[1], n)};
  };
  for (std::size_t i = 0; i < cache.sheets()[sheet].frames; ++i) {
    const CacheFrame frame = cache.frame(sheet, i);
    widen(s.vertices, frame.x.rows());
    widen(s.triangles, frame.triangles.rows());
    if (frame.x.rows() == 0) continue;
    s.low = s.low.cwiseMin(frame.x.colwise().minCoeff().transpose());
    s.high = s.high.cwiseMax(frame.x.colwise().maxCoeff().transpose());
    if (frame.velocity.rows() > 0)
      s.fastest = std::max(s.fastest, frame.velocity.rowwise().norm().maxCoeff());
  }
  return s;
}

}  // namespace

std::string inspect_cache(const std::filesystem::path& path, bool json) {
  const AlembicReader cache(path);
  const CacheInfo& info = cache.info();
  const auto bytes = std::filesystem::file_size(path);
  std::string text = fmt::format("{}: {:.2f} MB, {} sheets at {} fps\n", path.filename().string(),
                                 1e-6 * bytes, cache.sheets().size(), info.fps);
  Json metadata = Json::object(), sheets = Json::array();
  for (const auto& [key, value] : info.metadata) {
    metadata[key] = value;
    text += fmt::format("  {} = {}\n", key, value);
  }
  for (std::size_t s = 0; s < cache.sheets().size(); ++s) {
    const AlembicReader::Sheet& sheet = cache.sheets()[s];
    const CacheSpread spread = spread_of(cache, s);
    const int last = info.first_frame + info.frame_step * (static_cast<int>(sheet.frames) - 1);
    std::vector<std::string> channels;
    for (const auto& [has, name] :
         {std::pair(sheet.velocity, "velocities"), std::pair(sheet.normal, "normals"),
          std::pair(sheet.uv, "uv"), std::pair(sheet.crease, "crease strength")})
      if (has) channels.push_back(name);
    Json j{{"name", sheet.name},
           {"frames", sheet.frames},
           {"first_frame", info.first_frame},
           {"last_frame", last},
           {"constant_topology", sheet.constant_topology},
           {"vertices", spread.vertices},
           {"triangles", spread.triangles},
           {"channels", channels}};
    text += fmt::format("sheet \"{}\": frames {}-{}{}, ", sheet.name, info.first_frame, last,
                        info.frame_step > 1 ? fmt::format(" by {}", info.frame_step) : "");
    text +=
        sheet.constant_topology
            ? fmt::format("one mesh of {} vertices, {} triangles", spread.vertices[1],
                          spread.triangles[1])
            : fmt::format("changing meshes of {}-{} vertices, {}-{} triangles", spread.vertices[0],
                          spread.vertices[1], spread.triangles[0], spread.triangles[1]);
    text += fmt::format("; {}\n", fmt::join(channels, ", "));
    if (spread.vertices[1] > 0) {
      const Vector3d size = 1e3 * (spread.high - spread.low);
      text += fmt::format("  moves within {:.1f} x {:.1f} x {:.1f} mm, at {:.3g} m/s at most\n",
                          size.x(), size.y(), size.z(), spread.fastest);
      j["low_m"] = {spread.low.x(), spread.low.y(), spread.low.z()};
      j["high_m"] = {spread.high.x(), spread.high.y(), spread.high.z()};
      j["fastest_m_per_s"] = spread.fastest;
    }
    sheets.push_back(std::move(j));
  }
  if (!json) return text;
  const Json all{{"file", path.filename().string()},
                 {"bytes", bytes},
                 {"fps", info.fps},
                 {"metadata", metadata},
                 {"sheets", sheets}};
  return json_lines(all) + "\n";
}

std::string inspect_job(const BakeSettings& settings, bool json) {
  const BakePlan plan = plan_bake(settings);
  const Scene scene = read_scene(settings.scene, settings.reading);
  if (!json) {
    std::string text = scene_text(scene) + "values:\n";
    for (const UsedValue& value : plan.used)
      text += fmt::format("  {} = {}  # {}\n", value.key, value.value, value.origin);
    return text;
  }
  Json j = scene_json(scene);
  for (const UsedValue& value : plan.used)
    j["values"].push_back({{"key", value.key}, {"value", value.value}, {"origin", value.origin}});
  return json_lines(j) + "\n";
}

std::string inspect_scene(const std::filesystem::path& path, const SceneOptions& options,
                          bool json) {
  const Scene scene = read_scene(path, options);
  return json ? json_lines(scene_json(scene)) + "\n" : scene_text(scene);
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
