#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace paperbake {

/// Why other attempts at a shot than the first are simulated (baker/bake/attempts.h).
/// handle_off  a handle of the first one is off by more than the gate of handles allows
/// crumpled    its sheet gets singular points, and might not on a finer mesh
/// coarse      its mesh puts the smooth sheet off visibly
enum class AttemptReason { handle_off, crumpled, coarse };
/// The word for it in files.
const char* name_of(AttemptReason);

/// One way to simulate a shot that was tried (baker/bake/attempts.h).
struct Attempt {
  std::size_t number = 0;    // from which its seed and mesh follow, 0 is the first (Attempts)
  unsigned seed_offset = 0;  // that is added to the seed of every sheet
  int base_triangles = 0;
  // As far as it was simulated: how far a handle is off at most, without what paper cannot reach.
  double off = 0;      // [m]
  double off_pct = 0;  // [% of the longer side of its sheet]
  int frame = 0;       // in which it is
  // [m] the same where the sheet is pulled off its handles, which does not count as off
  double pulled = 0;
  double inside = 0;  // [m] how deep a sheet gets into a collider at most
  int frames = 0;     // that were simulated
  // of the first: its triangles are too coarse (BendWatch::is_coarse); of a finer one, at its end:
  // it is creased (BendWatch::is_creased)
  bool coarse = false;
  int points = 0;  // singular points that were born in a sheet, at most
};

/// Half a sentence on why an attempt is doubted although its handles hold: its singular points, or
/// if it has none, its coarse triangles.
std::string why_doubted(const Attempt&);

/// Which attempt of a shot is baked, and which were tried.
struct AttemptChoice {
  // of the longer side: what is off by more never ends well
  static constexpr double hopeless_pct = 10;

  AttemptReason reason = AttemptReason::handle_off;
  std::size_t baked = 0;  // index into tried
  // all were off by a tenth of the sheet or more before the end of the shot, or failed
  bool hopeless = false;
  std::vector<Attempt> tried;
};

/// One sentence on it.
std::string describe(const AttemptChoice&);

}  // namespace paperbake
