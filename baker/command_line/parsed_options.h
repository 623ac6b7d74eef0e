#pragma once

#include "baker/job/settings.h"

#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <vector>

namespace paperbake {

/// What a command was told of the options of the table (baker/job/options.h).
struct ParsedOptions {
  CLI::App* command = nullptr;
  std::map<std::string, std::string> text;  // by option, of those that the command has
  std::vector<std::string> set;
};

/// Adds one option of the table to the command.
/// flags  its spelling, where it is not that of the table
void add_option(ParsedOptions&, const std::string& name, const std::string& flags = {});

/// The options that say how a scene file is read.
void add_reading_options(ParsedOptions&);

/// --set
void add_set(ParsedOptions&);

/// SCENE and all options of the table, and --set.
void add_all_options(ParsedOptions&);

/// Puts what was said into the settings: first the job file, when the scene is one, then the
/// command line.
void apply_command_line(const ParsedOptions&, BakeSettings&);

/// throws Error(ErrorCode::command) when no output folder was given
void require_output(const BakeSettings&, const char* remedy = "Write -o DIR.");

/// For a bake, which completes what it can when it is asked to stop.
bool is_stop_asked();

}  // namespace paperbake
