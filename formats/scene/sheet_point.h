#pragma once

#include "formats/scene/scene_nodes.h"

#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace paperbake {

/// A point of a sheet, and its distance from a given point in the world.
struct SheetPoint {
  Vector2d pattern = Vector2d::Zero();                        // [m]
  double distance = std::numeric_limits<double>::infinity();  // [m]
};

/// The point of the sheet that is nearest to p [m].
SheetPoint nearest_point(const Sheet&, const Vector3d& p);

/// Index of the sheet that a node names in paper_target; nothing without that property.
/// throws Error(ErrorCode::scene) at `place` when there is no such sheet
std::optional<std::size_t> target_sheet(const SceneNodes&, const std::vector<SceneSheet>&, int node,
                                        const std::string& place);

}  // namespace paperbake
