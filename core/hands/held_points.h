#pragma once

#include "core/model/shot.h"

#include <vector>

namespace paperbake {

/// Numbers of the handles that hold the sheet in a frame.
std::vector<int> held_handles(const Shot&, int frame);

/// Whether held points are one point, or lie on a line, to within 1 % of the longer side. False if
/// there are none.
bool is_held_on_a_line(const Shot&, const std::vector<int>& held);

/// The direction, in space and in the first frame of the shot, of the line through the two of these
/// handles that are farthest from each other of all that include the first; 0: they are one point.
Vector3d held_line(const Shot&, const std::vector<int>& held);

/// Middle of these handles in the first frame of the shot. [m]
Vector3d held_middle(const Shot&, const std::vector<int>& held);

}  // namespace paperbake
