#pragma once

#include "baker/job/settings.h"
#include "formats/config/job_file.h"

#include <functional>
#include <string>
#include <vector>

namespace paperbake {

/// An option of a bake. Command line, its help and documentation, the reader and the writer of job
/// files are all made from this one table.
struct Option : JobKey {
  std::string flags;  // on the command line: --map-size
  std::string help;
  std::string default_value;  // as on the command line; empty: the help explains it ...
  std::string example;        // ... and this is one
  /// Sets the value. throws Error(ErrorCode::command) at `place` when the text has no meaning
  std::function<void(BakeSettings&, const std::string& text, const std::string& place)> apply;
};

/// All options but --set, which a job file writes as [paper], in the order of the help.
const std::vector<Option>& options();
/// The option of that name, which must exist.
const Option& option(const std::string& name);

/// Checks a value, sets it and notes who gave it.
/// throws Error(ErrorCode::command) at `place` when the option does not permit it
void apply_option(BakeSettings&, const Option&, const std::string& text, const std::string& place,
                  Origin);

}  // namespace paperbake
