#pragma once

#include "core/sheet.h"

#include <map>
#include <string>
#include <vector>

namespace paperbake {

/// The sheets of a scene beside each other. They do not feel each other; where one passes through another, that is to be known.
class SheetsTogether {
 public:
  /// Takes a sheet of a frame, after all frames of those before it in the scene.
  /// returns  pairs of its triangles and theirs that pass through each other
  int add(const std::string& name, int frame, const Sheet&);

 private:
  struct Placed {
    std::string name;
    Points3 x;
    Triangles triangles;
  };
  std::map<int, std::vector<Placed>> placed_;  // by frame
};

}  // namespace paperbake
