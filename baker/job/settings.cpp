#include "baker/job/settings.h"

#include "core/model/error.h"
#include "formats/config/nearest_word.h"
#include "formats/config/preset_file.h"
#include "formats/scene/scene_properties.h"

#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace paperbake {
namespace {

/// Reads an integer at the front of text and takes it off.
bool take_int(std::string_view& text, int& value) {
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failed != std::errc()) return false;
  text.remove_prefix(end - text.data());
  return true;
}

bool take(std::string_view& text, char c) {
  if (text.empty() || text.front() != c) return false;
  text.remove_prefix(1);
  return true;
}

std::string nearest_grade(double grammage) {
  std::string best;
  double least = INFINITY;
  for (const std::string& name : preset_names()) {
    const Preset preset = read_preset(name);
    const double off = std::abs(std::log(1e3 * preset.paper.area_density / grammage));
    if (preset.by_grammage && off < least) {
      least = off;
      best = name;
    }
  }
  return best;
}

/// throws Error when the weight or thickness of a sheet makes a paper that there is not
/// asked_by  the place in the scene
void check_scaled(const Paper& paper, Origin scaled, const std::string& asked_by) {
  for (const PaperParameter& parameter : paper_parameters)
    if (const double value = parameter.get(paper); !parameter.accepts(value))
      throw Error(scaled == Origin::job ? ErrorCode::command : ErrorCode::scene, asked_by,
                  "Weight and thickness of the sheet make a paper that there is not. " +
                      out_of_bounds(parameter, value),
                  fmt::format("They scale the grade \"{}\": give a weight and thickness that go "
                              "together, or another grade.",
                              paper.name));
}

void scale_thickness(Paper& paper, double ratio) {
  paper.thickness *= ratio;
  paper.membrane_stiffness *= ratio;
  paper.bending_stiffness *= ratio * ratio * ratio;
}

}  // namespace

FrameSpan parse_frames(const std::string& text, const std::string& place) {
  std::string_view rest = text;
  FrameSpan span;
  bool good = take_int(rest, span.first);
  span.last = span.first;
  if (good && take(rest, '-')) good = take_int(rest, span.last);
  if (good && take(rest, 'x')) good = take_int(rest, span.step);
  if (good && rest.empty() && span.last < span.first)
    throw Error(ErrorCode::command, place,
                fmt::format("The range \"{}\" ends before it begins.", text),
                fmt::format("Write {}-{}.", span.last, span.first));
  if (!good || !rest.empty() || span.step < 1)
    throw Error(ErrorCode::command, place, fmt::format("\"{}\" is no range of frames.", text),
                "Write A-B or A-BxN, for instance 1-96 or 1-96x2.");
  return span;
}

std::vector<FrameSpan> parse_frame_list(const std::string& text, const std::string& place) {
  std::vector<FrameSpan> spans;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t comma = std::min(text.find(',', from), text.size());
    spans.push_back(parse_frames(text.substr(from, comma - from), place));
    from = comma + 1;
  }
  return spans;
}

Vector3d parse_wind(const std::string& text, const std::string& place) {
  const char *at = text.data(), *end = text.data() + text.size();
  Vector3d wind;
  bool good = true;
  for (int k = 0; k < 3 && good; ++k) {
    if (k > 0) good = at != end && *at++ == ',';
    while (good && at != end && *at == ' ') ++at;
    const auto [next, failed] = std::from_chars(at, end, wind[k]);
    good = good && failed == std::errc() && std::isfinite(wind[k]);
    at = next;
  }
  if (!good || at != end)
    throw Error(ErrorCode::command, place, fmt::format("\"{}\" is no wind.", text),
                "Write its velocity in m/s as x,y,z with z up, for instance 2,0,0.");
  return wind;
}

const char* to_string(Origin origin) {
  constexpr const char* words[] = {"default", "preset", "scene", "job", "command line"};
  return words[static_cast<int>(origin)];
}

