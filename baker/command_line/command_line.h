#pragma once

#include <string>
#include <vector>

namespace paperbake {

/// Does what a command line says. The commands are in command.h.
/// arguments  of the program, without its name
/// returns    the exit code
/// throws     Error of the command; Error(ErrorCode::command) for a command line that says nothing
int run_command_line(const std::vector<std::string>& arguments);

}  // namespace paperbake
