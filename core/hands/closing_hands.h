#pragma once

#include "core/model/shot.h"

#include <vector>

namespace paperbake {

/// Points of the pattern halfway between the handles of a hand that closes: of three handles or
/// more that stand near each other and all come nearer, as the fingertips of a fist. On a coarse
/// mesh an edge would run from one handle to the next, and paper could only be compressed there;
/// with a vertex between them it can bend out of their way. [m]
std::vector<Vector2d> points_in_closing_hands(const Shot&);

}  // namespace paperbake