SetValue parse_set(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    throw Error(ErrorCode::command, "--set " + text, "A key and a value are needed.",
                "Write --set key=value, for instance --set thickness=90e-6.");
  const std::string name = text.substr(0, equals), number = text.substr(equals + 1);
  std::vector<std::string> names;
  for (const PaperParameter& parameter : paper_parameters) {
    names.push_back(parameter.key);
    if (name != parameter.key) continue;
    const auto value = canonical({name, JobKey::number}, number);
    if (!value)
      throw Error(ErrorCode::command, "--set " + name,
                  fmt::format("\"{}\" is not a number.", number),
                  "Write for instance --set thickness=90e-6.");
    if (!parameter.accepts(std::stod(*value)))
      throw Error(ErrorCode::command, "--set " + name, out_of_bounds(parameter, std::stod(*value)),
                  unit_remedy(parameter, std::stod(*value)));
    return {name, std::stod(*value), Origin::command};
  }
  throw Error(ErrorCode::command, "--set " + name,
              fmt::format("Unknown key \"{}\".{}", name, did_you_mean(name, names)),
              fmt::format("The keys are: {}.", fmt::join(names, ", ")));
}

ResolvedPaper resolve_paper(const BakeSettings& settings, const SceneSheet& sheet) {
  const Origin named = settings.origin("preset");  // of the preset for all sheets
  const auto of_sheet = [&](const char* key) {
    return sheet.overridden.count(key) ? Origin::job : Origin::scene;
  };
  const auto counts = [&](const char* key) {
    return !settings.preset || (named == Origin::job && of_sheet(key) == Origin::job);
  };
  const std::string place = place_of(settings.scene.filename().string(), "sheet", sheet.name);
  std::string grade = settings.preset.value_or("copy70");
  Origin origin = named, scaled = Origin::preset;
  if (counts("preset") && sheet.preset) {
    grade = *sheet.preset;
    origin = of_sheet("preset");
  } else if (counts("gsm") && sheet.grammage && !settings.preset) {
    grade = nearest_grade(*sheet.grammage);
    origin = of_sheet("gsm");
  }

  ResolvedPaper resolved;
  Paper& paper = resolved.paper;
  paper = read_preset(grade, origin == Origin::scene ? place + ", paper_preset" : "").paper;
  resolved.preset = grade;
  if (counts("gsm") && sheet.grammage) {
    const double ratio = 1e-3 * *sheet.grammage / paper.area_density;
    if (std::abs(ratio - 1) > 1e-9) scaled = of_sheet("gsm");
    scale_thickness(paper, ratio);
    paper.area_density = 1e-3 * *sheet.grammage;
  }
  if (counts("thickness") && sheet.thickness) {
    if (std::abs(*sheet.thickness / paper.thickness - 1) > 1e-6)
      scaled = std::max(scaled, of_sheet("thickness"));
    scale_thickness(paper, *sheet.thickness / paper.thickness);
  }
  const bool own_friction = counts("friction") && sheet.friction;
  if (own_friction) paper.friction = *sheet.friction;
  const std::string prefix = "paper." + toml_string(sheet.name) + ".";
  resolved.used.push_back({prefix + "preset", toml_string(paper.name), to_string(origin)});
  for (const PaperParameter& parameter : paper_parameters) {
    Origin who =
        own_friction && parameter.field == &Paper::friction ? of_sheet("friction") : scaled;
    for (const SetValue& set : settings.set)
      if (set.key == parameter.key && (set.origin == Origin::command || named != Origin::command)) {
        parameter.set(paper, set.value);
        who = set.origin;
      }
    resolved.used.push_back(
        {prefix + parameter.key, toml_number(parameter.get(paper)), to_string(who)});
  }
  if (scaled != Origin::preset) check_scaled(paper, scaled, place);
  return resolved;
}

}  // namespace paperbake
