#include "baker/command_line/command.h"
#include "baker/output/say.h"
#include "formats/config/preset_file.h"
#include "formats/files/json.h"

#include <algorithm>
#include <fmt/format.h>
#include <memory>
#include <optional>

namespace paperbake {
namespace {

struct PresetsArguments {
  std::optional<std::string> name;
  bool json = false;
};

CLI::App* add_presets(CLI::App& app, PresetsArguments& parsed) {
  CLI::App& presets =
      *app.add_subcommand("presets", "List the paper grades, or print one with its sources");
  presets.add_option("NAME", parsed.name, "A grade or a preset file");
  presets.add_flag("--json", parsed.json, "Print JSON");
  return &presets;
}

int run_presets(const PresetsArguments& parsed) {
  const auto& [name, json] = parsed;
  if (name && !json) {
    print_data(read_preset(*name).text);
    return 0;
  }
  Json all = Json::array();
  std::string table;
  std::vector<std::string> grades = name ? std::vector<std::string>{*name} : preset_names();
  const std::vector<std::string> own_grades = user_preset_names();
  const auto is_own = [&](const std::string& grade) {
    return std::find(own_grades.begin(), own_grades.end(), grade) != own_grades.end();
  };
  if (!name)  // those of the user stand for those built in of the same name
    for (const std::string& own : own_grades)
      if (std::find(grades.begin(), grades.end(), own) == grades.end()) grades.push_back(own);
  for (const std::string& grade : grades) {
    const Preset preset = read_preset(grade);
    Json entries = Json::object();
    for (const Preset::Entry& e : preset.entries)
      entries[e.key] = {
          {"value", e.value}, {"unit", e.unit}, {"source", e.source}, {"mark", e.mark}};
    all.push_back({{"name", preset.paper.name}, {"file", preset.file}, {"values", entries}});
    if (!json)
      table +=
          fmt::format("{:<12} {:>4g} g/m2  {:>4g} um  D {:<8g} N m  {}\n", grade,
                      1e3 * preset.paper.area_density, 1e6 * preset.paper.thickness,
                      preset.paper.bending_stiffness, is_own(grade) ? preset.file : "built in");
  }
  print_data(json ? json_lines(name ? all.front() : all) + "\n" : table);
  return 0;
}

}  // namespace

Command presets_command(CLI::App& app) {
  const auto parsed = std::make_shared<PresetsArguments>();
  CLI::App* const command = add_presets(app, *parsed);
  return {command, [=] { return run_presets(*parsed); }};
}

}  // namespace paperbake
