#pragma once

#include "core/model/singular_point_rules.h"
#include "formats/scene/scene_import.h"

#include <map>
#include <string>
#include <vector>

namespace paperbake {

/// Properties that a job file gives to the sheets or handles of a scene whose name is like a
/// pattern.
struct NodeOverride {
  enum Kind { sheet, handle } kind;
  // one full name, or * and ? for letters and names as matched_name sees them
  std::string pattern;
  std::string place;                                // job.toml:12:1
  std::map<std::string, PropertyValue> properties;  // paper_mode, ...
  Pins pins = {};                                   // of sheets
  std::vector<FoldLine> creases = {};
};

/// Does that pattern mean this name? "GRIP*" and "rig:grip_left.001": yes
bool name_is_like(const std::string& name, const std::string& pattern);

/// What one node has from overrides.
struct AppliedOverrides {
  std::map<std::string, std::string> places;  // by property
  Pins pins;                                  // of all sections that mean it ...
  std::vector<FoldLine> creases;
  std::string pins_place;  // ... and the last of them
};

/// Gives the nodes their properties; a later override wins. A paper_preset takes away what the
/// scene says of the paper; with paper_point any node that is no mesh becomes a handle, as in the
/// DCC.
/// returns  of each node
/// throws Error(Fault::command): nothing is named so, with what there is
std::vector<AppliedOverrides> apply_overrides(ImportedFile&, const std::vector<NodeOverride>&);

}  // namespace paperbake
