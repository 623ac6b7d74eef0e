#pragma once

#include "baker/job/settings.h"
#include "formats/config/job_file.h"

#include <functional>
#include <string>
#include <vector>

namespace paperbake {

/// An option of a bake: the command line, its help, the job file's reader and its writer all draw
/// on this one table.
struct Option : JobKey {
  std::string flags;  // on the command line: --map-size
  std::string help;
  // what it is when nobody says, as the command line would; empty: the help tells ...
  std::string default_value;
  std::string example;  // ... and this is one
  /// throws Error(Fault::command) at `place` when the text means nothing
  std::function<void(BakeSettings&, const std::string& text, const std::string& place)> apply;
};

/// In the order of the help. All but --set, which a job file says as [paper].
const std::vector<Option>& options();
const Option& option(const std::string& name);

/// Checks a value and applies it.
/// throws Error(Fault::command) at `place`: it is not what the option may be
void apply_option(BakeSettings&, const Option&, const std::string& text, const std::string& place,
                  Origin);

}  // namespace paperbake
