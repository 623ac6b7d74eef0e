#pragma once

#include "baker/job/plan.h"
#include "formats/files/certificate.h"

#include <string>
#include <vector>

namespace paperbake {

/// A frame in which a sheet moves as nothing makes it do: it has gone to another shape at once.
struct Leap {
  int frame = 0;
  std::string sheet;
  double moved = 0;       // [m] root mean square
  double around = 0;      // [m] the same in the frames that it is compared with, at most
  bool crumpled = false;  // the sheet has singular points by then
  bool inertia = false;   // it has inertia in this frame
  bool springs = false;   // from the shape in which it was modelled, and no handle drives it
};

/// The leaps of all sheets, in order of their frames. The sheet touches no other one, and no handle
/// lets go of it in this frame. It moves
///
/// - by more than 2 % of its longer side and farther than what drives it; and
/// - more than three times as far as in the frames beside it; where what drives it is faster than
///   there, as many times more.
///
/// A sheet without inertia moves only as it is driven, so those are the two frames before. With
/// inertia it gathers speed: there they are the frame before and the one after, as in the first
/// frame that moves.
///
/// frames  in order; several sheets may take turns
std::vector<Leap> find_leaps(const std::vector<FrameRecord>& frames, const BakePlan&);

/// One sentence with the longest of them, and how many there are. Empty: there is none. Crumpled
/// paper snaps from facet to facet: there nothing is said.
std::string describe(const std::vector<Leap>&);

}  // namespace paperbake
