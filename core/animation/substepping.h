#pragma once

#include "core/step1_elastic/elastic.h"

#include <string>
#include <vector>

namespace paperbake {

/// The elastic step of one frame, in halves where a whole one fails.
struct FrameStepResult {
  int substeps = 0, iterations = 0;
  bool converged = true;
  ElasticReport last;
  // why the sheets cannot follow; then they are where they were, and so is all that is known of
  // them
  std::string failure_reason = {};
};

/// A place of a sheet on its way through a frame.
struct TrajectoryPoint {
  double at;  // [1] share of the frame
  Points3 x;  // |V|x3 [m]
};

/// A sheet that is to follow its handles.
struct SubstepTarget {
  Elastic& elastic;
  Sheet& sheet;
  PositionConstraints held;  // where the frame ends
  // [1] of the longer side: how far the handles go against each other
  double relative_motion;
  double side;                               // [m] the longer one
  std::vector<TrajectoryPoint>* trajectory;  // what it passes is added; null: nobody asks
  Points3 initial_positions = {};            // [m] where the shot began, as in Together
};

struct FrameInterval {
  std::string where;  // for errors
  double dt;          // [s]
  int min_halvings;
  Eigen::MatrixXd dhat;  // [m] of several sheets: d^ between them (elastic.h)
};

/// Takes sheets through a frame: one by itself, or several in one step. Down to 1/256 of a frame;
/// one in which a flat sheet is pushed together in halves to 1/8: where it bends to is to be its
/// way's affair, not the step's or the mesh's. A leap of more than a whole step takes is halved
/// before it is tried. throws Error(Fault::simulation) when the energy is not finite
std::vector<FrameStepResult> advance_frame(const std::vector<SubstepTarget>&, const FrameInterval&);

}  // namespace paperbake
