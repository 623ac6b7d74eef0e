#include "formats/lock_file.h"

#include "core/error.h"
#include "formats/preset_file.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <fstream>
#include <iterator>

namespace paperbake {
namespace {

template <class T>
T value_of(const toml::table& table, const char* key, const std::string& place) {
  const auto value = table[key].template value<T>();
  if (!value) throw Error(Fault::command, place, fmt::format("It has no \"{}\".", key), "Bake again: the file is not one that this version writes.");
  return *value;
}

const toml::table& table_of(const toml::table& root, const char* key, const std::string& place) {
  const toml::table* table = root[key].as_table();
  if (!table) throw Error(Fault::command, place, fmt::format("It has no table [{}].", key), "Bake again: the file is not one that this version writes.");
  return *table;
}

Paper paper_of(const toml::table& table, const std::string& place) {
  Paper paper;
  paper.name = value_of<std::string>(table, "preset", place);
  for (const PaperQuantity& quantity : paper_quantities())
    if (quantity.required || table.contains(quantity.key)) quantity.set(paper, value_of<double>(table, quantity.key, place));
  return paper;
}

}  // namespace

LockedJob read_lock(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(Fault::command, path.string(), "There is no such file, or it cannot be read.", "Name the output folder of a bake.");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  toml::table root;
  try {
    root = toml::parse(text);
  } catch (const toml::parse_error& error) {
    throw Error(Fault::command, fmt::format("{}:{}:{}", path.string(), error.source().begin.line, error.source().begin.column), std::string(error.description()) + ".");
  }
  LockedJob job;
  const toml::table& bake = table_of(root, "bake", path.string());
  job.method = value_of<std::string>(bake, "method", path.string());
  job.gravity = value_of<double>(bake, "gravity", path.string());
  job.stop = value_of<double>(bake, "stop", path.string());
  job.fps = value_of<double>(table_of(root, "scene", path.string()), "fps", path.string());
  for (const auto& [sheet, node] : table_of(root, "paper", path.string()))
    if (const toml::table* table = node.as_table()) job.papers[std::string(sheet.str())] = paper_of(*table, fmt::format("{}, sheet \"{}\"", path.string(), sheet.str()));
  return job;
}

}  // namespace paperbake
