#pragma once

#include "formats/scene/scene_file.h"
#include "formats/scene/scene_nodes.h"
#include "formats/scene/scene_overrides.h"

#include <string>
#include <vector>

namespace paperbake {

/// The sheets of a scene, without creases that are drawn as nodes and without handles: every mesh
/// whose name begins with "paper".
/// overrides  of each node
/// Bones and blend shapes give a sheet the shape with which it starts, at the first frame.
/// throws     Error(ErrorCode::scene): no sheet, two of one name, a size that no sheet has, a mesh
///            that cannot be laid flat. A mesh whose name goes on as a word, such as "Paperclip",
///            is left out with a warning if it is no sheet.
std::vector<SceneSheet> read_sheets(const SceneNodes&, const SceneOptions&,
                                    const std::vector<AppliedOverrides>& overrides,
                                    std::vector<std::string>& warnings);

/// Warns of sheets that are keyed themselves, or go on to be deformed: only handles move a sheet.
void warn_of_keyed_sheets(const SceneNodes&, std::vector<std::string>& warnings);

}  // namespace paperbake
