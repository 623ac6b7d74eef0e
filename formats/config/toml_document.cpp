#include "formats/config/toml_document.h"

#include "core/model/error.h"
#include "formats/config/preset_file.h"
#include "formats/files/atomic_file.h"

#include <fmt/format.h>

#include <algorithm>

namespace paperbake {

std::string place_in(const TomlDocument& document, const toml::source_position& at) {
  return fmt::format("{}:{}:{}", document.file, at.line, at.column);
}

void fail(const TomlDocument& document, const toml::source_position& at, std::string cause,
          std::string remedy) {
  throw Error(ErrorCode::command, place_in(document, at), std::move(cause), std::move(remedy));
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& words) {
  const std::string nearest = nearest_word(word, words);
  return nearest.empty() ? "" : fmt::format(" Did you mean \"{}\"?", nearest);
}

toml::source_position position_of(const toml::key& key, const toml::node& node) {
  const toml::table* table = node.as_table();
  return table && !table->is_inline() ? node.source().begin : key.source().begin;
}

bool precedes(const toml::source_position& p, const toml::source_position& q) {
  return p.line != q.line ? p.line < q.line : p.column < q.column;
}

void refuse_unknown_keys(const TomlDocument& document, const toml::table& table,
                         const std::vector<std::string>& known) {
  const toml::key* first = nullptr;
  toml::source_position at;
  for (const auto& [key, node] : table) {
    if (std::find(known.begin(), known.end(), key.str()) != known.end()) continue;
    const toml::source_position place = position_of(key, node);
    if (!first || precedes(place, at)) {
      first = &key;
      at = place;
    }
  }
  if (!first) return;
  const std::string word(first->str());
  fail(document, at, fmt::format("Unknown key \"{}\".{}", word, did_you_mean(word, known)),
       fmt::format("Known keys: {}.", fmt::join(known, ", ")));
}

// TOML ends no text at the end of a line: a quote that is left open is met as the line break, which
// is a control character, or as the end of the file.
std::string syntax_remedy(std::string_view cause) {
  const auto says = [&](const char* words) { return cause.find(words) != cause.npos; };
  if (says("string: ") && (says("control characters") || says("end-of-file")))
    return "A quote before this place may not be closed.";
  return "";
}

TomlDocument parse_toml(const std::string& file, const std::string& text) {
  try {
    return {file, toml::parse(text, file)};
  } catch (const toml::parse_error& error) {
    fail({file, {}}, error.source().begin,
         fmt::format("This is not TOML: {}.", error.description()),
         syntax_remedy(error.description()));
  }
}

std::string read_toml_text(const std::filesystem::path& file, const std::string& kind) {
  constexpr std::uintmax_t max_size = 1 << 20;
  if (const std::string no_file = kind_of_no_file(file); !no_file.empty())
    throw Error(ErrorCode::command, file.string(),
                fmt::format("The {} file cannot be read: this is {}.", kind, no_file),
                "Name a file, not something that is written while it is read.");
  std::error_code unknown;
  if (const std::uintmax_t size = std::filesystem::file_size(file, unknown);
      !unknown && size > max_size)
    throw Error(ErrorCode::command, file.string(),
                fmt::format("This is not a {} file: it is larger than 1 MB.", kind));
  const std::optional<std::string> text = read_file(file);
  if (!text)
    throw Error(ErrorCode::command, file.string(), fmt::format("The {} file cannot be read.", kind),
                "Check its name and permissions.");
  return *text;
}

}  // namespace paperbake
