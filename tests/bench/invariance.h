#pragma once

#include "core/animation/animate.h"

#include <string>
#include <vector>

namespace paperbake::bench {

/// What should not matter to a sheet whose handles move slowly: into how many steps the motion is
/// divided, how long it takes, and on which mesh it begins.
struct Change {
  const char* name;
  double pace;      // [frames] of the scene in one step
  double slowness;  // [1] how many times as long the handles take
  double turn;      // [rad] rotation of the lattice of the first mesh
  unsigned ripple;  // seed of the imperfection that lets a flat sheet buckle
};

/// The shot as it is, then each of the changes.
const std::vector<Change>& changes();

/// The shot in steps of `pace` frames, with handles on straight lines in between: its frame F is
/// frame F x pace of the shot.
Shot paced(Shot, double pace);

/// Points of the pattern (41 x 41) at those frames of the shot that exist under every change: every
/// fourth.
struct Shapes {
  std::vector<Points3> frames;
  int births = 0;
};
using MakeMethod = std::function<MethodChoice(const Shot&, double turn)>;
Shapes shapes_of(const Shot&, const MakeMethod&, const Change&, double gravity, double fps,
                 int last_frame);

/// RMS distance of the points, mean over the frames. [% of the longer side]
double apart_pct(const Shapes&, const Shapes&, const Pattern&);

}  // namespace paperbake::bench
