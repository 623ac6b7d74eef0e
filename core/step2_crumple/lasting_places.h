#pragma once

#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

class Serializer;

/// How far the sheet has been deformed while something was seen around a place of its pattern. It
/// is followed by its place, and so across changes of the mesh.
class LastingPlaces {
 public:
  struct Seen {
    Vector2d p;    // [m] on the pattern
    double reach;  // [m] within which something seen before was the same
  };
  /// Tells what is seen now; what is not seen any more is forgotten.
  /// travel       [1] by which the sheet has been deformed since the last call, of the longer side
  /// returns  [1] the travel for which each has been seen, this one included
  std::vector<double> see(const std::vector<Seen>&, double travel);

  /// What was seen last. [m] on the pattern
  std::vector<Vector2d> places() const;
  void forget() { seen_.clear(); }
  void archive(Serializer&);

 private:
  struct Place {
    Vector2d p;
    double travel;
  };
  std::vector<Place> seen_;
};

}  // namespace paperbake
