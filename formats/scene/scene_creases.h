#pragma once

#include "formats/scene/scene_nodes.h"

#include <string>
#include <vector>

namespace paperbake {

/// Adds to the sheets the folds that they have from the start, behind those of a job file: edges
/// that are marked in the mesh of the sheet (edge creases of FBX, edges without faces), and the
/// edges of meshes named crease... or with paper_crease, which lie on a sheet: the one in
/// paper_target, else the nearest. paper_crease, there or on the sheet: the angle that they spring
/// back to [degrees], else 0. Edges along the border are left out. The file's edges become
/// polylines on the pattern, broken where they branch. throws Error(Fault::scene) at the mesh: it
/// is more than 1 mm off its sheet, leaves it, has no edges or too many, an angle beyond 170
void add_creases(const SceneNodes&, std::vector<SceneSheet>&, std::vector<std::string>& warnings);

}  // namespace paperbake
