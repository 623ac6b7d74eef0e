#pragma once

#include "core/model/error.h"

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

namespace paperbake {

/// The error for a command or option that does not exist, with the nearest one; nothing when all
/// of them do.
/// words  of the command line, without the name of the program
std::optional<Error> misspelling(const CLI::App&, const std::vector<std::string>& words);

}  // namespace paperbake
