#include "baker/job/job_settings.h"

#include "baker/job/options.h"
#include "core/model/error.h"
#include "core/model/handles.h"
#include "formats/config/preset_file.h"

#include <algorithm>
#include <fmt/format.h>

namespace paperbake {
namespace {

namespace fs = std::filesystem;

bool is_path(const std::string& key) {
  return key == "scene" || key == "output" || key == "debug_pictures";
}

/// A preset is a file when there is one beside the job, by that name or as NAME.toml; else a grade.
std::string preset_from(const fs::path& folder, const std::string& text) {
  std::error_code none;
  for (const std::string& name : {text, text + ".toml"})
    if (fs::is_regular_file(folder / name, none)) return (folder / name).string();
  return text;
}

PropertyValue property_of(const JobKey& key, const std::string& text) {
  if (key.kind == JobKey::flag) return text == "true" ? 1.0 : 0.0;
  if (key.kind == JobKey::number || key.kind == JobKey::whole) return std::stod(text);
  return text;
}

const JobKey& key_named(const std::vector<JobKey>& keys, const std::string& name) {
  return *std::find_if(keys.begin(), keys.end(),
                       [&](const JobKey& key) { return key.name == name; });
}

NodeOverride override_of(NodeOverride::Kind kind, const JobSection& section) {
  NodeOverride made{
      kind, section.pattern, section.place, {}, section.singular_point_rules, section.creases};
  const auto& keys = kind == NodeOverride::sheet ? sheet_keys() : handle_keys();
  for (const JobValue& value : section.values)
    made.properties["paper_" + value.key] = property_of(key_named(keys, value.key), value.text);
  return made;
}

// ---- writing

std::string literal(const JobKey& key, const std::string& text) {
  const bool quoted =
      key.kind == JobKey::text || key.kind == JobKey::word || key.kind == JobKey::list;
  return quoted ? toml_string(text) : text;
}

std::string relative_to(const fs::path& folder, const std::string& path) {
  return fs::proximate(fs::absolute(path), fs::absolute(folder.empty() ? "." : folder))
      .generic_string();
}

std::string rules_text(const SingularPointRules& rules,
                       const std::vector<PrescribedCrease>& creases) {
  std::string text;
  if (!rules.fixed.empty()) text += "singular_keep = " + toml_list(rules.fixed, toml_point) + "\n";
  if (!rules.forbidden.empty())
    text += "singular_forbid = " +
            toml_list(rules.forbidden,
                      [](const Disc& d) {
                        return fmt::format("[{}, {}, {}]", toml_number(d.centre.x()),
                                           toml_number(d.centre.y()), toml_number(d.radius));
                      }) +
            "\n";
  if (!creases.empty()) text += "crease = " + toml_creases(creases) + "\n";
  return text;
}

/// A preset as the job file names it: a grade, or a file as seen from the folder of the job.
std::string preset_named_from(const fs::path& folder, const std::string& preset) {
  std::error_code none;
  return fs::is_regular_file(preset, none) ? relative_to(folder, preset) : preset;
}

std::string sections_text(const char* kind, const std::vector<JobKey>& keys,
                          const std::vector<JobSection>& sections, const fs::path& folder) {
  std::string text;
  for (const JobSection& section : sections) {
    text += fmt::format("\n[{}.{}]\n", kind, toml_string(section.pattern));
    for (const JobValue& value : section.values)
      text += fmt::format(
          "{} = {}\n", value.key,
          literal(key_named(keys, value.key),
                  value.key == "preset" ? preset_named_from(folder, value.text) : value.text));
    text += rules_text(section.singular_point_rules, section.creases);
  }
  return text;
}

bool has_section(const std::vector<JobSection>& sections, const std::string& name) {
  return std::any_of(sections.begin(), sections.end(),
                     [&](const JobSection& s) { return s.pattern == name; });
}

std::string sheet_comment(const BakeSettings& settings, const SceneSheet& sheet,
                          const fs::path& folder) {
  const Vector2d size = extent(sheet.pattern);
  const ResolvedPaper resolved = resolve_paper(settings, sheet);
  return fmt::format(
      "\n# [sheet.{}]  # {:.2f} x {:.2f} mm\n# preset = {}\n# gsm = {:.6g}\n# thickness = {}  # "
      "m\n# "
      "seed = {}\n"
      "# singular_keep = [[{:.4g}, {:.4g}]]  # u, v in m: a singular point from the first frame "
      "on\n"
      "# singular_forbid = [[{:.4g}, {:.4g}, {:.4g}]]  # u, v, radius: none is born in this disc\n"
      "# crease = [{{line = [[0.0, {:.4g}], [{:.4g}, {:.4g}]], angle = 0.0}}]  # folded before the "
      "first frame; degrees that it springs back to\n",
      toml_string(sheet.name), 1e3 * size.x(), 1e3 * size.y(),
      toml_string(preset_named_from(folder, resolved.preset)), 1e3 * resolved.paper.area_density,
      toml_number(resolved.paper.thickness), sheet.seed.value_or(0), size.x() / 2, size.y() / 2,
      size.x() / 2, size.y() / 2, size.minCoeff() / 10, size.y() / 2, size.x(), size.y() / 2);
}

std::string handle_comment(const Scene& scene, const SceneSheet& sheet, std::size_t h) {
  const Handle& handle = sheet.handles[h];
  const bool held_at_once = handle.grab_frame < scene.first_frame,
             never_released = handle.release_frame == std::numeric_limits<int>::max();
  return fmt::format(
      "\n# [handle.{}]  # holds ({:.2f}, {:.2f}) mm\n# mode = \"{}\"\n# grab_frame = {}\n# "
      "release_frame = {}\n"
      "# radius = {}  # m\n# stiffness = {}  # N/m, 0: hard\n# target = {}\n# ignore = false\n",
      toml_string(handle.name), 1e3 * handle.pattern.x(), 1e3 * handle.pattern.y(),
      handle.mode == HandleMode::relative ? "relative" : "absolute",
      held_at_once ? scene.first_frame : handle.grab_frame,
      never_released ? scene.last_frame + 1 : handle.release_frame,
      toml_number(disc_radius(sheet.handles, h, sheet.pattern)), toml_number(handle.stiffness),
      toml_string(sheet.name));
}

/// The section [paper]: what it sets, and as comments the other numbers of the first sheet.
std::string paper_text(const BakeSettings& settings, const Scene& scene) {
  const SceneSheet& sheet = scene.sheets.front();
  const Paper paper = resolve_paper(settings, sheet).paper;
  std::string text = fmt::format(
      "\n# One number of the paper, over preset and scene; here those of {}{}.\n[paper]\n",
      paper.name, scene.sheets.size() > 1 ? fmt::format(", the paper of \"{}\"", sheet.name) : "");
  const bool commanded = settings.origin("preset") == Origin::command;
  for (const PaperParameter& parameter : paper_parameters) {
    std::string line = fmt::format("# {} = {}", parameter.key, toml_number(parameter.get(paper)));
    for (const SetValue& set : settings.set)
      if (set.key == parameter.key && (set.origin == Origin::command || !commanded))
        line = fmt::format("{} = {}", set.key, toml_number(set.value));
    text += fmt::format("{}  # [{}]\n", line, parameter.unit);
  }
  return text;
}

std::string option_text(const BakeSettings& settings, const Option& option,
                        const fs::path& folder) {
  const auto given = settings.given.find(option.name);
  if (given == settings.given.end())
    return fmt::format(
        "# {} = {}\n", option.name,
        literal(option, option.default_value.empty() ? option.example : option.default_value));
  std::string text = given->second.text;
  if (is_path(option.name)) text = relative_to(folder, text);
  if (option.name == "preset") text = preset_named_from(folder, text);
  return fmt::format("{} = {}\n", option.name, literal(option, text));
}

}  // namespace

bool is_job(const fs::path& path) { return path.extension() == ".toml"; }

void load_job(BakeSettings& settings, const fs::path& path) {
  JobFile job = read_job(path, {options().begin(), options().end()});
  const fs::path folder = path.parent_path();
  const std::string stem = path.stem().string();
  if (stem != "job" && stem != "job.lock") settings.name = stem;  // these say nothing of the shot
  for (const JobValue& value : job.values) {
    const std::string text = is_path(value.key)      ? (folder / value.text).string()
                             : value.key == "preset" ? preset_from(folder, value.text)
                                                     : value.text;
    apply_option(settings, option(value.key), text, value.place, Origin::job);
  }
  for (const JobValue& value : job.paper)
    settings.set.push_back({value.key, std::stod(value.text), Origin::job});
  for (JobSection& section : job.sheets)
    for (JobValue& value : section.values)
      if (value.key == "preset") value.text = preset_from(folder, value.text);
  for (const JobSection& section : job.sheets)
    settings.reading.overrides.push_back(override_of(NodeOverride::sheet, section));
  for (const JobSection& section : job.handles)
    settings.reading.overrides.push_back(override_of(NodeOverride::handle, section));
  settings.sheets = std::move(job.sheets);
  settings.handles = std::move(job.handles);
  if (settings.scene.empty())
    throw Error(ErrorCode::command, path.string(), "The key \"scene\" is missing.",
                "Write for instance scene = \"shot.glb\", from the folder of the job file.");
}

std::string sections_text(const BakeSettings& settings, const fs::path& folder) {
  return sections_text("sheet", sheet_keys(), settings.sheets, folder) +
         sections_text("handle", handle_keys(), settings.handles, folder);
}

std::string job_text(const BakeSettings& settings, const fs::path& file) {
  const fs::path folder = file.parent_path().empty() ? "." : file.parent_path();
  std::string text =
      "# A job: `paperbake bake " + file.filename().string() +
      "`. Paths are meant from the folder of this file; what the command line says wins.\n";
  for (const Option& option : options()) {
    if (!option.help.empty()) text += fmt::format("\n# {}\n", option.help);
    if (option.kind == JobKey::word) text += fmt::format("# ({})\n", fmt::join(option.words, ", "));
    text += option_text(settings, option, folder);
  }
  const Scene scene = read_scene(settings.scene, settings.reading);
  text += paper_text(settings, scene);
  text +=
      "\n# Sheets and handles by name: * and ? stand for letters. \"Handle_L.001\", "
      "\"ns:handle.l\" "
      "and \"handle-l\" are all met by \"handle.l\".\n"
      "# A value here has the meaning of the property paper_... of the node and wins over it; of "
      "two sections the later one.\n";
  text += sections_text(settings, folder);
  for (const SceneSheet& sheet : scene.sheets)
    if (!has_section(settings.sheets, sheet.name)) text += sheet_comment(settings, sheet, folder);
  for (const SceneSheet& sheet : scene.sheets)
    for (std::size_t h = 0; h < sheet.handles.size(); ++h)
      if (!has_section(settings.handles, sheet.handles[h].name))
        text += handle_comment(scene, sheet, h);
  return text;
}

}  // namespace paperbake
