#pragma once

#include "formats/files/json.h"
#include "formats/scene/scene_file.h"

#include <algorithm>
#include <string>
#include <vector>

namespace paperbake {

/// A collider of the scene as the bake will see it.
struct InspectedCollider {
  struct Beside {
    std::string sheet;
    bool holds;       // the sheet stays inside the collider
    double distance;  // [m] least in the first frame; negative: the sheet begins in the collider
  };
  const ColliderMesh* mesh;
  bool closed;
  const char* motion;
  Vector3d size;  // [m] of its box in the first frame
  std::vector<Beside> sheets;

  const Beside& nearest() const {
    return *std::min_element(sheets.begin(), sheets.end(), [](const Beside& a, const Beside& b) {
      return a.distance < b.distance;
    });
  }
};

/// The colliders of a scene, in its order. They refer to the scene, which must outlive them.
std::vector<InspectedCollider> inspected_colliders(const Scene&);

/// One line for people, with its end.
std::string collider_text(const InspectedCollider&);
Json collider_json(const InspectedCollider&);

}  // namespace paperbake
