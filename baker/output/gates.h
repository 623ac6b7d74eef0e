#pragma once

#include "baker/job/plan.h"
#include "baker/job/tolerances.h"
#include "formats/files/certificate.h"

#include <string>
#include <vector>

namespace paperbake {

/// Limits that a bake must keep to end with exit code 0. The simulated mesh is judged by them, and
/// so is the mesh that is handed on.
struct Gates {
  double mean_stretch_pct = 100 * mean_stretch_tolerance;  // c_m of any frame
  double max_stretch_pct = 5;                              // any edge of any frame
  double handle_err_mm = 1e3 * handle_tolerance;
  // As thick as copy paper: a sheet that is that deep in a collider has vanished in it with both of
  // its faces. It is twice the depth that the solver lets pass, and a pixel where A4 fills an image
  // 3,000 pixels high.
  double inside_mm = 0.1;
};

/// What a gate is about.
enum class Gate { lengths, handles, crossings, colliders, reach };

struct MissedGate {
  Gate gate;
  std::string sentence;  // with its worst frame and, for handles, the cause where it is known
  // what to do about it; empty where a gate before it has the same
  std::string advice;
  int frames = 0;                  // in how many it is missed
  bool only_of_rendering = false;  // the simulated sheet keeps it
  std::string sheet = {};          // of its worst frame
};

/// The gates that were missed, the one that is missed in most frames first. Empty: none was.
std::vector<MissedGate> missed_gates(const Gates&, const std::vector<FrameRecord>&,
                                     const BakePlan&);

/// Whether only its weight, its speed or the air can have pulled a sheet off a handle in a
/// frame: a sheet with inertia that touches nothing and has no singular points. One that a single
/// handle holds may have them and touch itself: nothing pulls the other way.
/// singular  how many singular points it has
/// held      how many handles hold it
bool is_pulled(const FrameStatistics&, int singular, int held);

/// A sentence about the frames in which the solver gave up; empty: there are none. That of the gate
/// of handles contains it.
std::string describe_unsolved(const std::vector<FrameRecord>&);

/// A sentence about the frames whose steps did not converge although the sheet moved on, in two or
/// more frames one after the other; empty: there are none. Crumpled paper snaps all the time:
/// sheets with singular points do not count.
std::string describe_unsettled(const std::vector<FrameRecord>&);

/// What is good about a bake, in words for an artist: of everything that gates judge and that none
/// of the missed ones is about.
std::vector<std::string> good_news(const std::vector<FrameRecord>&,
                                   const std::vector<MissedGate>& missed);

/// The sentences with their advice, as people read them in a log.
std::vector<std::string> with_advice(const std::vector<MissedGate>&);

}  // namespace paperbake
