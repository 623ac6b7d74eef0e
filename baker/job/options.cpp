#include "baker/job/options.h"

#include "baker/job/method_choice.h"
#include "core/model/error.h"

#include <algorithm>
#include <fmt/format.h>
#include <regex>
#include <set>
#include <utility>

namespace paperbake {
namespace {

using Apply = std::function<void(BakeSettings&, const std::string& text, const std::string& place)>;

/// Sets a field, which may be optional, to a number. place: returns the field
template <class Place>
Apply to_number(Place place) {
  return [place](BakeSettings& s, const std::string& text, const std::string&) {
    place(s) = std::stod(text);
  };
}

template <class Field>
Apply to_whole(Field BakeSettings::*field) {
  return [field](BakeSettings& s, const std::string& text, const std::string&) {
    s.*field = static_cast<int>(std::stoll(text));
  };
}

Option with_default(JobKey key, std::string default_value, std::string help, Apply apply) {
  return {std::move(key), "", std::move(help), std::move(default_value), "", std::move(apply)};
}

/// An option whose value depends on scene, preset or method unless it is given.
Option without_default(JobKey key, std::string example, std::string help, Apply apply) {
  return {std::move(key), "", std::move(help), "", std::move(example), std::move(apply)};
}

/// An option that is one of several words.
template <class Value>
Option word(std::string name, Value BakeSettings::*field,
            const std::vector<std::pair<std::string, Value>>& values, std::string default_value,
            std::string help) {
  JobKey key{std::move(name), JobKey::word};
  for (const auto& [text, value] : values) key.words.push_back(text);
  return with_default(
      std::move(key), std::move(default_value), std::move(help),
      [field, values](BakeSettings& s, const std::string& text, const std::string&) {
        s.*field = std::find_if(values.begin(), values.end(), [&](const auto& v) {
                     return v.first == text;
                   })->second;
      });
}

std::vector<std::string> format_names() {
  std::vector<std::string> names;
  for (const OutputFormat& format : output_formats()) names.push_back(format.name);
  return names;
}

std::set<std::string> parse_formats(const std::string& text, const std::string& place) {
  const std::vector<std::string> known = format_names();
  std::set<std::string> formats;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t comma = std::min(text.find(',', from), text.size());
    const std::string name = text.substr(from, comma - from);
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw Error(ErrorCode::command, place, fmt::format("Unknown format \"{}\".", name),
                  fmt::format("This version writes: {}.", fmt::join(known, ", ")));
    formats.insert(name);
    from = comma + 1;
  }
  return formats;
}

Option formats_option() {
  std::vector<std::string> defaults, described;
  for (const OutputFormat& format : output_formats()) {
    if (format.is_default) defaults.push_back(format.name);
    described.push_back(fmt::format("{} ({})", format.name, format.what));
  }
  return with_default(
      {"formats", JobKey::list}, fmt::format("{}", fmt::join(defaults, ",")),
      fmt::format("What to write, separated by commas: {}", fmt::join(described, ", ")),
      [](auto& s, auto& text, auto& place) { s.formats = parse_formats(text, place); });
}

/// The beginning of file names. throws Error(ErrorCode::command)
std::string checked_name(const std::string& text, const std::string& place) {
  if (text.empty() || text.front() == '.' || text.find('/') != std::string::npos)
    throw Error(ErrorCode::command, place,
                fmt::format("\"{}\" is no name that files can begin with.", text),
                "Give a word without slashes that does not begin with a dot, such as shot_v001.");
  return text;
}

/// A path of prims with one slash before each. throws Error(ErrorCode::command)
std::string checked_root(const std::string& text, const std::string& place) {
  static const std::regex path("/?[A-Za-z_][A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*/?");
  if (!std::regex_match(text, path))
    throw Error(ErrorCode::command, place, fmt::format("\"{}\" is no path of prims.", text),
                "Names are made of letters, digits and _, and do not begin with a digit: "
                "/World/letter.");
  const std::size_t first = text.front() == '/' ? 1 : 0, last = text.back() == '/' ? 1 : 0;
  return "/" + text.substr(first, text.size() - first - last);
}

std::vector<Option> scene_and_method() {
  using K = JobKey;
  return {
      without_default({"scene", K::text}, "shot.glb",
                      "An .fbx, .glb or .gltf file with a sheet and animated handles",
                      [](auto& s, auto& text, auto&) { s.scene = text; }),
      without_default({"output", K::text}, "out", "Output folder; created if it is missing",
                      [](auto& s, auto& text, auto&) { s.output = text; }),
      without_default({"name", K::text}, "shot_v001",
                      "Name that the output files begin with; otherwise that of the scene or job "
                      "file, without its ending (of the scene, if the job file is called job.toml)",
                      [](auto& s, auto& text, auto& place) { s.name = checked_name(text, place); }),
      with_default({"root", K::text}, "/shot",
                   "Prim of the USD layer below which the sheets are, such as /World/letter",
                   [](auto& s, auto& text, auto& place) { s.root = checked_root(text, place); }),
      without_default({"preset", K::text}, "copy70",
                      "Paper grade (see `paperbake presets`) or a preset file; overrides the paper "
                      "of the scene. Without either it is copy70",
                      [](auto& s, auto& text, auto&) { s.preset = text; }),
      with_default({"method", K::text}, "hybrid",
                   "Simulation method: hybrid, fem, adaptive, or hybrid+fem (hybrid with --polish)",
                   [](auto& s, auto& text, auto& place) {
                     if (!is_method(text))
                       throw Error(ErrorCode::command, place,
                                   fmt::format("Unknown method \"{}\".", text),
                                   fmt::format("This version has: {}.", all_methods));
                     s.method = text;
                   }),
      without_default(
          {"seed", K::whole, 0, 4294967295.0}, "0",
          "Seed of everything random; otherwise paper_seed of the sheet, or 0",
          [](auto& s, auto& text, auto&) { s.seed = static_cast<unsigned>(std::stoll(text)); }),
      without_default(
          {"triangles", K::whole, 2, 400000}, "1700",
          "Triangles of the simulation mesh: for fem their number, within 10 % (1700 by "
          "default); for hybrid and adaptive the largest number (3000 for adaptive; for hybrid "
          "1000, or twice those of the first mesh, of which a rehearsal may make 2000)",
          to_whole(&BakeSettings::triangles)),
      without_default({"polish", K::whole, 0, 400000}, "0",
                      "Refine every frame to equilibrium on a finite element mesh of at most this "
                      "many triangles, keeping the shape that the method found; 0 turns it off. "
                      "Default: 0; 6,000 for hybrid with --quality hero",
                      to_whole(&BakeSettings::polish)),
      with_default({"base_triangles", K::whole, 2, 20000}, "120",
                   "Triangles of the mesh that hybrid starts with. Without it, a strip has more: "
                   "two rows across",
                   to_whole(&BakeSettings::base_triangles)),
      without_default({"accuracy", K::number, above_zero}, "0.3",
                      "Choose the triangles so that nine of ten frames are estimated to be within "
                      "this many percent of the longer side of where finer meshes would have them. "
                      "The shot is first simulated on several meshes",
                      to_number([](auto& s) -> auto& { return s.accuracy; })),
      without_default({"budget", K::number, above_zero}, "30",
                      "Choose the finest mesh for which this many seconds of CPU time are enough, "
                      "for the search and the simulation together",
                      to_number([](auto& s) -> auto& { return s.budget; })),
  };
}

std::vector<Option> meshes_and_physics() {
  using K = JobKey;
  return {
      word<CacheMesh>(
          "mesh", &BakeSettings::mesh,
          {{"render", CacheMesh::render}, {"simulation", CacheMesh::simulation}}, "render",
          "Mesh in the caches: render (one fine mesh for the whole shot) or simulation (the coarse "
          "mesh of each frame)"),
      word<Quality>(
          "quality", &BakeSettings::quality,
          {{"draft", Quality::draft}, {"shot", Quality::shot}, {"hero", Quality::hero}}, "shot",
          "Edge length of the render mesh, for a sheet of 0.2 m: draft 5 mm, shot 2 mm, hero 1 mm; "
          "less on a strip, which has 8 across in a shot"),
      formats_option(),
      word<bool>("guides", &BakeSettings::guides, {{"off", false}, {"on", true}}, "off",
                 "Add the singular points and the folds to .abc and USD, as points and curves with "
                 "id, frame of birth and angle"),
      word<bool>("usd_layers", &BakeSettings::usd_layers, {{"off", false}, {"on", true}}, "off",
                 "Write USD as three layers: the asset, the animation as overs, and one that "
                 "composes both; with the simulated mesh as proxy"),
      without_default({"gravity", K::number}, "0",
                      "Gravity in m/s2, positive downwards; otherwise paper_gravity of the scene, "
                      "or 0",
                      [](auto& s, auto& text, auto&) { s.gravity = std::stod(text); }),
      without_default({"air", K::number, 0}, "1.2",
                      "Density of the air in kg/m3, which slows sheets with inertia; 0: none. "
                      "Otherwise paper_air of the scene, or 1.2",
                      [](auto& s, auto& text, auto&) { s.air = std::stod(text); }),
      without_default({"wind", K::text}, "2,0,0",
                      "Wind in m/s as x,y,z (z up), besides the winds of the scene",
                      [](auto& s, auto& text, auto& place) { s.wind = parse_wind(text, place); }),
      with_default({"stop", K::number, above_zero}, "1e-5",
                   "Tolerance of Newton's method: estimated distance from equilibrium in metres",
                   to_number([](auto& s) -> auto& { return s.stop; })),
      word<Dynamics>("dynamics", &BakeSettings::dynamics,
                     {{"auto", Dynamics::automatic}, {"off", Dynamics::off}, {"on", Dynamics::on}},
                     "auto",
                     "Inertia: auto (if a sheet falls, swings, is thrown, springs when it is let "
                     "go, or begins in a shape that does not bear its weight), off, on"),
      with_default({"probe", K::whole, 0, 100000}, "0",
                   "Every N frames, search for a shape of lower energy under the same handles, and "
                   "snap to it; 0 turns it off",
                   to_whole(&BakeSettings::probe_every)),
      with_default(
          {"attempts", K::whole, 1, 16}, "4",
          "How many attempts there are at most when a handle of the first one is off by more "
          "than 1 mm: other seeds, on first meshes of 2 and 4 times as many triangles in turn. "
          "The best is baked, or if it crumples, another one on 8 times as many that does not. "
          "Where handles hold, but the paper gets singular points, or its triangles put it off "
          "visibly, a second attempt on 4 times as many is baked if it does better there, or a "
          "third on 8 times as many if that is in doubt, too. 1: neither of both (method hybrid)",
          to_whole(&BakeSettings::attempts)),
      without_default(
          {"frames", K::text}, "1-96",
          "Frames to write: A-B, or A-BxN for every N-th. The simulation always starts at the "
          "first frame of the scene; after the last key handles rest",
          [](auto& s, auto& text, auto& place) { s.frames = parse_frames(text, place); }),
  };
}

std::vector<Option> maps_and_gates() {
  using K = JobKey;
  return {
      with_default({"map_size", K::whole, 1, 8192}, "1024", "Size of the square maps in texels",
                   to_whole(&BakeSettings::map_size)),
      word<MapLayout>("map_layout", &BakeSettings::map_layout,
                      {{"scanline", MapLayout::scanline}, {"tiled-mip", MapLayout::tiled_mip}},
                      "scanline",
                      "Layout of the maps: scanline, or tiled-mip (64 x 64 tiles with mip levels, "
                      "for renderers)"),
      without_default(
          {"map_frames", K::list}, "1-96x12",
          "Frames with a map: A-BxN, several separated by commas. There is always one of the last "
          "frame. Default: every 12th",
          [](auto& s, auto& text, auto& place) { s.map_frames = parse_frame_list(text, place); }),
      without_default({"debug_pictures", K::text}, "pictures",
                      "Write pictures of the simulation mesh, on the pattern and in space, to this "
                      "folder: for the frames of --map-frames (otherwise every 6th), frames with a "
                      "new singular point, and the last frame",
                      [](auto& s, auto& text, auto&) { s.debug_pictures = text; }),
      with_default({"max_stretch", K::number, above_zero}, "5",
                   "Quality gate: largest length error of an edge in percent",
                   to_number([](auto& s) -> auto& { return s.max_stretch_pct; })),
      with_default(
          {"twin", K::flag}, "false",
          "Simulate a second time with handles, or sheets that none moves, moved by 0.001 mm, and "
          "say from which frame on the scene is chaotic",
          [](auto& s, auto& text, auto&) { s.twin = text == "true"; }),
      with_default({"strict", K::flag}, "false",
                   "Stop if handles ask for more than paper can reach; otherwise they are followed "
                   "as far as possible",
                   [](auto& s, auto& text, auto&) { s.strict = text == "true"; }),
  };
}

std::vector<Option> run() {
  using K = JobKey;
  return {
      word<Resume>("resume", &BakeSettings::resume,
                   {{"auto", Resume::automatic}, {"never", Resume::never}}, "auto",
                   "auto: reuse the frames of an earlier bake in the folder, up to the first "
                   "change; never: simulate all frames"),
      with_default({"checkpoint", K::whole, 1, 100000}, "12",
                   "Every N frames, keep a checkpoint that a later bake can resume from",
                   to_whole(&BakeSettings::checkpoint_every)),
      with_default({"threads", K::whole, 1, 4096}, "2",
                   "Number of threads; the result does not depend on it",
                   to_whole(&BakeSettings::threads)),
      word<ProgressMode>("progress", &BakeSettings::progress,
                         {{"auto", ProgressMode::automatic},
                          {"plain", ProgressMode::plain},
                          {"json", ProgressMode::json},
                          {"none", ProgressMode::none}},
                         "auto",
                         "Progress on stderr: auto (a bar on a terminal, otherwise plain), plain "
                         "(lines), json (an object for each frame), none"),
  };
}

std::vector<Option> reading() {
  using K = JobKey;
  return {
      without_default({"fps", K::number, above_zero}, "24",
                      "Frame rate, instead of that of the file. glTF has none: there it is "
                      "otherwise paper_fps, or 24",
                      to_number([](auto& s) -> auto& { return s.reading.fps; })),
      without_default({"start_frame", K::whole, -1e6, 1e6}, "1",
                      "Frame of the first key, if the file has lost it (FBX export of Blender with "
                      "All Actions) or the animation is to be moved",
                      [](auto& s, auto& text, auto&) { s.reading.start_frame = std::stoi(text); }),
      without_default({"unit_scale", K::number, above_zero}, "1",
                      "Length of one unit of the file in metres",
                      to_number([](auto& s) -> auto& { return s.reading.unit_scale; })),
      with_default({"allow_outside", K::flag}, "false",
                   "Read buffers of a .gltf that lie outside its folder, too",
                   [](auto& s, auto& text, auto&) {
                     s.reading.parts = text == "true" ? Parts::anywhere : Parts::of_its_folder;
                   }),
      without_default({"take", K::text}, "Take 001",
                      "Name of the only animation to use; otherwise all are merged",
                      [](auto& s, auto& text, auto&) { s.reading.take = text; }),
  };
}

std::vector<Option> make_options() {
  std::vector<Option> all;
  for (const auto& group : {scene_and_method, meshes_and_physics, maps_and_gates, run, reading})
    for (Option& option : group()) all.push_back(std::move(option));
  for (Option& option : all) {
    option.flags = "--" + option.name;
    std::replace(option.flags.begin(), option.flags.end(), '_', '-');
  }
  return all;
}

}  // namespace

const std::vector<Option>& options() {
  static const std::vector<Option> all = make_options();
  return all;
}

const Option& option(const std::string& name) {
  return *std::find_if(options().begin(), options().end(),
                       [&](const Option& o) { return o.name == name; });
}

void apply_option(BakeSettings& settings, const Option& option, const std::string& text,
                  const std::string& place, Origin origin) {
  const auto value = canonical(option, text);
  if (!value)
    throw Error(ErrorCode::command, place,
                fmt::format("\"{}\" is not {}.", text, expected(option)));
  option.apply(settings, *value, place);
  settings.given[option.name] = {*value, origin};
}

}  // namespace paperbake
