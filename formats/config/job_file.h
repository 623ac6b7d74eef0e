#pragma once

#include "core/model/singular_point_rules.h"

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace paperbake {

/// What a value may be. An option of the command line and a key of a job file are the same thing
/// written two ways: --map-size 512 and map_size = 512.
struct JobKey {
  enum Kind { number, whole, flag, text, word, list };  // list: texts, or one with commas
  std::string name;                                     // map_size
  Kind kind = text;
  double min = -std::numeric_limits<double>::infinity();  // above_zero: an open bound
  double max = std::numeric_limits<double>::infinity();
  std::vector<std::string> words = {};  // of a word
};
inline constexpr double above_zero = std::numeric_limits<double>::min();

/// The value as TOML would write it, without quotes; none when it is not what the key may be.
std::optional<std::string> canonical(const JobKey&, const std::string& text);
/// "a number above zero", "one of draft, shot, hero"
std::string expected(const JobKey&);

/// A value that a job file gives, and where.
struct JobValue {
  std::string key, text;  // canonical
  std::string place;      // job.toml:3:8
};

/// [sheet."PATTERN"] or [handle."PATTERN"]: values for those whose name is like it.
struct JobSection {
  std::string pattern, place;
  std::vector<JobValue> values;
  Pins pins;  // of sheets
  std::vector<FoldLine> creases;
};

/// A job file: what the command line can say of a bake, and what it cannot: values by the names of
/// sheets and handles.
///
///   scene  = "shot.glb"              options of the command line with _ for -; paths from the
///   folder of the file
///   frames = "1-48"
///   [paper]                          --set, for all sheets
///   thickness = 95e-6
///   [handle."grip*"]                 paper_mode and so on, without paper_; names as matched_name
///   sees them, * and ? stand for letters
///   mode = "relative"
///   [sheet."paper*"]
///   preset = "copy90"
///   singular_keep   = [[0.05, 0.02]]         u, v [m]
///   singular_forbid = [[0.1, 0.1, 0.02]]     u, v, radius [m]
///   crease = [{line = [[0, 0.05], [0.1, 0.05]], angle = 30}]   angle [degrees], 0 when left out
struct JobFile {
  std::vector<JobValue> values, paper;
  std::vector<JobSection> sheets, handles;  // in order of the file: a later one wins
};

/// What may be said of a sheet and of a handle.
const std::vector<JobKey>& sheet_keys();
const std::vector<JobKey>& handle_keys();

/// throws Error(Fault::command) with file:line:column: no TOML, an unknown key (with the nearest
/// name), a wrong type, a value out of range
JobFile read_job(const std::filesystem::path&, const std::vector<JobKey>& keys);

/// TOML literals.
std::string toml_number(double);
std::string toml_string(const std::string&);
std::string toml_point(const Vector2d&);
std::string toml_creases(const std::vector<FoldLine>&);
template <class List, class Text>
std::string toml_list(const List& list, Text text) {
  std::string joined;
  for (const auto& entry : list) joined += (joined.empty() ? "" : ", ") + text(entry);
  return "[" + joined + "]";
}

}  // namespace paperbake
