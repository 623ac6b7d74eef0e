#pragma once

#include "core/model/singular_point_rules.h"
#include "formats/scene/scene_import.h"

#include <map>
#include <string>
#include <vector>

namespace paperbake {

/// A section of a job file: properties for the sheets or handles whose names match a pattern.
struct NodeOverride {
  enum Kind { sheet, handle } kind;
  // the full name of one node, or a pattern for names as matched_name returns them: * stands for
  // any characters, ? for one
  std::string pattern;
  std::string place;                                // job.toml:12:1
  std::map<std::string, PropertyValue> properties;  // by full name: paper_mode, ...
  SingularPointRules singular_point_rules = {};     // of sheets
  std::vector<PrescribedCrease> creases = {};
};

/// Whether a name matches a pattern: "rig:grip_left.001" matches "GRIP*".
bool name_is_like(const std::string& name, const std::string& pattern);

/// What the overrides have changed at one node.
struct AppliedOverrides {
  std::map<std::string, std::string> places;  // place of each property in the job file
  // of all sections that match the node ...
  SingularPointRules singular_point_rules;
  std::vector<PrescribedCrease> creases;
  std::string rules_place;  // ... and the place of the last of these sections
};

/// Sets the properties of the nodes that match; a later override wins. paper_preset removes
/// paper_gsm and paper_thickness of the scene; paper_point makes any matching node without a mesh a
/// handle, as it does in the DCC.
/// returns  what was changed, for each node
/// throws   Error(ErrorCode::command) when no node matches, with the names that there are
std::vector<AppliedOverrides> apply_overrides(ImportedFile&, const std::vector<NodeOverride>&);

}  // namespace paperbake
