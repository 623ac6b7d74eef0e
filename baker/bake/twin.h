#pragma once

#include "baker/job/plan.h"
#include "baker/output/twin_verdict.h"
#include "core/geometry/pattern_samples.h"

#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace paperbake {

/// The twin of a bake (--twin) is the same simulation with handles, or sheets that no handle moves,
/// that are moved by a thousandth of a millimetre, less than any hand or file cares about. Where
/// its shape moves away, the scene does not determine the shape: it branches
/// (baker/output/twin_verdict.h).

/// The plan of the twin: every handle is moved on each axis by a random number of at most
/// twin_jitter, another one in each frame in which it moves. In the first frame, and where it
/// rests, nothing is changed. A sheet that no handle moves while it holds is displaced and tilted
/// by as much as a whole, with its handles: colliders, other sheets, weight and wind meet it in
/// another way.
BakePlan twin_of(const BakePlan&);

/// Where some hundred points of each sheet were in each frame.
class SampledShapes {
 public:
  explicit SampledShapes(const BakePlan&);
  void add(const AnimatedFrame&);
  /// RMS distance of the points from where they were added, in shares of the longer side.
  /// Nothing: that frame was not added.
  std::optional<double> distance(const AnimatedFrame&) const;

 private:
  struct SampledSheet {
    PatternSamples samples;
    double side;  // [m] the longer one
  };
  std::vector<SampledSheet> sheets_;
  std::map<std::pair<std::size_t, int>, Points3> shapes_;  // of a sheet in a frame
};

}  // namespace paperbake
