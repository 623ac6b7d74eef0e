#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace paperbake {

/// One run of a program.
struct ProcessSpec {
  std::vector<std::string> arguments;  // behind the program's name
  std::filesystem::path log;           // takes what it prints
};

/// This program itself. throws Error(ErrorCode::folder) when the system does not tell
std::filesystem::path this_program();

/// Runs this program once with the arguments of each child, at most `max_running` at a time, in
/// order. A child ends with its parent, however that ends. When it is asked to stop, those that run
/// get a SIGTERM, and no more is begun.
/// started  called for each that is begun: its number
/// ended    called for each that came to its end: its number and its exit code; 128 + the signal
///          that ended it
/// stop     asked all the time: shall it end?
/// returns  whether it was stopped
/// throws Error(ErrorCode::folder) when a child cannot be started
bool run_processes(const std::vector<ProcessSpec>&, int max_running,
                   const std::function<void(std::size_t)>& started,
                   const std::function<void(std::size_t, int)>& ended,
                   const std::function<bool()>& stop);

}  // namespace paperbake
