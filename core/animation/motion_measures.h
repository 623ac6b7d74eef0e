#pragma once

#include "core/step1_elastic/elastic.h"

#include <vector>

namespace paperbake {

/// How far the sheet is from rest: the largest move of a handle that is asked for, of a collider,
/// or of a vertex in the last step. [m]
double unrest(const Sheet& sheet, const Held& held, const Held& held_before, const Points3& before,
              const Colliders* colliders);

/// Vertices that a handle is about to move while no other point of the sheet is held near by.
std::vector<int> pulled_alone(const Sheet& sheet, const Held& held, double least_move,
                              double apart);

/// How far held points are asked to go against each other since the frame before. [m]
double leap_of(const Sheet& sheet, const Held& held, const Held& held_before);

}  // namespace paperbake
