#include "baker/settings.h"

#include "core/error.h"
#include "formats/preset_file.h"

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

double parse_number(const std::string& key, const std::string& text) {
  double value = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failed != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    throw Error(Fault::command, "--set " + key, fmt::format("\"{}\" is not a number.", text), "Write for instance --set thickness=90e-6.");
  return value;
}

const PaperQuantity& find_key(const std::string& name) {
  std::vector<std::string> names;
  for (const PaperQuantity& quantity : paper_quantities()) {
    if (name == quantity.key) return quantity;
    names.push_back(quantity.key);
  }
  const std::string near = nearest_word(name, names);
  throw Error(Fault::command, "--set " + name,
              fmt::format("Unknown key \"{}\".{}", name, near.empty() ? "" : fmt::format(" Did you mean \"{}\"?", near)),
              fmt::format("The keys are: {}.", fmt::join(names, ", ")));
}

std::string nearest_grade(double grammage) {
  std::string best;
  double least = INFINITY;
  for (const std::string& name : preset_names()) {
    const Preset preset = read_preset(name);
    const double off = std::abs(std::log(1e3 * preset.paper.area_density / grammage));
    if (preset.by_grammage && off < least) least = off, best = name;
  }
  return best;
}

void scale_thickness(Paper& paper, double ratio) {
  paper.thickness *= ratio;
  paper.membrane_stiffness *= ratio;
  paper.bending_stiffness *= ratio * ratio * ratio;
}

}  // namespace

FrameSpan parse_frames(const std::string& text, const std::string& option) {
  std::string_view rest = text;
  FrameSpan span;
  bool good = take_int(rest, span.first);
  span.last = span.first;
  if (good && take(rest, '-')) good = take_int(rest, span.last);
  if (good && take(rest, 'x')) good = take_int(rest, span.step);
  if (!good || !rest.empty() || span.last < span.first || span.step < 1)
    throw Error(Fault::command, option, fmt::format("\"{}\" is no range of frames.", text), "Write A-B or A-BxN, for instance 1-96 or 1-96x2.");
  return span;
}

std::vector<FrameSpan> parse_frame_list(const std::string& text, const std::string& option) {
  std::vector<FrameSpan> spans;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t comma = std::min(text.find(',', from), text.size());
    spans.push_back(parse_frames(text.substr(from, comma - from), option));
    from = comma + 1;
  }
  return spans;
}

std::string toml_number(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string toml_string(const std::string& value) {
  std::string text = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') text += '\\';
    if (static_cast<unsigned char>(c) < 0x20) text += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    else text += c;
  }
  return text + '"';
}

ResolvedPaper resolve_paper(const BakeSettings& settings, const SceneSheet& sheet) {
  std::string grade = "copy70", grade_origin = "default";
  const bool scene_speaks = !settings.preset;
  bool scaled = false;
  if (settings.preset) grade = *settings.preset, grade_origin = "command line";
  else if (sheet.preset) grade = *sheet.preset, grade_origin = "scene";
  else if (sheet.grammage) grade = nearest_grade(*sheet.grammage), grade_origin = "scene";

  ResolvedPaper resolved;
  Paper& paper = resolved.paper;
  paper = read_preset(grade).paper;
  if (scene_speaks && sheet.grammage) {
    const double ratio = 1e-3 * *sheet.grammage / paper.area_density;
    scaled = std::abs(ratio - 1) > 1e-9;
    scale_thickness(paper, ratio);
    paper.area_density = 1e-3 * *sheet.grammage;
  }
  if (scene_speaks && sheet.thickness) {
    scaled |= std::abs(*sheet.thickness / paper.thickness - 1) > 1e-6;
    scale_thickness(paper, *sheet.thickness / paper.thickness);
  }
  const std::string prefix = "paper." + toml_string(sheet.name) + ".";
  resolved.used.push_back({prefix + "preset", toml_string(paper.name), grade_origin});
  for (const PaperQuantity& quantity : paper_quantities()) {
    std::string origin = scaled ? "scene" : "preset";
    for (const auto& [name, text] : settings.set)
      if (&find_key(name) == &quantity) {
        const double value = parse_number(name, text);
        origin = "command line";
        if (!(value >= quantity.least && value <= quantity.most))
          throw Error(Fault::command, "--set " + name, fmt::format("{} cannot be {}: paper lies between {} and {} [{}].", name, text, quantity.least, quantity.most, quantity.unit));
        quantity.set(paper, value);
      }
    resolved.used.push_back({prefix + quantity.key, toml_number(quantity.of(paper)), origin});
  }
  return resolved;
}

}  // namespace paperbake
