#include "formats/config/job_file.h"

#include "core/model/degrees.h"
#include "core/model/error.h"
#include "formats/config/nearest_word.h"
#include "formats/config/preset_file.h"
#include "formats/config/toml_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace paperbake {
namespace {

constexpr double whole_limit = 2147483647;  // the largest int
constexpr double max_coordinate = 10;       // [m] on a pattern
constexpr std::size_t max_entries = 1000;   // of one list

/// The texts of an array, joined by commas; nothing when one of its elements is not a text.
std::optional<std::string> joined(const toml::array& list) {
  std::string text;
  for (const toml::node& node : list) {
    if (!node.is_string()) return std::nullopt;
    text += (text.empty() ? "" : ",") + **node.as_string();
  }
  return text;
}

/// The value of a node as it would be typed on the command line; nothing when its type is wrong.
std::optional<std::string> as_text(const JobKey& key, const toml::node& node) {
  switch (key.kind) {
    case JobKey::number:
      if (const auto* whole = node.as_integer()) return fmt::format("{}", **whole);
      if (const auto* number = node.as_floating_point()) return fmt::format("{}", **number);
      return std::nullopt;
    case JobKey::whole:
      return node.is_integer() ? std::optional(fmt::format("{}", **node.as_integer()))
                               : std::nullopt;
    case JobKey::flag:
      return node.is_boolean() ? std::optional<std::string>(**node.as_boolean() ? "true" : "false")
                               : std::nullopt;
    case JobKey::list:
      if (const toml::array* list = node.as_array()) return joined(*list);
      [[fallthrough]];
    default:
      return node.is_string() ? std::optional(**node.as_string()) : std::nullopt;
  }
}

std::vector<std::string> names_of(const std::vector<JobKey>& keys) {
  std::vector<std::string> names;
  for (const JobKey& key : keys) names.push_back(key.name);
  return names;
}

/// The values that a table has for these keys, in order of the keys.
std::vector<JobValue> read_values(const TomlDocument& document, const toml::table& table,
                                  const std::vector<JobKey>& keys) {
  std::vector<JobValue> values;
  for (const JobKey& key : keys) {
    const toml::node* node = table.get(key.name);
    if (!node) continue;
    const auto text = as_text(key, *node);
    const auto value = text ? canonical(key, *text) : std::nullopt;
    if (!value) {
      const std::string got = !text                      ? ""
                              : key.kind == JobKey::word ? fmt::format(", not \"{}\"", *text)
                                                         : fmt::format(", not {}", *text);
      fail(document, node->source().begin,
           fmt::format("\"{}\" must be {}{}.{}", key.name, expected(key), got,
                       text ? did_you_mean(*text, key.words) : ""));
    }
    values.push_back({key.name, *value, place_in(document, node->source().begin)});
  }
  return values;
}

/// A list of lists of `count` numbers: [[0.1, 0.2], ...], each of magnitude `max_coordinate` at
/// most.
std::vector<std::vector<double>> read_rows(const TomlDocument& document, const toml::node& node,
                                           const std::string& key, std::size_t count,
                                           const char* what) {
  const auto refuse = [&](const toml::node& at) {
    fail(document, at.source().begin,
         fmt::format("\"{}\" must be a list of {} in metres.", key, what));
  };
  const toml::array* list = node.as_array();
  if (!list || list->empty() || list->size() > max_entries) refuse(node);
  std::vector<std::vector<double>> rows;
  for (const toml::node& entry : *list) {
    const toml::array* numbers = entry.as_array();
    if (!numbers || numbers->size() != count) refuse(entry);
    rows.emplace_back();
    for (const toml::node& number : *numbers) {
      const auto value = number.is_number() ? number.value<double>() : std::nullopt;
      if (!value || !(std::abs(*value) <= max_coordinate)) refuse(number);
      rows.back().push_back(*value);
    }
  }
  return rows;
}

PrescribedCrease read_crease(const TomlDocument& document, const toml::node& node) {
  const toml::table* table = node.as_table();
  if (!table)
    fail(document, node.source().begin,
         "A crease must be a table: {line = [[0, 0.05], [0.1, 0.05]], angle = 30}.");
  refuse_unknown_keys(document, *table, {"line", "angle"});
  const toml::node* line = table->get("line");
  if (!line) fail(document, table->source().begin, "The key \"line\" of the crease is missing.");
  PrescribedCrease crease;
  for (const auto& p : read_rows(document, *line, "line", 2, "points [u, v]"))
    crease.line.emplace_back(p[0], p[1]);
  if (crease.line.size() < 2)
    fail(document, line->source().begin, "A crease needs at least two points.");
  const JobKey angle{"angle", JobKey::number, -170, 170};
  for (const JobValue& value : read_values(document, *table, {angle}))
    crease.angle = radians_of(std::stod(value.text));
  return crease;
}

SingularPointRules read_singular_point_rules(const TomlDocument& document,
                                             const toml::table& table) {
  SingularPointRules rules;
  if (const toml::node* keep = table.get("singular_keep"))
    for (const auto& p : read_rows(document, *keep, "singular_keep", 2, "points [u, v]"))
      rules.fixed.emplace_back(p[0], p[1]);
  if (const toml::node* forbid = table.get("singular_forbid"))
    for (const auto& p : read_rows(document, *forbid, "singular_forbid", 3, "discs [u, v, radius]"))
      rules.forbidden.push_back({{p[0], p[1]}, p[2]});
  return rules;
}

std::vector<PrescribedCrease> read_creases(const TomlDocument& document, const toml::table& table) {
  std::vector<PrescribedCrease> creases;
  const toml::node* node = table.get("crease");
  if (!node) return creases;
  const toml::array* list = node->as_array();
  if (!list || list->size() > max_entries)
    fail(document, node->source().begin,
         "\"crease\" must be a list of tables: [{line = [[0, 0.05], [0.1, 0.05]], angle = 30}].");
  for (const toml::node& crease : *list) creases.push_back(read_crease(document, crease));
  return creases;
}

const toml::table* table_at(const TomlDocument& document, const toml::table& parent,
                            const char* key, const char* form) {
  const toml::node* node = parent.get(key);
  if (!node) return nullptr;
  if (!node->is_table())
    fail(document, node->source().begin, fmt::format("\"{}\" must be a table: {}.", key, form));
  return node->as_table();
}

std::vector<JobSection> read_sections(const TomlDocument& document, const char* kind,
                                      const std::vector<JobKey>& keys,
                                      const std::vector<std::string>& rule_keys) {
  const std::string form = fmt::format("[{}.\"NAME*\"]", kind);
  const toml::table* all = table_at(document, document.root, kind, form.c_str());
  if (!all) return {};
  std::vector<std::pair<toml::source_position, JobSection>> sections;
  for (const auto& [name, node] : *all) {
    const toml::table* table = node.as_table();
    if (!table)
      fail(document, position_of(name, node),
           fmt::format("Values for {}s must stand under their names: {}.", kind, form));
    std::vector<std::string> known = names_of(keys);
    known.insert(known.end(), rule_keys.begin(), rule_keys.end());
    refuse_unknown_keys(document, *table, known);
    const toml::source_position at = position_of(name, node);
    sections.push_back(
        {at,
         {std::string(name.str()), place_in(document, at), read_values(document, *table, keys),
          read_singular_point_rules(document, *table), read_creases(document, *table)}});
  }
  std::sort(sections.begin(), sections.end(),
            [](const auto& a, const auto& b) { return precedes(a.first, b.first); });
  std::vector<JobSection> sorted;
  for (auto& section : sections) sorted.push_back(std::move(section.second));
  return sorted;
}

}  // namespace

