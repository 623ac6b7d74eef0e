#include "formats/scene/scene_overrides.h"

#include "core/model/error.h"
#include "formats/scene/scene_properties.h"

#include <fmt/format.h>

#include <algorithm>

namespace paperbake {
namespace {

/// Wildcard matching without recursion: on a mismatch the last star takes one more character.
bool glob(const std::string& text, const std::string& pattern) {
  std::size_t t = 0, p = 0, star = std::string::npos, after = 0;
  while (t < text.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      after = t;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == text[t])) {
      ++p;
      ++t;
    } else if (star != std::string::npos) {
      p = star + 1;
      t = ++after;
    } else
      return false;
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

/// Whether a node is the leaf that exporters put at the tail of a bone: it is never a handle.
bool is_leaf_of_bone(const std::vector<ImportedNode>& nodes, const ImportedNode& node) {
  int parent = node.parent;
  while (parent >= 0 && nodes[parent].pivot) parent = nodes[parent].parent;
  return parent >= 0 && is_tail_leaf(node.name, nodes[parent].name);
}

bool is_candidate(const NodeOverride& section, const std::vector<ImportedNode>& nodes,
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

std::vector<AppliedOverrides> apply_overrides(ImportedFile& file,
                                              const std::vector<NodeOverride>& sections) {
  std::vector<AppliedOverrides> applied(file.nodes.size());
  for (const NodeOverride& section : sections) {
    std::vector<std::size_t> candidates, matched;
    for (std::size_t i = 0; i < file.nodes.size(); ++i)
      if (is_candidate(section, file.nodes, file.nodes[i])) candidates.push_back(i);
    for (const std::size_t i : candidates)
      if (file.nodes[i].name == section.pattern) matched.push_back(i);
    if (matched.empty())
      for (const std::size_t i : candidates)
        if (name_is_like(file.nodes[i].name, section.pattern)) matched.push_back(i);
    if (matched.empty()) {
      const char* kind = section.kind == NodeOverride::sheet ? "sheet" : "handle";
      constexpr std::size_t max_listed = 12;
      std::vector<std::string> names;
      for (const std::size_t i : candidates)
        if (names.size() < max_listed) names.push_back('"' + file.nodes[i].name + '"');
      if (candidates.size() > max_listed)
        names.push_back(fmt::format("{} more", candidates.size() - max_listed));
      throw Error(ErrorCode::command, section.place,
                  fmt::format("No {} of the scene has a name like \"{}\".", kind, section.pattern),
                  names.empty() ? fmt::format("The scene has no {}.", kind)
                                : fmt::format("The {}s are: {}.", kind, fmt::join(names, ", ")));
    }
    for (const std::size_t i : matched) {
      auto& properties = file.nodes[i].properties;
      if (section.properties.count("paper_preset")) {
        properties.erase("paper_gsm");
        properties.erase("paper_thickness");
      }
      for (const auto& [key, value] : section.properties) {
        properties[key] = value;
        applied[i].places[key] = section.place;
      }
      applied[i].singular_point_rules.append(section.singular_point_rules);
      applied[i].creases.insert(applied[i].creases.end(), section.creases.begin(),
                                section.creases.end());
      applied[i].rules_place = section.place;
    }
  }
  return applied;
}

}  // namespace paperbake
