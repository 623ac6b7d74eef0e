#pragma once

#include "core/model/paper.h"

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace paperbake {

/// One number of a grade: its place in Paper, the unit in which files and people give it, and what
/// no paper is beyond. The bounds catch grams, millimetres and micrometres given for SI; tissue and
/// solid board lie well inside.
struct PaperParameter {
  const char* key;
  double Paper::*field;
  const char* unit;
  double min, max;       // in that unit
  bool required = true;  // in a preset
  double to_si = 1;

  bool accepts(double value) const { return value >= min && value <= max; }  // false for NaN
  double get(const Paper& paper) const { return paper.*field / to_si; }
  void set(Paper& paper, double value) const { paper.*field = value * to_si; }
};
extern const std::array<PaperParameter, 11> paper_parameters;
/// The sentence for a value that it does not hold.
std::string out_of_bounds(const PaperParameter&, double value);

/// A paper grade with the evidence behind its numbers. Its file is TOML: `name`, perhaps
/// `description`, `by_grammage` (false: not a paper that a scene means by its weight alone), and
/// one table for each number of Paper; the grain's and friction's may be left out:
///
///   [thickness]
///   value  = 90e-6        SI, in the unit below
///   unit   = "m"          must be the unit of that key
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
  bool by_grammage = true;     // paper_gsm of a scene may choose it
  std::string text;            // the file as it stands
  std::string file;            // its path, or presets/NAME.toml of one that is built in
};

/// `name_or_file`: a file that exists; or the name of a grade: NAME.toml in the user's own folder,
/// then built in (the files of presets/, compiled into the program). throws Error(Fault::command):
/// unknown grade (with the nearest name); syntax error, unknown or missing key, wrong type, wrong
/// unit, value outside what paper can be: with file:line:column
Preset read_preset(const std::string& name_or_file);
/// A file that reads as this preset; comments are lost.
std::string preset_text(const Preset&);
std::vector<std::string> preset_names();  // built in, sorted

/// $XDG_CONFIG_HOME/paperbake/presets, without it ~/.config/paperbake/presets; empty when neither
/// is set.
std::filesystem::path user_preset_folder();
std::vector<std::string> user_preset_names();  // NAME of NAME.toml in there, sorted

/// The nearest of `words` to `word` by edit distance, when it is near enough to be a slip (at most
/// a third of the longer one wrong, one letter always allowed; two neighbours swapped are one
/// slip); else empty. The first of equals.
std::string nearest_word(const std::string& word, const std::vector<std::string>& words);

}  // namespace paperbake