const std::vector<JobKey>& sheet_keys() {
  static const PaperParameter &gsm = grammage_parameter, &thickness = paper_parameter("thickness");
  static const std::vector<JobKey> keys{{"preset", JobKey::text},
                                        {"gsm", JobKey::number, gsm.min, gsm.max},
                                        {"thickness", JobKey::number, thickness.min, thickness.max},
                                        {"friction", JobKey::number, 0, max_friction},
                                        {"seed", JobKey::whole, 0, whole_limit}};
  return keys;
}

const std::vector<JobKey>& handle_keys() {
  static const std::vector<JobKey> keys{{"mode", JobKey::word, 0, 0, {"absolute", "relative"}},
                                        {"grab_frame", JobKey::whole, -whole_limit, whole_limit},
                                        {"release_frame", JobKey::whole, -whole_limit, whole_limit},
                                        {"radius", JobKey::number, 0},
                                        {"stiffness", JobKey::number, 0},
                                        {"target", JobKey::text},
                                        {"point", JobKey::word, 0, 0, {"head", "tail"}},
                                        {"ignore", JobKey::flag}};
  return keys;
}

std::optional<std::string> canonical(const JobKey& key, const std::string& text) {
  const char *from = text.data(), *to = from + text.size();
  if (key.kind == JobKey::number || key.kind == JobKey::whole) {
    if (from != to && *from == '+') ++from;
    double value = 0;
    long long whole = 0;
    const auto [end, failed] = key.kind == JobKey::number ? std::from_chars(from, to, value)
                                                          : std::from_chars(from, to, whole);
    if (key.kind == JobKey::whole) value = static_cast<double>(whole);
    if (failed != std::errc() || end != to || !std::isfinite(value) ||
        !(value >= key.min && value <= key.max))
      return std::nullopt;
    return key.kind == JobKey::number ? toml_number(value) : fmt::format("{}", whole);
  }
  if (key.kind == JobKey::flag && text != "true" && text != "false") return std::nullopt;
  if (key.kind == JobKey::word &&
      std::find(key.words.begin(), key.words.end(), text) == key.words.end())
    return std::nullopt;
  return text;
}

