#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>
#include <optional>
#include <string>

namespace paperbake {

/// What `fit` was told.
struct FitWords {
  std::optional<std::filesystem::path> scatter;
  std::optional<std::string> from, experiment;
  std::filesystem::path output;
  int sheets = 20;
};
void add_fit(CLI::App&, FitWords&);
int run_fit(const FitWords&);

}  // namespace paperbake
