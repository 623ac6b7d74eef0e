#pragma once

#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// A straight line from border to border along which a sheet is being folded.
struct FoldLine {
  Vector2d a, b;          // [m] ends on the border
  double plastic_turn;    // [rad] mean over its length; > 0 bulges towards the normals
  std::vector<int> band;  // triangles that have yielded along it
};

}  // namespace paperbake
