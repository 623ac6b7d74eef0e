#pragma once

#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// The creases of a crumpled sheet, counted by its mesh. A crease is a chain of edges folded by
/// more than 20 degrees, from one singular point, junction or end to the next.
struct CreaseNetwork {
  double length = 0;            // [m] of all creases, on the pattern
  double count = 0;             // half their ends; a closed one has none
  std::vector<double> creases;  // [m] of each that has ends
  double mean() const { return length / (count > 1 ? count : 1); }  // [m]
};
CreaseNetwork crease_network(const Sheet&);

}  // namespace paperbake
