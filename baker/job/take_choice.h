#pragma once

#include <string>
#include <vector>

namespace paperbake {

/// One way to simulate a shot that was tried (baker/bake/takes.h).
struct TriedTake {
  unsigned seed_offset = 0;  // that is added to the seed of every sheet
  int base_triangles = 0;
  // as far as it was simulated: how far a handle is off at most, and where
  double off = 0;      // [m]
  double off_pct = 0;  // [% of the longer side of its sheet], by which takes are compared
  int frame = 0;
  int frames = 0;  // that were simulated
};

/// Which take of a shot is baked, and which were tried.
struct TakeChoice {
  std::size_t baked = 0;  // index into tried
  std::vector<TriedTake> tried;
};

/// One sentence on it.
std::string describe(const TakeChoice&);

}  // namespace paperbake
