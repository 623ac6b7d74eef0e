#pragma once

#include "formats/scene/scene_file.h"
#include "formats/scene/scene_nodes.h"

#include <string>
#include <vector>

namespace paperbake {

/// Finds the handles among the nodes and gives each to its sheet: that of paper_target, else the
/// nearest at the first frame. A handle is a node named `handle...` or one with the property
/// paper_point (a bone; its head, or its tail = where its child begins). Its pattern point is the
/// sheet point nearest to it at the first frame, on the border when within 1e-5 of the sheet's
/// longer side. Released at paper_release_frame, else from the frame its scale falls under half.
/// throws Error(Fault::scene): no handle, a name twice, a bad property, an unknown target, a tail
/// that cannot be known, a handle farther than one diagonal from its sheet, a jump of more than 4
/// diagonals in one frame
void add_handles(const SceneNodes&, std::vector<SceneSheet>& sheets,
                 std::vector<std::string>& warnings);

}  // namespace paperbake
