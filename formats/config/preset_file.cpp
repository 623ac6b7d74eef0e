#include "formats/config/preset_file.h"

#include "core/model/degrees.h"
#include "core/model/error.h"
#include "formats/config/nearest_word.h"
#include "formats/config/toml_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string_view>

namespace paperbake {

// generated from presets/*.toml by cmake/embed_presets.cmake
struct BuiltInPreset {
  const char* name;
  const char* text;
};
extern const BuiltInPreset built_in_presets[];
extern const int built_in_preset_count;

namespace {

constexpr double lightest = 1e-3, heaviest = 10;  // [kg/m2]

}  // namespace

const std::array<PaperParameter, 11> paper_parameters{{
    {"thickness", &Paper::thickness, "m", 5e-6, 5e-3},
    {"bending_stiffness", &Paper::bending_stiffness, "N m", 1e-8, 10},
    {"membrane_stiffness", &Paper::membrane_stiffness, "N/m", 1e2, 1e8},
    {"poisson", &Paper::poisson, "1", 0, 0.49},
    {"area_density", &Paper::area_density, "kg/m2", lightest, heaviest},
    {"apex_scatter", &Paper::apex_scatter, "m", 0, 0.1},
    {"yield_strain", &Paper::yield_strain, "1", 1e-4, 0.1},
    {"hardening", &Paper::hardening, "1", 0, 0.9},
    {"grain_ratio", &Paper::grain_ratio, "1", 0.1, 10, false},
    {"grain_angle", &Paper::grain_angle, "deg", -360, 360, false, radians_of(1)},
    {"friction", &Paper::friction, "1", 0, max_friction, false},
}};

const PaperParameter grammage_parameter{
    "grammage", &Paper::area_density, "g/m2", 1e3 * lightest, 1e3 * heaviest, false, 1e-3};

namespace {

bool has_unit(const PaperParameter& parameter) { return parameter.unit != std::string_view("1"); }

bool is_file(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored) && !std::filesystem::is_directory(path, ignored);
}

const toml::node& required(const TomlDocument& document, const toml::table& table,
                           const std::string& key, const std::string& where) {
  const toml::node* node = table.get(key);
  if (!node)
    fail(document, table.source().begin, fmt::format("The key \"{}\" is missing{}.", key, where));
  return *node;
}

std::string required_text(const TomlDocument& document, const toml::table& table,
                          const std::string& key, const std::string& where) {
  const toml::node& node = required(document, table, key, where);
  if (!node.is_string())
    fail(document, node.source().begin, fmt::format("\"{}\" must be a quoted text.", key));
  std::string text = **node.as_string();
  if (text.empty()) fail(document, node.source().begin, fmt::format("\"{}\" is empty.", key));
  return text;
}

double read_value(const TomlDocument& document, const toml::table& table,
                  const PaperParameter& parameter, const std::string& where) {
  const toml::node& node = required(document, table, "value", where);
  if (!node.is_number())
    fail(document, node.source().begin,
         fmt::format("The value of {} must be a number.", parameter.key));
  const double value = *node.value<double>();
  if (!parameter.accepts(value))
    fail(document, node.source().begin, out_of_bounds(parameter, value),
         unit_remedy(parameter, value));
  return value;
}

Preset::Entry read_entry(const TomlDocument& document, const PaperParameter& parameter) {
  const toml::node& node = required(document, document.root, parameter.key, "");
  const toml::table* table = node.as_table();
  if (!table)
    fail(document, node.source().begin,
         fmt::format("\"{}\" must be a table with value, unit, source and mark.", parameter.key));
  refuse_unknown_keys(document, *table, {"value", "unit", "source", "mark"});

  const std::string where = fmt::format(" from [{}]", parameter.key);
  Preset::Entry entry{parameter.key, read_value(document, *table, parameter, where),
                      required_text(document, *table, "unit", where),
                      required_text(document, *table, "source", where),
                      required_text(document, *table, "mark", where)};
  if (entry.unit != parameter.unit)
    fail(document, table->get("unit")->source().begin,
         fmt::format("The unit of {} is \"{}\", not \"{}\".", parameter.key, parameter.unit,
                     entry.unit));
  const std::vector<std::string> marks = {"read", "derived", "assumed"};
  if (std::find(marks.begin(), marks.end(), entry.mark) == marks.end())
    fail(document, table->get("mark")->source().begin,
         fmt::format("Unknown mark \"{}\".{}", entry.mark, did_you_mean(entry.mark, marks)),
         "Marks: read, derived, assumed.");
  return entry;
}

Preset parse_preset(const std::string& file, const std::string& text) {
  const TomlDocument document = parse_toml(file, text);
  std::vector<std::string> known = {"name", "description", "by_grammage"};
  for (const PaperParameter& parameter : paper_parameters) known.push_back(parameter.key);
  refuse_unknown_keys(document, document.root, known);

  Preset preset;
  preset.text = text;
  preset.file = file;
  preset.paper.name = required_text(document, document.root, "name", "");
  if (document.root.contains("description"))
    preset.description = required_text(document, document.root, "description", "");
  if (const toml::node* chosen = document.root.get("by_grammage")) {
    if (!chosen->is_boolean())
      fail(document, chosen->source().begin, "\"by_grammage\" must be true or false.");
    preset.by_grammage = **chosen->as_boolean();
  }
  for (const PaperParameter& parameter : paper_parameters) {
    if (!parameter.required && !document.root.contains(parameter.key)) continue;
    preset.entries.push_back(read_entry(document, parameter));
    parameter.set(preset.paper, preset.entries.back().value);
  }
  const auto place = [&](const Preset::Entry& entry) {
    return document.root.get(entry.key)->source().begin;
  };
  std::sort(
      preset.entries.begin(), preset.entries.end(),
      [&](const Preset::Entry& p, const Preset::Entry& q) { return precedes(place(p), place(q)); });
  return preset;
}

}  // namespace

