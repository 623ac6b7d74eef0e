#pragma once

#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// The parts into which a mesh falls: vertices are in one part if triangles connect them.
/// returns  for each of the vertices, the lowest one of its part
std::vector<int> connected_parts(const Triangles&, Eigen::Index vertices);

}  // namespace paperbake
