#pragma once

#include "formats/scene/scene_nodes.h"

#include <string>
#include <vector>

namespace paperbake {

/// Adds to the sheets the prescribed creases that the scene defines, after those of a job file:
///
/// - marked edges in the mesh of a sheet (edge creases of FBX, edges without faces);
/// - edges of meshes that are named crease... or have paper_crease. They must lie on the sheet
///   named in paper_target, else on the nearest one.
///
/// The property paper_crease of the mesh or the sheet is the rest angle [degrees], default 0; with
/// "modelled", each crease has the angle by which the sheet is folded there at the first frame. The
/// edges are joined to polylines on the pattern, which end where edges branch; edges along the
/// border are left out.
/// throws Error(ErrorCode::scene) at a mesh that is more than 1 mm off its sheet, leaves it, has no
/// edges or too many, or has an angle beyond 170 degrees
void add_creases(const SceneNodes&, std::vector<SceneSheet>&, std::vector<std::string>& warnings);

}  // namespace paperbake
