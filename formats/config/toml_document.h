#pragma once

#include <toml++/toml.h>

#include <filesystem>
#include <string>
#include <vector>

namespace paperbake {

/// A parsed TOML file, with functions that report errors at a place in it. They all throw
/// Error(ErrorCode::command) whose place reads file:line:column.
struct TomlDocument {
  std::string file;
  toml::table root;
};

/// Parses the text of a file. throws when the text is not TOML
TomlDocument parse_toml(const std::string& file, const std::string& text);

/// The text of a file of at most 1 MB. kind: "preset", "job" or "lock", for error messages
std::string read_toml_text(const std::filesystem::path&, const std::string& kind);

std::string place_in(const TomlDocument&, const toml::source_position&);
[[noreturn]] void fail(const TomlDocument&, const toml::source_position&, std::string cause,
                       std::string remedy = {});

/// Position of a key: of the opening bracket for a [table], else of the key itself.
toml::source_position position_of(const toml::key&, const toml::node&);
bool precedes(const toml::source_position&, const toml::source_position&);

/// Throws at the first unknown key of the file: a misspelt key would otherwise silently leave its
/// default in force.
void refuse_unknown_keys(const TomlDocument&, const toml::table&,
                         const std::vector<std::string>& known);

}  // namespace paperbake
