#pragma once

#include <toml++/toml.h>

#include <filesystem>
#include <string>
#include <vector>

namespace paperbake {

/// A file as TOML, and how to speak of places in it. Every error is Error(Fault::command) with
/// place file:line:column.
struct TomlDocument {
  std::string file;
  toml::table root;
};

/// throws where the text is no TOML
TomlDocument parse_toml(const std::string& file, const std::string& text);

/// The whole file, at most 1 MB. kind: "preset", "job" for messages
std::string read_toml_text(const std::filesystem::path&, const std::string& kind);

std::string place_in(const TomlDocument&, const toml::source_position&);
[[noreturn]] void fail(const TomlDocument&, const toml::source_position&, std::string cause,
                       std::string remedy = {});

/// Where a key stands: the bracket of a [table], else the key itself.
toml::source_position position_of(const toml::key&, const toml::node&);
bool precedes(const toml::source_position&, const toml::source_position&);

/// Unknown keys are errors, the first one in the file first: a slip would silently keep a default.
void refuse_unknown_keys(const TomlDocument&, const toml::table&,
                         const std::vector<std::string>& known);

/// ' Did you mean "copy70"?', or nothing when no word is near.
std::string did_you_mean(const std::string& word, const std::vector<std::string>& words);

}  // namespace paperbake
