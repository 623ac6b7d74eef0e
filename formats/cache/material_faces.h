#pragma once

#include "core/model/authored_surface.h"

#include <cstddef>
#include <vector>

namespace paperbake {

/// The faces that have a material.
/// material  index in surface.materials
inline std::vector<int> faces_of(const MeshSurface& surface, std::size_t material) {
  std::vector<int> faces;
  for (std::size_t t = 0; t < surface.material_of.size(); ++t)
    if (surface.material_of[t] == static_cast<int>(material)) faces.push_back(static_cast<int>(t));
  return faces;
}

}  // namespace paperbake
