#include "formats/scene/scene_properties.h"

#include "core/model/error.h"
#include "formats/config/nearest_word.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>

namespace paperbake {
namespace {

// paper_uv, paper_locked, paper_weight, paper_interp and paper_tangent are accepted but have no
// effect
constexpr std::array known_properties = {
    "paper_grab_frame", "paper_release_frame", "paper_mode",    "paper_radius",  "paper_target",
    "paper_point",      "paper_stiffness",     "paper_ignore",  "paper_preset",  "paper_gsm",
    "paper_thickness",  "paper_seed",          "paper_fps",     "paper_gravity", "paper_size",
    "paper_collider",   "paper_friction",      "paper_crease",  "paper_uv",      "paper_locked",
    "paper_weight",     "paper_interp",        "paper_tangent", "paper_uv_sets", "paper_colours",
    "paper_attributes", "paper_air",           "paper_speed",   "paper_gust",    "paper_axis"};

const PropertyValue* find(const ImportedNode& node, const std::string& key) {
  const auto found = node.properties.find(key);
  if (found == node.properties.end()) return nullptr;
  const auto* text = std::get_if<std::string>(&found->second);
  return text && text->empty() ? nullptr : &found->second;
}

std::string to_text(const PropertyValue& value) {
  if (const auto* number = std::get_if<double>(&value)) return fmt::format("{}", *number);
  if (const auto* text = std::get_if<std::string>(&value)) return fmt::format("\"{}\"", *text);
  return fmt::format("[{}]", fmt::join(std::get<std::vector<double>>(value), ", "));
}

std::optional<double> as_number(const PropertyValue& value) {
  if (const auto* number = std::get_if<double>(&value)) return *number;
  if (const auto* list = std::get_if<std::vector<double>>(&value))
    return list->size() == 1 ? std::optional(list->front()) : std::nullopt;
  const std::string& text = std::get<std::string>(value);
  double number;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(number)
                                                                  : std::nullopt;
}

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

constexpr std::array roles = {"paper", "handle", "collider", "crease", "wind"};

/// Whether a name begins as those of nodes that are read do.
bool has_role(std::string_view name) {
  const std::string lower = lower_case(name);
  return std::any_of(roles.begin(), roles.end(),
                     [&](const char* role) { return lower.rfind(role, 0) == 0; });
}

/// The role that a word was probably meant to be: it begins with the same letter, and one more is
/// wrong, missing, superfluous or changed places with its neighbour. Empty: none. "wind" is too
/// short to be told from "wing" and "find".
std::string misspelt_role(const std::string& word) {
  for (const std::string role : roles)
    if (role != "wind" && word.substr(0, 1) == role.substr(0, 1) && edit_distance(word, role) == 1)
      return role;
  return "";
}

[[noreturn]] void reject(const std::string& source, const ImportedNode& node,
                         const std::string& key, const char* wanted) {
  throw Error(ErrorCode::scene, place_of(source, "node", node.name),
              fmt::format("The property {} is {}, not {}.", key, to_text(*find(node, key)), wanted),
              "Correct it in the DCC and export again.");
}

}  // namespace

PropertyValue text_or_list(const std::string& text) {
  if (text.size() < 2 || text.front() != '[' || text.back() != ']') return text;
  std::vector<double> list;
  for (const char *at = text.data() + 1, *end = text.data() + text.size() - 1; at < end;) {
    if (*at == ' ' || *at == ',') {
      ++at;
      continue;
    }
    double number;
    const auto [next, error] = std::from_chars(at, end, number);
    if (error != std::errc()) return text;
    list.push_back(number);
    at = next;
  }
  return list;
}

std::string matched_name(std::string_view raw) {
  if (const std::string_view behind = raw.substr(raw.rfind(':') + 1);  // npos + 1 = 0
      has_role(behind) || !has_role(raw))
    raw = behind;
  const auto digit = [](char c) { return '0' <= c && c <= '9'; };
  if (raw.size() > 4 && raw[raw.size() - 4] == '.' && std::all_of(raw.end() - 3, raw.end(), digit))
    raw.remove_suffix(4);
  std::string name = lower_case(raw);
  for (char& c : name)
    if (c == '_' || c == '-') c = '.';
  return name;
}

bool name_begins_with(std::string_view raw, std::string_view prefix) {
  return matched_name(raw).compare(0, prefix.size(), prefix) == 0;
}

bool is_longer_word(std::string_view raw, std::string_view prefix) {
  const std::string name = matched_name(raw);
  return name.compare(0, prefix.size(), prefix) == 0 && name.size() > prefix.size() &&
         std::isalpha(static_cast<unsigned char>(name[prefix.size()]));
}

bool is_tail_leaf(const std::string& name, const std::string& bone) {
  return name == bone + "_end" || name == bone + "_leaf";
}

std::string instanced_name(std::string_view name) {
  const std::size_t mark = name.rfind("|Dupli|");
  if (mark == std::string::npos) return "";
  name = name.substr(0, mark);
  return std::string(name.substr(name.rfind('|') + 1));  // npos + 1 = 0
}

std::vector<std::string> ignored_instances(const std::vector<ImportedNode>& nodes) {
  std::vector<std::string> warnings;
  for (const ImportedNode& node : nodes)
    if (!node.pivot && has_role(matched_name(instanced_name(node.name))) &&
        !has_role(matched_name(node.name)))
      warnings.push_back(fmt::format("\"{}\" is ignored: it is the instance of a collection. {}",
                                     node.name, realise_instances));
  return warnings;
}

std::vector<std::string> misspelt_names(const std::vector<ImportedNode>& nodes) {
  std::vector<std::string> warnings;
  for (const ImportedNode& node : nodes) {
    const std::string name = matched_name(node.name);
    if (node.pivot || has_role(name) || node.properties.count("paper_collider") ||
        node.properties.count("paper_ignore"))
      continue;
    const auto end =
        std::find_if(name.begin(), name.end(), [](unsigned char c) { return !std::isalpha(c); });
    const std::string role = misspelt_role({name.begin(), end});
    if (!role.empty())
      warnings.push_back(fmt::format(
          "\"{}\" has no part in the scene: should its name begin with \"{}\"?", node.name, role));
  }
  return warnings;
}

std::string place_of(const std::string& source, std::string_view kind, std::string_view name) {
  return fmt::format("{}, {} \"{}\"", source, kind, name);
}

std::optional<double> number_property(const std::string& source, const ImportedNode& node,
                                      const std::string& key, const char* wanted) {
  const PropertyValue* value = find(node, key);
  if (!value) return std::nullopt;
  const auto number = as_number(*value);
  if (!number || !std::isfinite(*number)) reject(source, node, key, wanted);
  return number;
}

std::optional<int> whole_property(const std::string& source, const ImportedNode& node,
                                  const std::string& key) {
  const auto number = number_property(source, node, key);
  if (!number) return std::nullopt;
  if (*number != std::round(*number) || std::abs(*number) > std::numeric_limits<int>::max())
    reject(source, node, key, "a whole number");
  return static_cast<int>(*number);
}

std::optional<double> positive_property(const std::string& source, const ImportedNode& node,
                                        const std::string& key) {
  const auto number = number_property(source, node, key);
  if (number && !(*number > 0)) reject(source, node, key, "greater than zero");
  return number;
}

std::optional<double> nonnegative_property(const std::string& source, const ImportedNode& node,
                                           const std::string& key) {
  const auto number = number_property(source, node, key);
  if (number && *number < 0) reject(source, node, key, "zero or greater");
  return number;
}

std::optional<std::string> text_property(const ImportedNode& node, const std::string& key) {
  const PropertyValue* value = find(node, key);
  if (!value) return std::nullopt;
  if (const auto* text = std::get_if<std::string>(value)) return *text;
  return to_text(*value);
}

std::vector<double> list_property(const ImportedNode& node, const std::string& key) {
  const PropertyValue* value = find(node, key);
  const auto* list = value ? std::get_if<std::vector<double>>(value) : nullptr;
  return list ? *list : std::vector<double>();
}

std::optional<bool> yes_or_no(const ImportedNode& node, const std::string& key) {
  const PropertyValue* value = find(node, key);
  if (!value) return std::nullopt;
  if (const auto number = as_number(*value)) return *number != 0;
  const auto* text = std::get_if<std::string>(value);
  const std::string word = text ? matched_name(*text) : "";
  if (word == "true" || word == "yes") return true;
  return word == "false" || word == "no" ? std::optional(false) : std::nullopt;
}

bool flag_property(const ImportedNode& node, const std::string& key) {
  return yes_or_no(node, key).value_or(false);
}

std::optional<NumberOfScene> number_of_scene(
    const std::string& source, const std::vector<ImportedNode>& nodes, const std::string& key,
    const std::function<std::optional<double>(const ImportedNode&)>& read) {
  constexpr double one_rate = 1e-5;  // relative: 23.976 and 24000/1001 are one rate
  std::optional<NumberOfScene> first;
  for (const ImportedNode& node : nodes) {
    const auto number = read(node);
    if (!number) continue;
    if (!first) first = {*number, node.name};
    if (std::abs(*number - first->value) <= one_rate * std::abs(first->value)) continue;
    throw Error(ErrorCode::scene,
                fmt::format("{}, nodes \"{}\" and \"{}\"", source, first->node, node.name),
                fmt::format("{} is {:g} on the one and {:g} on the other, and it counts for the "
                            "whole scene.",
                            key, first->value, *number),
                "Give it to one object only, or the same number to both.");
  }
  return first;
}

std::vector<std::string> unknown_properties(const std::vector<ImportedNode>& nodes) {
  std::vector<std::string> warnings;
  for (const ImportedNode& node : nodes)
    for (const auto& [key, value] : node.properties)
      if (key.rfind("paper_", 0) == 0 && std::find(known_properties.begin(), known_properties.end(),
                                                   key) == known_properties.end())
        warnings.push_back(
            fmt::format("The property {} of node \"{}\" is unknown and ignored.{}", key, node.name,
                        did_you_mean(key, {known_properties.begin(), known_properties.end()})));
  return warnings;
}

}  // namespace paperbake
