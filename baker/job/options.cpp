#include "baker/job/options.h"

#include "baker/job/plan.h"
#include "core/model/error.h"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace paperbake {
namespace {

using Apply = std::function<void(BakeSettings&, const std::string& text, const std::string& place)>;

/// Sets a field, which may be optional, from a number.
template <class MeshPoint>
Apply to_number(MeshPoint place) {
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

/// One of several words, the first of them the usual one unless the table says otherwise.
template <class Value>
Option word(std::string name, Value BakeSettings::*field,
            std::vector<std::pair<std::string, Value>> values, std::string default_value,
            std::string help) {
  Option option{{std::move(name), JobKey::word}, "", std::move(help),
                std::move(default_value),        "", nullptr};
  for (const auto& [text, value] : values) option.words.push_back(text);
  option.apply = [field, values](BakeSettings& s, const std::string& text, const std::string&) {
    s.*field = std::find_if(values.begin(), values.end(), [&](const auto& v) {
                 return v.first == text;
               })->second;
  };
  return option;
}

Option with_default(JobKey key, std::string default_value, std::string help, Apply apply) {
  return {std::move(key), "", std::move(help), std::move(default_value), "", std::move(apply)};
}

/// One that depends on scene, preset or method when nobody says.
Option without_default(JobKey key, std::string example, std::string help, Apply apply) {
  return {std::move(key), "", std::move(help), "", std::move(example), std::move(apply)};
}

std::set<std::string> parse_formats(const std::string& text, const std::string& place) {
  const std::vector<std::string> known{"abc", "maps", "cert", "report", "usd", "pc2", "preview"};
  std::set<std::string> formats;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t comma = std::min(text.find(',', from), text.size());
    const std::string name = text.substr(from, comma - from);
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw Error(Fault::command, place, fmt::format("Unknown format \"{}\".", name),
                  fmt::format("This version writes: {}.", fmt::join(known, ", ")));
    formats.insert(name);
    from = comma + 1;
  }
  return formats;
}

std::vector<Option> make_options() {
  using K = JobKey;
  std::vector<Option> all{
      without_default({"scene", K::text}, "shot.glb",
                      "An .fbx, .glb or .gltf file with a sheet and animated handles",
                      [](auto& s, auto& text, auto&) { s.scene = text; }),
      without_default({"output", K::text}, "out", "Output folder; made when missing",
                      [](auto& s, auto& text, auto&) { s.output = text; }),
      without_default(
          {"preset", K::text}, "copy70",
          "Paper grade (see `paperbake presets`) or a preset file; replaces what the scene says "
          "of the paper, else copy70",
          [](auto& s, auto& text, auto&) { s.preset = text; }),
      with_default({"method", K::text}, "hybrid",
                   "How to simulate: hybrid, fem, adaptive; hybrid+fem: hybrid, polished",
                   [](auto& s, auto& text, auto& place) {
                     if (!is_method(text))
                       throw Error(Fault::command, place,
                                   fmt::format("Unknown method \"{}\".", text),
                                   fmt::format("This version has: {}.", all_methods));
                     s.method = text;
                   }),
      without_default(
          {"seed", K::whole, 0, 4294967295.0}, "0",
          "Seed of all that is random; else the sheet's paper_seed, else 0",
          [](auto& s, auto& text, auto&) { s.seed = static_cast<unsigned>(std::stoll(text)); }),
      without_default(
          {"triangles", K::whole, 2, 400000}, "1700",
          "Triangles of fem's mesh, within 10 % (1700); the most that hybrid (250, or twice what "
          "it begins with) and adaptive (3000) may have",
          to_whole(&BakeSettings::triangles)),
      without_default(
          {"polish", K::whole, 0, 400000}, "0",
          "Bring every frame to the minimum of a fem of at most this many triangles, on the "
          "branch that the method found; 0: do not (hero: 6,000)",
          to_whole(&BakeSettings::polish)),
      with_default({"base_triangles", K::whole, 2, 100000}, "120",
                   "Triangles that hybrid begins with", to_whole(&BakeSettings::base_triangles)),
      word<CacheMesh>(
          "mesh", &BakeSettings::mesh,
          {{"render", CacheMesh::render}, {"simulation", CacheMesh::simulation}}, "render",
          "Mesh in the cache: render (one for the whole shot), simulation (as it is simulated)"),
      word<Quality>(
          "quality", &BakeSettings::quality,
          {{"draft", Quality::draft}, {"shot", Quality::shot}, {"hero", Quality::hero}}, "shot",
          "Edges of the render mesh on a sheet of 0.2 m: draft 5 mm, shot 2 mm, hero 1 mm"),
      with_default(
          {"formats", K::list}, "abc,maps,cert,report",
          "What to write, of abc,maps,cert,report,usd,pc2,preview",
          [](auto& s, auto& text, auto& place) { s.formats = parse_formats(text, place); }),
      without_default({"gravity", K::number}, "0",
                      "m/s2, positive = downwards; else the scene's paper_gravity, else 0",
                      [](auto& s, auto& text, auto&) { s.gravity = std::stod(text); }),
      with_default({"stop", K::number, above_zero}, "1e-5",
                   "Newton's stop: metres from the minimum",
                   to_number([](auto& s) -> auto& { return s.stop; })),
      word<Dynamics>("dynamics", &BakeSettings::dynamics,
                     {{"auto", Dynamics::automatic}, {"off", Dynamics::off}, {"on", Dynamics::on}},
                     "auto", "Inertia: auto (where a sheet falls, swings or is thrown), off, on"),
      with_default(
          {"probe", K::whole, 0, 100000}, "0",
          "Every N frames, look for another shape of less energy under the same handles, and take "
          "it; 0: never",
          to_whole(&BakeSettings::probe_every)),
      without_default(
          {"frames", K::text}, "1-96",
          "A-B or A-BxN: frames to write; simulated from the scene's first; past the last key "
          "handles rest",
          [](auto& s, auto& text, auto& place) { s.frames = parse_frames(text, place); }),
      with_default({"map_size", K::whole, 1, 16384}, "1024", "Texels on a side of the maps",
                   to_whole(&BakeSettings::map_size)),
      word<MapLayout>("map_layout", &BakeSettings::map_layout,
                      {{"scanline", MapLayout::scanline}, {"tiled-mip", MapLayout::tiled_mip}},
                      "scanline",
                      "scanline; tiled-mip: 64 x 64 tiles with mip levels, for renderers"),
      without_default(
          {"map_frames", K::list}, "1-96x12",
          "Frames with a map: A-BxN,...; the final one always (default: every 12th)",
          [](auto& s, auto& text, auto& place) { s.map_frames = parse_frame_list(text, place); }),
      without_default(
          {"debug_pictures", K::text}, "pictures",
          "Folder for pictures of pattern mesh and sheet: of the frames of --map-frames (else "
          "every 6th), of births and of the last",
          [](auto& s, auto& text, auto&) { s.debug_pictures = text; }),
      with_default({"max_stretch", K::number, above_zero}, "5",
                   "Gate: longest or shortest edge in percent of its rest length",
                   to_number([](auto& s) -> auto& { return s.max_stretch_pct; })),
      with_default(
          {"strict", K::flag}, "false",
          "Refuse handles that ask the impossible, instead of meeting them as far as paper can",
          [](auto& s, auto& text, auto&) { s.strict = text == "true"; }),
      word<Resume>("resume", &BakeSettings::resume,
                   {{"auto", Resume::automatic}, {"never", Resume::never}}, "auto",
                   "auto: what an earlier bake left in the folder is not simulated again as far as "
                   "nothing has changed; never: begin at the first frame"),
      with_default({"checkpoint", K::whole, 1, 100000}, "12",
                   "Every N frames, keep what a later bake can go on from",
                   to_whole(&BakeSettings::checkpoint_every)),
      with_default({"threads", K::whole, 1, 4096}, "2",
                   "Threads; the result does not depend on them", to_whole(&BakeSettings::threads)),
      word<ProgressMode>("progress", &BakeSettings::progress,
                         {{"auto", ProgressMode::automatic},
                          {"plain", ProgressMode::plain},
                          {"json", ProgressMode::json},
                          {"none", ProgressMode::none}},
                         "auto", "How to tell on stderr how far it is"),
      without_default(
          {"fps", K::number, above_zero}, "24",
          "Frames a second, instead of the file's own (glTF has none: else paper_fps, else 24)",
          to_number([](auto& s) -> auto& { return s.reading.fps; })),
      without_default(
          {"start_frame", K::whole, -1e6, 1e6}, "1",
          "Frame of the first key, where the file has lost it (Blender's FBX export with All "
          "Actions) or is to be moved",
          [](auto& s, auto& text, auto&) { s.reading.start_frame = std::stoi(text); }),
      without_default({"unit_scale", K::number, above_zero}, "1",
                      "Length of one unit of the file in metres",
                      to_number([](auto& s) -> auto& { return s.reading.unit_scale; })),
      without_default({"take", K::text}, "Take 001",
                      "Name of the one animation to use; else all are merged",
                      [](auto& s, auto& text, auto&) { s.reading.take = text; }),
  };
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
    throw Error(Fault::command, place, fmt::format("\"{}\" is not {}.", text, expected(option)));
  option.apply(settings, *value, place);
  settings.given[option.name] = {*value, origin};
}

}  // namespace paperbake
