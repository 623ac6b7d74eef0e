#include "formats/config/lock_file.h"

#include "core/model/error.h"
#include "formats/config/preset_file.h"
#include "formats/config/toml_document.h"

#include <fmt/format.h>

#include <cmath>

namespace paperbake {
namespace {

template <class T>
T value_of(const toml::table& table, const char* key, const std::string& place) {
  const auto value = table[key].template value<T>();
  if (!value)
    throw Error(ErrorCode::command, place, fmt::format("The key \"{}\" is missing.", key),
                "Bake again: this version of paperbake did not write this file.");
  return *value;
}

const toml::table& table_of(const toml::table& root, const char* key, const std::string& place) {
  const toml::table* table = root[key].as_table();
  if (!table)
    throw Error(ErrorCode::command, place, fmt::format("The table [{}] is missing.", key),
                "Bake again: this version of paperbake did not write this file.");
  return *table;
}

Paper paper_of(const toml::table& table, const std::string& place) {
  Paper paper;
  paper.name = value_of<std::string>(table, "preset", place);
  for (const PaperParameter& parameter : paper_parameters) {
    if (!parameter.required && !table.contains(parameter.key)) continue;
    const double value = value_of<double>(table, parameter.key, place);
    if (!parameter.accepts(value))
      throw Error(ErrorCode::command, place, out_of_bounds(parameter, value));
    parameter.set(paper, value);
  }
  return paper;
}

}  // namespace

LockedJob read_lock(const std::filesystem::path& path) {
  const TomlDocument document = parse_toml(path.string(), read_toml_text(path, "lock"));
  const toml::table& root = document.root;
  LockedJob job;
  const toml::table& bake = table_of(root, "bake", path.string());
  job.method = value_of<std::string>(bake, "method", path.string());
  job.gravity = value_of<double>(bake, "gravity", path.string());
  job.stop = value_of<double>(bake, "stop", path.string());
  job.fps = value_of<double>(table_of(root, "scene", path.string()), "fps", path.string());
  if (!(job.fps > 0) || !std::isfinite(job.fps) || !std::isfinite(job.gravity) || !(job.stop > 0))
    throw Error(
        ErrorCode::command, path.string(),
        fmt::format(
            "{} frames per second, a gravity of {} m/s2 and a stop of {} m cannot be right.",
            job.fps, job.gravity, job.stop));
  for (const auto& [sheet, node] : table_of(root, "paper", path.string()))
    if (const toml::table* table = node.as_table())
      job.papers[std::string(sheet.str())] =
          paper_of(*table, fmt::format("{}, sheet \"{}\"", path.string(), sheet.str()));
  return job;
}

}  // namespace paperbake
