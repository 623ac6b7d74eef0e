#pragma once

#include "core/animation/animate.h"

#include <string>
#include <vector>

namespace paperbake::bench {

/// What should not matter to a sheet whose handles move slowly: how the way is cut into steps, how
/// long it takes, and which mesh it began on.
struct Change {
  const char* name;
  double pace;      // [frames] of the scene in one step
  double slowness;  // [1] how many times longer the handles take for their way
  double turn;      // [rad] of the first mesh's lattice
  unsigned ripple;  // seed of what lets a flat sheet choose a side
};

/// The shot as it was, and under each of the changes.
const std::vector<Change>& changes();

/// The shot in steps of `pace` frames, handles in between on straight lines: its frame F is frame F
/// x pace of the shot.
Shot paced(Shot, double pace);

/// Points of the pattern (41 x 41) at the frames of the shot that every change has: each fourth.
struct Shapes {
  std::vector<Points3> frames;
  int births = 0;
};
using MakeMethod = std::function<Method(const Shot&, double turn)>;
Shapes shapes_of(const Shot&, const MakeMethod&, const Change&, double gravity, double fps,
                 int last_frame);

/// Distance of the points, mean over the frames. [% of the longer side]
double apart_pct(const Shapes&, const Shapes&, const Pattern&);

}  // namespace paperbake::bench