std::string expected(const JobKey& key) {
  const bool below = std::isfinite(key.max), above = std::isfinite(key.min);
  const char* kind = key.kind == JobKey::whole ? "a whole number" : "a number";
  switch (key.kind) {
    case JobKey::number:
    case JobKey::whole:
      if (key.min == above_zero) return fmt::format("{} above zero", kind);
      if (above && below && std::abs(key.min) < whole_limit)
        return fmt::format("{} from {} to {}", kind, key.min, key.max);
      return above && !below ? fmt::format("{} from {} on", kind, key.min) : kind;
    case JobKey::flag:
      return "true or false";
    case JobKey::word:
      return fmt::format("one of {}", fmt::join(key.words, ", "));
    case JobKey::list:
      return "a list of quoted texts";
    default:
      return "a quoted text";
  }
}

JobFile read_job(const std::filesystem::path& path, const std::vector<JobKey>& keys) {
  const TomlDocument document = parse_toml(path.string(), read_toml_text(path, "job"));
  std::vector<std::string> known = names_of(keys);
  known.insert(known.end(), {"paper", "sheet", "handle"});
  refuse_unknown_keys(document, document.root, known);

  std::vector<JobKey> paper;
  for (const PaperParameter& parameter : paper_parameters)
    paper.push_back({parameter.key, JobKey::number, parameter.min, parameter.max});
  JobFile job;
  job.values = read_values(document, document.root, keys);
  if (const toml::table* table = table_at(document, document.root, "paper", "[paper]")) {
    refuse_unknown_keys(document, *table, names_of(paper));
    job.paper = read_values(document, *table, paper);
  }
  job.sheets = read_sections(document, "sheet", sheet_keys(),
                             {"singular_keep", "singular_forbid", "crease"});
  job.handles = read_sections(document, "handle", handle_keys(), {});
  return job;
}

std::string toml_number(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

std::string toml_point(const Vector2d& p) {
  return fmt::format("[{}, {}]", toml_number(p.x()), toml_number(p.y()));
}

std::string toml_creases(const std::vector<PrescribedCrease>& creases) {
  return toml_list(creases, [](const PrescribedCrease& c) {
    return fmt::format("{{line = {}, angle = {}}}", toml_list(c.line, toml_point),
                       toml_number(degrees_of(c.angle)));
  });
}

std::string toml_string(const std::string& value) {
  std::string text = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') text += '\\';
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      text += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    else
      text += c;
  }
  return text + '"';
}

}  // namespace paperbake
