#include "formats/config/toml_document.h"

#include "core/model/error.h"
#include "formats/config/nearest_word.h"
#include "formats/files/atomic_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>

namespace paperbake {

std::string place_in(const TomlDocument& document, const toml::source_position& at) {
  return fmt::format("{}:{}:{}", document.file, at.line, at.column);
}

void fail(const TomlDocument& document, const toml::source_position& at, std::string cause,
          std::string remedy) {
  throw Error(ErrorCode::command, place_in(document, at), std::move(cause), std::move(remedy));
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

/// Position of a byte, as the parser tells positions: columns count the characters of UTF-8.
toml::source_position position_at(std::string_view toml, std::size_t byte) {
  const std::string_view before = toml.substr(0, byte),
                         line = before.substr(before.rfind('\n') + 1);
  const auto begins_character = [](char c) { return (c & 0xC0) != 0x80; };
  return {toml::source_index(1 + std::count(before.begin(), before.end(), '\n')),
          toml::source_index(1 + std::count_if(line.begin(), line.end(), begins_character))};
}

/// Where a text begins that is not closed: in one quote by the end of its line, in three by the end
/// of the file. none: all texts are closed
std::optional<toml::source_position> open_quote(std::string_view toml) {
  std::size_t begin = 0;
  std::string_view open;  // the quotes that the text began with; empty: outside of a text
  for (std::size_t i = 0; i < toml.size();) {
    const std::string_view rest = toml.substr(i);
    const char c = rest[0];
    if (open.empty() && c == '#') {
      i = std::min(toml.find('\n', i), toml.size());
    } else if (open.empty()) {
      begin = i;
      if (c == '"' || c == '\'')
        open = rest.substr(0, rest.substr(0, 3) == std::string(3, c) ? 3 : 1);
      i += std::max<std::size_t>(1, open.size());
    } else if (rest.substr(0, open.size()) == open) {
      i += open.size();
      // quotes at the end of such a text belong to it
      if (open.size() == 3) i = std::min(toml.find_first_not_of(open, i), toml.size());
      open = {};
    } else if (open.size() == 1 && (c == '\n' || c == '\r')) {
      break;
    } else {
      i += c == '\\' && open[0] == '"' ? 2 : 1;
    }
  }
  if (open.empty()) return std::nullopt;
  return position_at(toml, begin);
}

TomlDocument parse_toml(const std::string& file, const std::string& text) {
  try {
    return {file, toml::parse(text, file)};
  } catch (const toml::parse_error& error) {
    const toml::source_position at = error.source().begin;
    const std::optional<toml::source_position> quote = open_quote(text);
    fail({file, {}}, at, fmt::format("This is not TOML: {}.", error.description()),
         quote && precedes(*quote, at) ? "A quote before this place may not be closed." : "");
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
