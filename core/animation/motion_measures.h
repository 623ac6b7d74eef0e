#pragma once

#include "core/step1_elastic/elastic.h"

#include <vector>

namespace paperbake {

/// How far the sheet is from rest: the largest move of a handle that is asked for, of a collider,
/// or of a vertex in the last step. [m]
double max_displacement(const Sheet& sheet, const PositionConstraints& held,
                        const PositionConstraints& held_before, const Points3& before,
                        const Colliders* colliders);

/// Vertices that a handle is about to move while no other point of the sheet is held near by.
std::vector<int> isolated_moving_handles(const Sheet& sheet, const PositionConstraints& held,
                                         double min_move, double apart);

/// How far held points are asked to go against each other since the frame before. [m]
double relative_handle_motion(const Sheet& sheet, const PositionConstraints& held,
                              const PositionConstraints& held_before);

}  // namespace paperbake
