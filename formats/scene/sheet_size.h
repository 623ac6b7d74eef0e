#pragma once

#include "formats/scene/scene_nodes.h"

#include <string>
#include <vector>

namespace paperbake {

/// Checks the size of a sheet, by which a wrong unit of the file is found. Warns where a sheet is
/// larger than any that is sold, and neither the options nor paper_size of the node confirm it.
/// size    [m] of the pattern
/// throws  Error(ErrorCode::scene) for a size that no sheet has, unless the options give the unit,
///         and for one that differs from paper_size by more than 1 %; with the units in which the
///         sheet would have a usual size
void check_size(const SceneNodes&, const ImportedNode&, const Vector2d& size, const SceneOptions&,
                std::vector<std::string>& warnings);

}  // namespace paperbake
