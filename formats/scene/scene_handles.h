#pragma once

#include "formats/scene/scene_file.h"
#include "formats/scene/scene_nodes.h"

#include <string>
#include <vector>

namespace paperbake {

/// Finds the handles among the nodes and adds each to its sheet: the one named in paper_target,
/// else the nearest at the first frame. A handle is a node named handle... or with the property
/// paper_point (for bones: their head, or their tail, which is the origin of the child). Its
/// pattern point is the sheet point nearest to it at the first frame, moved to the border if within
/// 1e-5 of the sheet's longer side. It is released at paper_release_frame, else at the frame in
/// which its keyed scale falls below half.
/// throws Error(ErrorCode::scene): no handle, a name used twice, an invalid property, an unknown
/// target, a tail that is not in the file, a handle farther than one diagonal of the sheet from it,
/// a jump of more than 4 diagonals in one frame
void add_handles(const SceneNodes&, std::vector<SceneSheet>& sheets,
                 std::vector<std::string>& warnings);

}  // namespace paperbake
