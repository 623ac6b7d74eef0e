#pragma once

#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// The crease network of a crumpled sheet, measured on its mesh. A crease is a chain of edges with
/// dihedral angles over 20 degrees, from one singular point, junction or end to the next.
struct CreaseNetwork {
  double length = 0;            // [m] total length of the creases on the pattern
  double count = 0;             // [1] half the number of their ends; a closed crease counts 0
  std::vector<double> creases;  // [m] length of each crease that has ends
  double mean() const { return length / (count > 1 ? count : 1); }  // [m] mean length
};
CreaseNetwork crease_network(const Sheet&);

}  // namespace paperbake
