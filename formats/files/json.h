#pragma once

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <string_view>

namespace paperbake {

/// JSON whose objects keep their members in the order in which they were added. Texts are read and
/// written here alone, so that the templates of the parser are compiled once.
using Json = nlohmann::ordered_json;

/// throws Json::parse_error, which knows the byte, for a damaged text; Json::out_of_range for a
///        number that is too large for a double
Json parse_json(std::string_view text);

/// Nothing for a text that parse_json() throws for.
std::optional<Json> try_parse_json(std::string_view text);

/// The text in one line, without a line end. Names come from scene files in any encoding: bytes
/// that are not UTF-8 are replaced by U+FFFD.
std::string json_line(const Json&);

/// The same with a line for each member or element, indented by one space for each level; the last
/// line has no end.
std::string json_lines(const Json&);

}  // namespace paperbake