const PaperParameter& paper_parameter(std::string_view key) {
  return *std::find_if(paper_parameters.begin(), paper_parameters.end(),
                       [&](const PaperParameter& parameter) { return parameter.key == key; });
}

std::string out_of_bounds(const PaperParameter& parameter, double value) {
  return fmt::format("The {} cannot be {:g}: paper lies between {} and {}{}.", parameter.key, value,
                     parameter.min, parameter.max,
                     has_unit(parameter) ? fmt::format(" [{}]", parameter.unit) : "");
}

std::string unit_remedy(const PaperParameter& parameter, double value) {
  if (!has_unit(parameter)) return "Give a number within these bounds; it has no unit.";
  if (parameter.unit == std::string_view("m") && parameter.accepts(1e-3 * value))
    return fmt::format("Give the value in m: {:g} mm is {:g} m.", value, 1e-3 * value);
  return fmt::format("Give the value in {}.", parameter.unit);
}

std::string preset_text(const Preset& preset) {
  const auto text = [](const std::string& words) { return toml::value<std::string>(words); };
  std::ostringstream file;
  file << "name = " << text(preset.paper.name) << '\n';
  if (!preset.description.empty()) file << "description = " << text(preset.description) << '\n';
  if (!preset.by_grammage) file << "by_grammage = false\n";
  for (const Preset::Entry& e : preset.entries)
    file << fmt::format("\n[{}]\nvalue = {}\nunit = ", e.key, e.value) << text(e.unit)
         << "\nsource = " << text(e.source) << "\nmark = " << text(e.mark) << '\n';
  return file.str();
}

std::filesystem::path user_preset_folder() {
  const auto under = [](const char* variable, const char* rest) {
    const char* folder = std::getenv(variable);
    return folder && *folder ? std::filesystem::path(folder) / rest : std::filesystem::path();
  };
  const std::filesystem::path folder = under("XDG_CONFIG_HOME", "paperbake/presets");
  return folder.empty() ? under("HOME", ".config/paperbake/presets") : folder;
}

std::vector<std::string> user_preset_names() {
  std::vector<std::string> names;
  std::error_code none_there;
  for (const auto& entry : std::filesystem::directory_iterator(user_preset_folder(), none_there))
    if (entry.path().extension() == ".toml" && is_file(entry.path()))
      names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

Preset read_preset(const std::string& name_or_file, const std::string& asked_by) {
  if (is_file(name_or_file))
    return parse_preset(name_or_file, read_toml_text(name_or_file, "preset"));
  const std::vector<std::string> user_names = user_preset_names();
  if (std::find(user_names.begin(), user_names.end(), name_or_file) != user_names.end()) {
    const std::string file = (user_preset_folder() / (name_or_file + ".toml")).string();
    return parse_preset(file, read_toml_text(file, "preset"));
  }
  for (int i = 0; i < built_in_preset_count; ++i)
    if (name_or_file == built_in_presets[i].name)
      return parse_preset(fmt::format("presets/{}.toml", name_or_file), built_in_presets[i].text);

  const ErrorCode code = asked_by.empty() ? ErrorCode::command : ErrorCode::scene;
  if (name_or_file.find('/') != std::string::npos ||
      std::filesystem::path(name_or_file).extension() == ".toml")
    throw Error(code, asked_by.empty() ? name_or_file : asked_by,
                asked_by.empty() ? "There is no such preset file."
                                 : fmt::format("There is no preset file \"{}\".", name_or_file),
                "`paperbake presets` lists the built-in grades.");
  std::vector<std::string> names = preset_names();
  names.insert(names.end(), user_names.begin(), user_names.end());
  throw Error(
      code, asked_by.empty() ? fmt::format("preset \"{}\"", name_or_file) : asked_by,
      fmt::format("Unknown paper \"{}\".{}", name_or_file, did_you_mean(name_or_file, names)),
      fmt::format("Papers: {}; or give the path of a preset file.", fmt::join(names, ", ")));
}

std::vector<std::string> preset_names() {
  std::vector<std::string> names;
  for (int i = 0; i < built_in_preset_count; ++i) names.push_back(built_in_presets[i].name);
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace paperbake
