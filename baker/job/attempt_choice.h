#pragma once

#include <string>
#include <vector>

namespace paperbake {

/// One way to simulate a shot that was tried (baker/bake/attempts.h).
struct Attempt {
  unsigned seed_offset = 0;  // that is added to the seed of every sheet
  int base_triangles = 0;
  // As far as it was simulated: how far a handle is off at most, without what paper cannot reach.
  double off = 0;      // [m] by which attempts are compared
  double off_pct = 0;  // [% of the longer side of its sheet]
  int frame = 0;       // in which it is
  int frames = 0;      // that were simulated
};

/// Which attempt of a shot is baked, and which were tried.
struct AttemptChoice {
  // of the longer side: what is off by more never ends well
  static constexpr double hopeless_pct = 10;

  std::size_t baked = 0;  // index into tried
  // all were off by a tenth of the sheet or more before the end of the shot, or failed
  bool hopeless = false;
  std::vector<Attempt> tried;
};

/// One sentence on it.
std::string describe(const AttemptChoice&);

}  // namespace paperbake
