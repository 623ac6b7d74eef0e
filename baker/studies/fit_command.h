#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace paperbake {

/// The command `fit`: what it was told, and what it does. returns  the exit code
struct FitArguments {
  std::optional<std::filesystem::path> scatter;
  std::optional<std::string> from, experiment;
  std::filesystem::path output;
  int sheets = 20;
};
int run_fit(const FitArguments&);

}  // namespace paperbake
