#include "formats/preset_file.h"

#include "core/error.h"
#include "formats/toml_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace paperbake {

// made from presets/*.toml by cmake/embed_presets.cmake
struct BuiltInPreset { const char* name; const char* text; };
extern const BuiltInPreset built_in_presets[];
extern const int built_in_preset_count;

const std::array<Quantity, 8> quantities{{
    {"thickness", &Paper::thickness, "m", 5e-6, 5e-3},
    {"bending_stiffness", &Paper::bending_stiffness, "N m", 1e-8, 10},
    {"membrane_stiffness", &Paper::membrane_stiffness, "N/m", 1e2, 1e8},
    {"poisson", &Paper::poisson, "1", 0, 0.49},
    {"area_density", &Paper::area_density, "kg/m2", 1e-3, 10},
    {"apex_scatter", &Paper::apex_scatter, "m", 0, 0.1},
    {"yield_strain", &Paper::yield_strain, "1", 1e-4, 0.1},
    {"hardening", &Paper::hardening, "1", 0, 0.9},
}};

namespace {

const toml::node& required(const TomlDocument& document, const toml::table& table, const std::string& key, const std::string& where) {
  const toml::node* node = table.get(key);
  if (!node) fail(document, table.source().begin, fmt::format("The key \"{}\" is missing{}.", key, where));
  return *node;
}

std::string required_text(const TomlDocument& document, const toml::table& table, const std::string& key, const std::string& where) {
  const toml::node& node = required(document, table, key, where);
  if (!node.is_string()) fail(document, node.source().begin, fmt::format("\"{}\" must be a text in quotes.", key));
  std::string text = **node.as_string();
  if (text.empty()) fail(document, node.source().begin, fmt::format("\"{}\" is empty.", key));
  return text;
}

double read_value(const TomlDocument& document, const toml::table& table, const Quantity& quantity, const std::string& where) {
  const toml::node& node = required(document, table, "value", where);
  if (!node.is_number()) fail(document, node.source().begin, fmt::format("The value of {} must be a number.", quantity.key));
  const double value = *node.value<double>();
  if (!quantity.holds(value)) fail(document, node.source().begin, out_of_bounds(quantity, value), fmt::format("Give the value in {}.", quantity.unit));
  return value;
}

Preset::Entry read_entry(const TomlDocument& document, const Quantity& quantity) {
  const toml::node& node = required(document, document.root, quantity.key, "");
  const toml::table* table = node.as_table();
  if (!table)
    fail(document, node.source().begin, fmt::format("\"{}\" must be a table with value, unit, source and mark.", quantity.key));
  refuse_unknown_keys(document, *table, {"value", "unit", "source", "mark"});

  const std::string where = fmt::format(" from [{}]", quantity.key);
  Preset::Entry entry{quantity.key, read_value(document, *table, quantity, where), required_text(document, *table, "unit", where),
                      required_text(document, *table, "source", where), required_text(document, *table, "mark", where)};
  if (entry.unit != quantity.unit)
    fail(document, table->get("unit")->source().begin,
         fmt::format("The unit of {} is \"{}\", not \"{}\".", quantity.key, quantity.unit, entry.unit));
  const std::vector<std::string> marks = {"read", "derived", "assumed"};
  if (std::find(marks.begin(), marks.end(), entry.mark) == marks.end())
    fail(document, table->get("mark")->source().begin,
         fmt::format("Unknown mark \"{}\".{}", entry.mark, did_you_mean(entry.mark, marks)), "Marks: read, derived, assumed.");
  return entry;
}

Preset read_text(const std::string& file, const std::string& text) {
  const TomlDocument document = parse_toml(file, text);
  std::vector<std::string> known = {"name", "description"};
  for (const Quantity& quantity : quantities) known.push_back(quantity.key);
  refuse_unknown_keys(document, document.root, known);

  Preset preset;
  preset.text = text;
  preset.paper.name = required_text(document, document.root, "name", "");
  if (document.root.contains("description")) required_text(document, document.root, "description", "");
  for (const Quantity& quantity : quantities) {
    preset.entries.push_back(read_entry(document, quantity));
    preset.paper.*quantity.field = preset.entries.back().value;
  }
  const auto place = [&](const Preset::Entry& entry) { return document.root.get(entry.key)->source().begin; };
  std::sort(preset.entries.begin(), preset.entries.end(),
            [&](const Preset::Entry& p, const Preset::Entry& q) { return stands_before(place(p), place(q)); });
  return preset;
}

}  // namespace

std::string out_of_bounds(const Quantity& quantity, double value) {
  return fmt::format("The {} cannot be {}: paper lies between {} and {} [{}].", quantity.key, value, quantity.least, quantity.most, quantity.unit);
}

Preset read_preset(const std::string& name_or_file) {
  std::error_code ignored;
  if (std::filesystem::exists(name_or_file, ignored) && !std::filesystem::is_directory(name_or_file, ignored))
    return read_text(name_or_file, read_toml_text(name_or_file, "preset"));
  for (int i = 0; i < built_in_preset_count; ++i)
    if (name_or_file == built_in_presets[i].name)
      return read_text(fmt::format("presets/{}.toml", name_or_file), built_in_presets[i].text);

  if (name_or_file.find('/') != std::string::npos || std::filesystem::path(name_or_file).extension() == ".toml")
    throw Error(Fault::command, name_or_file, "There is no such preset file.", "`paperbake presets` lists the grades that are built in.");
  const std::vector<std::string> names = preset_names();
  throw Error(Fault::command, fmt::format("preset \"{}\"", name_or_file),
              fmt::format("Unknown paper \"{}\".{}", name_or_file, did_you_mean(name_or_file, names)),
              fmt::format("Papers: {}; or name a preset file that exists.", fmt::join(names, ", ")));
}

std::vector<std::string> preset_names() {
  std::vector<std::string> names;
  for (int i = 0; i < built_in_preset_count; ++i) names.push_back(built_in_presets[i].name);
  std::sort(names.begin(), names.end());
  return names;
}

std::string nearest_word(const std::string& word, const std::vector<std::string>& words) {
  // optimal string alignment: insert, delete, replace, swap neighbours
  const auto slips = [&word](const std::string& other) {
    const std::size_t n = word.size(), m = other.size();
    std::vector<std::vector<std::size_t>> d(n + 1, std::vector<std::size_t>(m + 1));
    for (std::size_t i = 0; i <= n; ++i)
      for (std::size_t j = 0; j <= m; ++j) {
        if (i == 0 || j == 0) { d[i][j] = i + j; continue; }
        d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (word[i - 1] != other[j - 1])});
        if (i > 1 && j > 1 && word[i - 1] == other[j - 2] && word[i - 2] == other[j - 1]) d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
      }
    return d[n][m];
  };
  std::string nearest;
  std::size_t least = std::string::npos;
  for (const std::string& other : words) {
    const std::size_t longer = std::max(word.size(), other.size()), count = slips(other);
    const std::size_t allowed = std::max<std::size_t>(1, longer / 3);
    if (count > allowed || count >= longer || count >= least) continue;
    nearest = other;
    least = count;
  }
  return nearest;
}

}  // namespace paperbake
