#pragma once

#include "core/paper.h"

#include <array>
#include <string>
#include <vector>

namespace paperbake {

/// One number of a grade: its place in Paper, its unit, and what no paper is beyond. The bounds catch grams, millimetres and
/// micrometres given for SI; tissue and solid board lie well inside.
struct Quantity {
  const char* key;
  double Paper::*field;
  const char* unit;
  double least, most;
  bool holds(double value) const { return value >= least && value <= most; }  // false for NaN
};
extern const std::array<Quantity, 8> quantities;
/// "The thickness cannot be 9: paper lies between ...".
std::string out_of_bounds(const Quantity&, double value);

/// A paper grade with the evidence behind its numbers. Its file is TOML: `name`, perhaps `description`, and one table for
/// each number of Paper, all of them required:
///
///   [thickness]
///   value  = 90e-6        SI, in the unit below
///   unit   = "m"          must be the unit of that key
///   source = "GPO D10"    where the number comes from
///   mark   = "read"       read | derived | assumed
struct Preset {
  Paper paper;
  struct Entry {
    std::string key;     // thickness, bending_stiffness, membrane_stiffness, poisson, area_density, apex_scatter,
                         // yield_strain, hardening
    double value;        // SI
    std::string unit, source, mark;  // mark: read | derived | assumed
  };
  std::vector<Entry> entries;  // in order of the file
  std::string text;            // the file as it stands
};

/// `name_or_file`: a file that exists, or the name of a grade that is built in (the files of presets/, compiled into the program).
/// throws Error(Fault::command): unknown grade (with the nearest name); syntax error, unknown or missing key, wrong type, wrong
/// unit, value outside what paper can be: with file:line:column
Preset read_preset(const std::string& name_or_file);
std::vector<std::string> preset_names();  // built in, sorted

/// The nearest of `words` to `word` by edit distance, when it is near enough to be a slip (at most a third of the longer one
/// wrong, one letter always allowed; two neighbours swapped are one slip); else empty. The first of equals.
std::string nearest_word(const std::string& word, const std::vector<std::string>& words);

}  // namespace paperbake
