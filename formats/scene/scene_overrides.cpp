#include "formats/scene/scene_overrides.h"

#include "core/model/error.h"
#include "formats/scene/scene_properties.h"

#include <fmt/format.h>

#include <algorithm>

namespace paperbake {
namespace {

/// Wildcards in linear memory: on a mismatch back to the last star, one letter on.
bool glob(const std::string& text, const std::string& pattern) {
  std::size_t t = 0, p = 0, star = std::string::npos, after = 0;
  while (t < text.size()) {
    if (p < pattern.size() && pattern[p] == '*')
      star = p++, after = t;
    else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == text[t]))
      ++p, ++t;
    else if (star != std::string::npos)
      p = star + 1, t = ++after;
    else
      return false;
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

/// The leaf that an exporter puts at a bone's end is no handle, whatever its name.
bool is_leaf_of_bone(const std::vector<ImportedNode>& nodes, const ImportedNode& node) {
  int parent = node.parent;
  while (parent >= 0 && nodes[parent].pivot) parent = nodes[parent].parent;
  return parent >= 0 && is_tail_leaf(node.name, nodes[parent].name);
}

bool may_be(const NodeOverride& section, const std::vector<ImportedNode>& nodes,
            const ImportedNode& node) {
  if (node.pivot) return false;
  if (section.kind == NodeOverride::sheet)
    return !node.meshes.empty() && name_begins_with(node.name, "paper");
  if (node.properties.count("paper_point")) return true;
  if (is_leaf_of_bone(nodes, node)) return false;
  return name_begins_with(node.name, "handle") ||
         (section.properties.count("paper_point") && node.meshes.empty());
}

}  // namespace

bool name_is_like(const std::string& name, const std::string& pattern) {
  return name == pattern || glob(matched_name(name), matched_name(pattern));
}

std::vector<Overridden> apply_overrides(ImportedFile& file,
                                        const std::vector<NodeOverride>& sections) {
  std::vector<Overridden> given(file.nodes.size());
  for (const NodeOverride& section : sections) {
    std::vector<std::size_t> there, meant;
    for (std::size_t i = 0; i < file.nodes.size(); ++i)
      if (may_be(section, file.nodes, file.nodes[i])) there.push_back(i);
    for (const std::size_t i : there)
      if (file.nodes[i].name == section.pattern) meant.push_back(i);
    if (meant.empty())
      for (const std::size_t i : there)
        if (name_is_like(file.nodes[i].name, section.pattern)) meant.push_back(i);
    if (meant.empty()) {
      const char* kind = section.kind == NodeOverride::sheet ? "sheet" : "handle";
      constexpr std::size_t most = 12;
      std::vector<std::string> names;
      for (const std::size_t i : there)
        if (names.size() < most) names.push_back('"' + file.nodes[i].name + '"');
      if (there.size() > most) names.push_back(fmt::format("{} more", there.size() - most));
      throw Error(Fault::command, section.place,
                  fmt::format("No {} of the scene has a name like \"{}\".", kind, section.pattern),
                  names.empty() ? fmt::format("There is no {}.", kind)
                                : fmt::format("The {}s are: {}.", kind, fmt::join(names, ", ")));
    }
    for (const std::size_t i : meant) {
      auto& properties = file.nodes[i].properties;
      if (section.properties.count("paper_preset"))
        properties.erase("paper_gsm"), properties.erase("paper_thickness");
      for (const auto& [key, value] : section.properties)
        properties[key] = value, given[i].places[key] = section.place;
      given[i].pins.append(section.pins);
      given[i].creases.insert(given[i].creases.end(), section.creases.begin(),
                              section.creases.end());
      given[i].pins_place = section.place;
    }
  }
  return given;
}

}  // namespace paperbake
