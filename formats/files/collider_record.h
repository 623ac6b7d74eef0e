#pragma once

#include "core/geometry/collider.h"

#include <map>
#include <string>
#include <vector>

namespace paperbake {

/// The colliders of a bake, as far as whoever judges its cache afterwards needs them.
struct ColliderRecord {
  int first_frame = 1;  // of the motions
  // of each sheet, by its name: the front of an open mesh is where that sheet was at the start
  std::map<std::string, std::vector<ColliderMesh>> of_sheet;
};

/// One JSON object: `first_frame`, `colliders` as a list of {name, vertices (m), triangles,
/// frames}, `turned`: for each sheet the numbers of the colliders whose triangles run the other way
/// round for it, and `inside_of`: likewise the closed ones that it stays inside. `frames` has an
/// entry for every frame, and none where the collider stands still: {turn, shift}, the 3 x 3 matrix
/// and the vector [m] of x -> turn x + shift, where that takes all vertices of the collider to
/// within 0.1 um; otherwise x, y and z of all vertices, one after the other, in metres. All numbers
/// read back as the same doubles.
std::string collider_json(const ColliderRecord&);

/// Reads the text of collider_json. throws Error(ErrorCode::scene) when it is not one
ColliderRecord parse_collider_json(const std::string& text);

}  // namespace paperbake
