#pragma once

#include "core/model/sheet.h"

#include <map>
#include <vector>

namespace paperbake {

/// The sheets of a scene beside each other, as they are handed on: where one passes through
/// another, that is to be known.
class SheetIntersections {
 public:
  /// Takes a sheet of a frame, after those before it in the scene. Its positions are rounded as a
  /// cache rounds them.
  /// returns  pairs of its triangles and theirs that pass through each other
  int add(int frame, const Sheet&);

 private:
  struct PlacedSheet {
    Points3 x;
    Triangles triangles;
  };
  std::map<int, std::vector<PlacedSheet>> placed_;  // by frame
};

}  // namespace paperbake
