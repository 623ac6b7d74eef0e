#include "formats/scene/scene_file.h"

#include "core/model/error.h"
#include "core/model/paper.h"
#include "formats/scene/scene_colliders.h"
#include "formats/scene/scene_creases.h"
#include "formats/scene/scene_handles.h"
#include "formats/scene/scene_nodes.h"
#include "formats/scene/scene_properties.h"
#include "formats/scene/scene_sheet.h"
#include "formats/scene/scene_winds.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>
#include <sstream>

namespace paperbake {
namespace {

// [m] limits of the longer side, beyond which the unit of the file must be wrong
constexpr double max_sheet_side = 5, min_sheet_side = 0.005;
constexpr double size_agreement = 0.01;  // relative tolerance of paper_size

std::string metres(const Vector2d& size) {
  return fmt::format("{:.4g} x {:.4g} m", size.x(), size.y());
}

/// The size in paper_size, with the two sides exchanged where that fits the measured size better;
/// nothing without that property.
std::optional<Vector2d> stated_size(const ImportedNode& node, const Vector2d& measured) {
  const auto list = list_property(node, "paper_size");
  if (list.size() < 2 || !(list[0] > 0) || !(list[1] > 0)) return std::nullopt;
  const Vector2d stated(list[0], list[1]), turned(list[1], list[0]);
  const auto off = [&](const Vector2d& size) {
    return (measured.cwiseQuotient(size).array().log()).matrix().squaredNorm();
  };
  return off(turned) < off(stated) ? turned : stated;
}

/// The power of ten by which the sheet should be scaled: to the size in paper_size, else to a
/// plausible one.
double likely_factor(double longer, const std::optional<Vector2d>& stated) {
  if (stated) return std::pow(10, std::round(std::log10(stated->maxCoeff() / longer)));
  // centimetres and millimetres first
  for (double factor : {0.01, 100.0, 0.001, 1000.0, 0.1, 10.0})
    if (0.05 <= longer * factor && longer * factor <= 2) return factor;
  return std::pow(10, std::round(std::log10(0.2 / longer)));
}

/// "The file is probably in centimetres: bake with --unit-scale 0.01, ..."
std::string unit_remedy(const SceneNodes& scene, double factor) {
  const double unit = scene.unit * factor;
  const auto is = [&](double known) { return std::abs(unit / known - 1) < 1e-6; };
  const std::string guess = is(0.01)    ? "The file is probably in centimetres"
                            : is(0.001) ? "The file is probably in millimetres"
                            : is(1)     ? "The file is probably in metres"
                                        : "The unit of the file is probably wrong";
  return fmt::format("{}: bake with --unit-scale {:.6g}, or export {:.6g} times as large.", guess,
                     unit, factor);
}

void check_size(const SceneNodes& scene, const ImportedNode& node, const Vector2d& size,
                const SceneOptions& options) {
  const std::string place = place_of(scene.source, "sheet", node.name);
  const double longer = size.maxCoeff();
  const auto stated = stated_size(node, size);
  if (!options.unit_scale && (longer > max_sheet_side || longer < min_sheet_side))
    throw Error(ErrorCode::scene, place,
                fmt::format("The sheet is {}; a sheet's longer side is between 5 mm and 5 m.",
                            metres(size)),
                unit_remedy(scene, likely_factor(longer, stated)));
  if (!stated || (size.cwiseQuotient(*stated).array() - 1).abs().maxCoeff() <= size_agreement)
    return;
  const double ratio = std::log10(stated->maxCoeff() / longer), power = std::round(ratio);
  const bool wrong_unit = power != 0 && std::abs(ratio - power) < size_agreement;
  throw Error(ErrorCode::scene, place,
              fmt::format("The sheet is {}, but its property paper_size says {}.", metres(size),
                          metres(*stated)),
              wrong_unit ? unit_remedy(scene, std::pow(10, power))
                         : "Correct paper_size or the mesh; they must agree within 1 %.");
}

/// Caches hold positions as numbers of 32 bits, whose distance grows with the distance from the
/// origin. Warns where it is more than a fortieth of the shortest edges of a render mesh.
void warn_of_distance(const std::string& name, const Points3& x,
                      std::vector<std::string>& warnings) {
  constexpr double coarse = 1e-6;  // [m]
  const auto farthest = static_cast<float>(x.cwiseAbs().maxCoeff());
  const double step = std::nextafter(farthest, 2 * farthest) - farthest;
  if (!(step > coarse)) return;
  warnings.push_back(
      fmt::format("The sheet \"{}\" is {:.0f} m away from the origin. Positions in a cache are "
                  "numbers of 32 bits, which are {:.2g} mm apart there: creases and close layers "
                  "become rough. Bake the shot within 16 m of the origin, and move the cache back "
                  "in the scene.",
                  name, x.rowwise().norm().maxCoeff(), 1e3 * step));
}

/// Creases of a job file with the points that nearly lie on the border moved onto it: the sheet may
/// be 0.1000001 m wide where the job says 0.1.
std::vector<PrescribedCrease> with_ends_on_border(std::vector<PrescribedCrease> creases,
                                                  const Pattern& pattern) {
  constexpr double near = 1e-4;  // of the longer side
  for (PrescribedCrease& crease : creases)
    for (Vector2d& p : crease.line)
      if (const Vector2d border = nearest_border_point(pattern, p);
          (border - p).norm() <= near * longer_side(pattern))
        p = border;
  return creases;
}

/// Leads a crease through the handles and singular points that it would pass at less than
/// `tolerance` [m]: a mesh with both would have slivers between them.
PrescribedCrease snapped_to_points(const PrescribedCrease& crease,
                                   const std::vector<Vector2d>& points, double tolerance) {
  PrescribedCrease snapped{{}, crease.angle};
  for (std::size_t k = 0; k + 1 < crease.line.size(); ++k) {
    const Vector2d from = crease.line[k], along = crease.line[k + 1] - from;
    std::vector<std::pair<double, Vector2d>> passed{{0, from}};
    for (const Vector2d& p : points) {
      const double t = std::clamp((p - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
      if ((from + t * along - p).norm() < tolerance) passed.emplace_back(t, p);
    }
    std::stable_sort(passed.begin(), passed.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [t, p] : passed) {
      // a point at the end of a segment replaces that end
      if (!snapped.line.empty() && (p - snapped.line.back()).norm() < tolerance)
        snapped.line.back() = p;
      else
        snapped.line.push_back(p);
    }
  }
  if (const Vector2d end = crease.line.back(); (end - snapped.line.back()).norm() >= tolerance)
    snapped.line.push_back(end);
  return snapped;
}

void snap_creases_to_points(SceneSheet& sheet) {
  std::vector<Vector2d> points = sheet.singular_point_rules.fixed;
  for (const Handle& handle : sheet.handles) points.push_back(handle.pattern);
  for (PrescribedCrease& crease : sheet.pattern.prescribed_creases)
    crease = snapped_to_points(crease, points, 2e-3 * longer_side(sheet.pattern));
}

/// Checks that singular points and creases of a job file lie on the sheet.
/// throws Error(ErrorCode::command)
void check_rules(const SingularPointRules& rules, const Pattern& pattern, const std::string& place,
                 const std::string& name) {
  constexpr int samples = 64;  // of each segment of a crease
  const double rounding = 1e-6 * longer_side(pattern);
  const auto check = [&](const char* key, const Vector2d& p) {
    if (contains(pattern, p, rounding)) return;
    throw Error(ErrorCode::command, place,
                fmt::format("The {} at ({:g}, {:g}) m is not on the sheet \"{}\".", key, p.x(),
                            p.y(), name),
                fmt::format("Its pattern is {}, from (0, 0).", metres(extent(pattern))));
  };
  for (const Vector2d& p : rules.fixed) check("singular_keep", p);
  for (const PrescribedCrease& crease : pattern.prescribed_creases)
    for (std::size_t k = 0; k + 1 < crease.line.size(); ++k) {
      if ((crease.line[k + 1] - crease.line[k]).norm() < 1e-3 * longer_side(pattern))
        throw Error(
            ErrorCode::command, place,
            fmt::format(
                "A segment of a crease of the sheet \"{}\" is shorter than 0.1 % of the sheet.",
                name),
            "Leave out one of its points.");
      for (int i = 0; i <= samples; ++i)
        check("crease",
              crease.line[k] + i / double(samples) * (crease.line[k + 1] - crease.line[k]));
    }
}

/// glTF has no names for uv sets: paper_uv_sets of the sheet may have them, one a line.
void name_uv_sets(const std::optional<std::string>& names, AuthoredSurface& authored) {
  std::istringstream lines(names.value_or(""));
  for (AuthoredSurface::UvSet& set : authored.uv_sets)
    if (std::string name; std::getline(lines, name) && !name.empty()) set.name = name;
  std::set<std::string> taken{"pattern", "crease"};  // that caches have besides
  for (AuthoredSurface::UvSet& set : authored.uv_sets) {
    const std::string given = set.name;
    for (int n = 2; !taken.insert(set.name).second; ++n) set.name = fmt::format("{}_{}", given, n);
  }
}

SceneSheet read_sheet(const SceneNodes& scene, int index, const Eigen::Affine3d& world,
                      const SceneOptions& options, const AppliedOverrides& overrides,
                      std::vector<std::string>& warnings) {
  const ImportedNode& node = scene.file.nodes[index];
  const std::string place = place_of(scene.source, "sheet", node.name);
  FlatSheet flat = flat_sheet(scene.file, index, world, place);
  SceneSheet sheet;
  sheet.name = node.name;
  sheet.pattern = std::move(flat.pattern);
  sheet.start = std::move(flat.start);
  sheet.authored = std::move(flat.authored);
  for (const auto& [key, value] : node.properties)
    if (key.rfind("paper_", 0) != 0) sheet.authored.properties.emplace(key, value);
  name_uv_sets(text_property(node, "paper_uv_sets"), sheet.authored);
  check_size(scene, node, extent(sheet.pattern), options);
  warn_of_distance(sheet.name, sheet.start.x, warnings);
  sheet.preset = text_property(node, "paper_preset");
  sheet.grammage = positive_property(scene.source, node, "paper_gsm");
  sheet.thickness = positive_property(scene.source, node, "paper_thickness");
  sheet.friction = nonnegative_property(scene.source, node, "paper_friction");
  if (sheet.friction && *sheet.friction > max_friction)
    throw Error(ErrorCode::scene, place, fmt::format("paper_friction is {}.", *sheet.friction),
                fmt::format("It must be a number from 0 to {}; paper on paper has about 0.4.",
                            max_friction));
  if (const auto seed = whole_property(scene.source, node, "paper_seed")) {
    if (*seed < 0)
      throw Error(ErrorCode::scene, place, fmt::format("paper_seed is {}.", *seed),
                  "It must be a whole number of at least 0.");
    sheet.seed = static_cast<unsigned>(*seed);
  }
  for (const char* key : {"preset", "gsm", "thickness", "friction", "seed"})
    if (overrides.places.count(std::string("paper_") + key)) sheet.overridden.insert(key);
  sheet.singular_point_rules = overrides.singular_point_rules;
  sheet.pattern.prescribed_creases = with_ends_on_border(overrides.creases, sheet.pattern);
  check_rules(sheet.singular_point_rules, sheet.pattern, overrides.rules_place, node.name);
  sheet.crease_origin.assign(sheet.pattern.prescribed_creases.size(), "job");
  for (int m : node.meshes)
    if (scene.file.meshes[m].deformed) {
      warnings.push_back(fmt::format(
          "Bones and blend shapes of the sheet \"{}\" are not followed: it starts undeformed.",
          node.name));
      break;
    }
  return sheet;
}

[[noreturn]] void reject_without_sheet(const SceneNodes& scene) {
  std::vector<std::string> meshes;
  for (const ImportedNode& node : scene.file.nodes)
    if (!node.meshes.empty() && meshes.size() < 8) meshes.push_back('"' + node.name + '"');
  throw Error(ErrorCode::scene, scene.source,
              "The scene has no sheet: no mesh whose name starts with \"paper\".",
              meshes.empty() ? "It has no mesh at all: was the sheet exported?"
                             : fmt::format("Rename the mesh that is the sheet; the meshes are {}.",
                                           fmt::join(meshes, ", ")));
}

bool is_named_sheet(const ImportedNode& node) {
  return !node.meshes.empty() && name_begins_with(node.name, "paper") &&
         !flag_property(node, "paper_ignore");
}

/// Whether the name goes on as a word, such as "Paperclip".
bool is_longer_word(const std::string& name) {
  const std::string matched = matched_name(name);
  return matched.size() > 5 && std::isalpha(static_cast<unsigned char>(matched[5]));
}

/// The error of a mesh that is taken for a sheet because of its name.
Error taken_for_sheet(const Error& error) {
  return Error(error.code, error.place, error.cause,
               error.remedy +
                   " Or, if it is no sheet: it is taken for one because its name begins "
                   "with \"paper\"; rename it, or give it the property paper_ignore.");
}

std::vector<SceneSheet> read_sheets(const SceneNodes& scene, const SceneOptions& options,
                                    const std::vector<AppliedOverrides>& overrides,
                                    std::vector<std::string>& warnings) {
  const auto world = world_at(scene, scene.first_frame);
  std::vector<SceneSheet> sheets;
  std::optional<Error> no_sheet;
  std::set<std::string> names;
  for (int i = 0; i < static_cast<int>(scene.file.nodes.size()); ++i) {
    const ImportedNode& node = scene.file.nodes[i];
    if (!is_named_sheet(node)) continue;
    if (!names.insert(node.name).second)
      throw Error(ErrorCode::scene, place_of(scene.source, "sheet", node.name),
                  "Two sheets have this name.",
                  "Give every sheet a name of its own and export again.");
    try {
      sheets.push_back(read_sheet(scene, i, world[i], options, overrides[i], warnings));
    } catch (const Error& error) {
      if (!is_longer_word(node.name)) throw;
      if (!no_sheet) no_sheet = taken_for_sheet(error);
      warnings.push_back(
          fmt::format("\"{}\" is ignored, although its name begins with \"paper\". {}", node.name,
                      error.cause));
    }
  }
  if (sheets.empty() && no_sheet) throw *no_sheet;
  if (sheets.empty()) reject_without_sheet(scene);
  return sheets;
}

/// Keys of a sheet itself are ignored: only handles move it.
void warn_of_keyed_sheets(const SceneNodes& scene, std::vector<std::string>& warnings) {
  constexpr int looks = 16;  // frames that are compared with the first
  const auto first = world_at(scene, scene.first_frame);
  std::set<int> moved;
  for (int look = 1; look <= looks; ++look) {
    const auto world =
        world_at(scene, scene.first_frame + (scene.last_frame - scene.first_frame) * look / looks);
    for (int i = 0; i < static_cast<int>(world.size()); ++i)
      if (is_named_sheet(scene.file.nodes[i]) && !world[i].isApprox(first[i], 1e-5))
        moved.insert(i);
  }
  for (const int i : moved)
    warnings.push_back(
        fmt::format("The sheet \"{}\" is keyed or moves with its parent: it starts where it is at "
                    "frame {}, then only handles move it.",
                    scene.file.nodes[i].name, scene.first_frame));
}

/// The number that is given to any object for the whole scene.
std::optional<double> number_of_scene(const SceneNodes& scene, const std::string& what,
                                      std::map<std::string, std::string>& origin) {
  for (const ImportedNode& node : scene.file.nodes)
    if (const auto number = number_property(scene.source, node, "paper_" + what)) {
      origin[what] = fmt::format("paper_{} of \"{}\"", what, node.name);
      return number;
    }
  return std::nullopt;
}

}  // namespace

Scene scene_of(ImportedFile file, std::string source, const SceneOptions& options) {
  const std::vector<AppliedOverrides> overrides = apply_overrides(file, options.overrides);
  const SceneNodes nodes = scene_nodes(std::move(file), std::move(source), options);
  Scene scene;
  scene.source = nodes.source;
  scene.fps = nodes.fps;
  scene.first_frame = nodes.first_frame;
  scene.last_frame = nodes.last_frame;
  scene.origin = nodes.origin;
  scene.warnings = nodes.warnings;
  for (std::string& warning : unknown_properties(nodes.file.nodes))
    scene.warnings.push_back(std::move(warning));
  scene.sheets = read_sheets(nodes, options, overrides, scene.warnings);
  warn_of_keyed_sheets(nodes, scene.warnings);
  add_creases(nodes, scene.sheets, scene.warnings);
  add_handles(nodes, scene.sheets, scene.warnings);
  for (SceneSheet& sheet : scene.sheets) snap_creases_to_points(sheet);
  scene.colliders = read_colliders(nodes, scene.warnings);
  scene.gravity = number_of_scene(nodes, "gravity", scene.origin);
  scene.air = number_of_scene(nodes, "air", scene.origin);
  if (scene.air && *scene.air < 0)
    throw Error(ErrorCode::scene, scene.source, fmt::format("paper_air is {}.", *scene.air),
                "It is the density of the air in kg/m3: 1.2, or 0 for none.");
  scene.winds = read_winds(nodes);
  for (std::size_t i = 0; i < overrides.size(); ++i)
    for (const auto& [key, place] : overrides[i].places) {
      const ImportedNode& node = nodes.file.nodes[i];
      scene.origin[fmt::format("{} of \"{}\"", key, node.name)] = place;
      if (node.meshes.empty())
        scene.given.push_back(
            {node.name, key.substr(std::string("paper_").size()), node.properties.at(key)});
    }
  return scene;
}

Scene read_scene(const std::filesystem::path& path, const SceneOptions& options) {
  return scene_of(import_file(path, options.fps, options.parts), path.filename().string(), options);
}

Tracks read_tracks(const std::filesystem::path& path, const SceneOptions& options) {
  const SceneNodes scene =
      scene_nodes(import_file(path, options.fps, options.parts), path.filename().string(), options);
  const int frames = scene.last_clip_frame - scene.first_clip_frame + 1;
  Tracks tracks;
  tracks.first_frame = scene.first_clip_frame;
  std::vector<int> listed;
  for (int i = 0; i < static_cast<int>(scene.file.nodes.size()); ++i) {
    if (scene.file.nodes[i].pivot) continue;
    listed.push_back(i);
    tracks.names.push_back(scene.file.nodes[i].name);
    tracks.positions.emplace_back(frames, 3);
  }
  for (int f = 0; f < frames; ++f) {
    const auto world = world_at(scene, scene.first_clip_frame + f);
    for (std::size_t i = 0; i < listed.size(); ++i)
      tracks.positions[i].row(f) = origin_of(scene, world, listed[i]);
  }
  return tracks;
}

}  // namespace paperbake
