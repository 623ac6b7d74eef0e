#pragma once

#include "baker/job/settings.h"

#include <string>
#include <vector>

namespace paperbake {

/// What a wedge varies, an option of a bake or a number of the paper, and the values it takes.
struct Axis {
  std::string key;                  // as in a job file: map_size, thickness
  std::vector<std::string> values;  // canonical (formats/config/job_file.h), at least one
  bool of_paper = false, number = false;
};

/// seed=1..16, gravity=0..9.8x2.45 (steps of 2.45), preset=copy70,copy90, thickness=80e-6,95e-6;
/// ranges and values may be mixed. throws Error(ErrorCode::command): unknown key (with the nearest
/// name), one that all variations share, no value, one that the key may not have
Axis parse_axis(const std::string& text);

/// throws Error(ErrorCode::command): one key twice, more than 10,000 variations
std::vector<Axis> parse_axes(const std::vector<std::string>& texts);

/// How many variations there are: every value of a key with every value of all others; 1 without
/// keys.
int variations(const std::vector<Axis>&);

/// The values of variation `index`, from 1, in the order of the keys; those of the last key change
/// first.
std::vector<std::string> values_of(const std::vector<Axis>&, int index);

/// The settings with these values, said on the command line.
BakeSettings varied(BakeSettings, const std::vector<Axis>&, int index);

}  // namespace paperbake
