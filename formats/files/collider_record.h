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
/// motion}, and `turned`: for each sheet the numbers of the colliders whose triangles run the other
/// way round for it. A motion has twelve numbers for every frame: the rows of the rotation, each
/// followed by a coordinate of the translation in metres. All numbers read back as the same
/// doubles.
std::string collider_json(const ColliderRecord&);

/// Reads the text of collider_json. throws Error(ErrorCode::scene) when it is not one
ColliderRecord parse_collider_json(const std::string& text);

}  // namespace paperbake
