#pragma once

#include "core/model/paper.h"

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace paperbake {

/// One number of Paper as files and the command line know it: its key, its unit and its permitted
/// range. The range catches grams, millimetres and micrometres given instead of SI units; tissue
/// and solid board lie well inside.
struct PaperParameter {
  const char* key;
  double Paper::*field;
  const char* unit;
  double min, max;       // in that unit
  bool required = true;  // in a preset
  double to_si = 1;      // value in Paper / value in that unit

  bool accepts(double value) const { return value >= min && value <= max; }  // false for NaN
  double get(const Paper& paper) const { return paper.*field / to_si; }
  void set(Paper& paper, double value) const { paper.*field = value * to_si; }
};
extern const std::array<PaperParameter, 11> paper_parameters;
/// The one of them with this key, which there must be.
const PaperParameter& paper_parameter(std::string_view key);
/// The area density in g/m2, as jobs and scenes give it; in the same range.
extern const PaperParameter grammage_parameter;
/// The error message for a value that is not accepted.
std::string out_of_bounds(const PaperParameter&, double value);
/// The remedy for a value out of bounds: names the unit, if the parameter has one, and converts a
/// length that would be right in millimetres.
std::string unit_remedy(const PaperParameter&, double value);

/// A paper grade with the evidence for its numbers. A preset file is TOML: `name`, optionally
/// `description` and `by_grammage` (false: a scene that gives only its weight does not get this
/// grade), and one table for each parameter; those of grain and friction may be left out:
///
///   [thickness]
///   value  = 90e-6        in the unit below
///   unit   = "m"          must be the unit of that parameter
///   source = "GPO D10"    where the number comes from
///   mark   = "read"       read | derived | assumed
struct Preset {
  Paper paper;
  std::string description;
  struct Entry {
    std::string key;                 // of paper_parameters
    double value;                    // in its unit
    std::string unit, source, mark;  // mark: read | derived | assumed
  };
  std::vector<Entry> entries;  // in order of the file
  bool by_grammage = true;     // paper_gsm of a scene may choose this grade
  std::string text;            // the whole file
  std::string file;            // its path, or presets/NAME.toml for a built-in one
};

/// Reads a preset. `name_or_file` is the path of an existing file, or the name of a grade:
/// NAME.toml in the user's own folder is preferred to a built-in preset (the files of presets/,
/// compiled into the program). throws Error(ErrorCode::command): unknown grade (with the nearest
/// name); or, at file:line:column, a syntax error, an unknown or missing key, a wrong type, a
/// wrong unit, a value out of range
/// asked_by  the place in a scene that names the grade: an unknown one is then an error of the
///           scene there, Error(ErrorCode::scene)
Preset read_preset(const std::string& name_or_file, const std::string& asked_by = "");
/// A preset file with the same content, without the comments of the original.
std::string preset_text(const Preset&);
std::vector<std::string> preset_names();  // of the built-in ones, sorted

/// $XDG_CONFIG_HOME/paperbake/presets, else ~/.config/paperbake/presets; empty when neither
/// variable is set.
std::filesystem::path user_preset_folder();
std::vector<std::string> user_preset_names();  // NAME of each NAME.toml there, sorted

}  // namespace paperbake
