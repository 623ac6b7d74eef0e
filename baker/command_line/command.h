#pragma once

#include <CLI/CLI.hpp>
#include <chrono>
#include <functional>
#include <string>
#include <vector>

namespace paperbake {

/// A command of the program, such as bake: its options, and what it does once they are parsed.
struct Command {
  CLI::App* app;
  std::function<int()> run;  // returns the exit code
  // how long Ctrl-C lets it complete what it does (baker/bake/stop_signals.h)
  std::function<std::chrono::milliseconds()> patience = [] { return std::chrono::milliseconds(0); };
};

/// Each adds its command to the program.
Command bake_command(CLI::App&);
/// arguments  of the program, as they were given: a wedge runs it again for each of its variations
Command wedge_command(CLI::App&, const std::vector<std::string>& arguments);
Command chart_command(CLI::App&);
Command inspect_command(CLI::App&);
Command fit_command(CLI::App&);
Command verify_command(CLI::App&);
Command report_command(CLI::App&);
Command presets_command(CLI::App&);

}  // namespace paperbake
