#pragma once

#include "core/model/singular_point_rules.h"

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace paperbake {

/// The name and the permitted values of a setting. An option of the command line and a key of a
/// job file are the same setting in two notations: --map-size 512 and map_size = 512.
struct JobKey {
  // list: an array of texts, or one text with commas
  enum Kind { number, whole, flag, text, word, list };
  std::string name;  // as in a job file: map_size
  Kind kind = text;
  double min = -std::numeric_limits<double>::infinity();  // above_zero: zero itself is excluded
  double max = std::numeric_limits<double>::infinity();
  std::vector<std::string> words = {};  // the permitted words of kind `word`
};
inline constexpr double above_zero = std::numeric_limits<double>::min();

/// The value as TOML would write it, without quotes; nothing when the key does not permit it.
std::optional<std::string> canonical(const JobKey&, const std::string& text);
/// What the key permits, for a sentence: "a number above zero", "one of draft, shot, hero".
std::string expected(const JobKey&);

/// A value given by a job file, and its place there.
struct JobValue {
  std::string key, text;  // text: canonical
  std::string place;      // job.toml:3:8
};

/// A table [sheet."PATTERN"] or [handle."PATTERN"]: values for every sheet or handle whose name
/// matches the pattern.
struct JobSection {
  std::string pattern, place;
  std::vector<JobValue> values;
  SingularPointRules singular_point_rules;  // of sheets
  std::vector<PrescribedCrease> creases;
};

/// A job file: every option of the command line for a bake, and in addition values for single
/// sheets and handles, chosen by name.
///
///   scene  = "shot.glb"    options of the command line, with _ for -; paths are relative to the
///   frames = "1-48"        folder of the job file
///   [paper]                as --set, for all sheets
///   thickness = 95e-6
///   [handle."grip*"]       properties as paper_mode, without paper_; names are compared as by
///   mode = "relative"      matched_name, * stands for any characters and ? for one
///   [sheet."paper*"]
///   preset = "copy90"
///   singular_keep   = [[0.05, 0.02]]         u, v [m]
///   singular_forbid = [[0.1, 0.1, 0.02]]     u, v, radius [m]
///   crease = [{line = [[0, 0.05], [0.1, 0.05]], angle = 30}]   angle [degrees], default 0
struct JobFile {
  std::vector<JobValue> values, paper;
  std::vector<JobSection> sheets, handles;  // in order of the file: a later section wins
};

/// The keys of a [sheet."..."] and of a [handle."..."] table.
const std::vector<JobKey>& sheet_keys();
const std::vector<JobKey>& handle_keys();

/// Reads a job file with these top-level keys. throws Error(ErrorCode::command) at
/// file:line:column: no TOML, an unknown key (with the nearest known one), a wrong type, a value
/// out of range
JobFile read_job(const std::filesystem::path&, const std::vector<JobKey>& keys);

/// Values as TOML literals.
std::string toml_number(double);
std::string toml_string(const std::string&);
std::string toml_point(const Vector2d&);
std::string toml_creases(const std::vector<PrescribedCrease>&);
template <class List, class Text>
std::string toml_list(const List& list, Text text) {
  std::string joined;
  for (const auto& entry : list) joined += (joined.empty() ? "" : ", ") + text(entry);
  return "[" + joined + "]";
}

}  // namespace paperbake
