#pragma once

#include "core/animation/trajectory.h"
#include "core/step1_elastic/elastic.h"

#include <string>
#include <vector>

namespace paperbake {

// [1] of the longer side: relative motion of the handles in one step; assumed
inline constexpr double max_handle_motion = 0.03;
inline constexpr int max_halvings_for_inertia = 8;  // of a frame

/// Result of the elastic step of one frame, which is taken in halves where a whole one fails.
struct FrameStepResult {
  int substeps = 0, iterations = 0;
  bool converged = true;
  ElasticReport last;
  // why the sheets cannot follow their handles; they and all that is known of them are then as they
  // were before the step. Empty: they can.
  std::string failure_reason = {};
  // [1] of the frame: how far the sheet has followed its colliders. 1 unless it is jammed; it is
  // then as it was at that time, and not converged.
  double followed = 1;
};

/// A sheet that is to follow its handles through a frame.
struct DrivenSheet {
  Elastic& elastic;
  Sheet& sheet;
  StepInput input;  // of the whole frame
  // [1] relative motion of the handles, of the longer side
  double relative_motion;
  double side;                               // [m] longer side of the pattern
  std::vector<TrajectoryPoint>* trajectory;  // receives the trajectory; null: not recorded
  // [m] positions at the start of the shot, as in JointStepSheet
  Points3 initial_positions = {};
};

struct FrameInterval {
  std::string where;  // for error messages
  double dt;          // [s] length of the frame
  int min_halvings;
  Eigen::MatrixXd dhat;  // [m] dhat between several sheets (elastic.h)
};

/// How often a frame is halved until no collider moves farther in a part of it than a squeezed
/// sheet follows it in one step that does not converge.
int halvings_of_squeeze(const ColliderMotion&);

/// Takes sheets through one frame: one sheet by itself, or several in one joint step. A step that
/// fails, or tears the sheet, is halved, down to 1/256 of a frame. A frame in which a flat sheet is
/// compressed is halved down to 1/8, so that the buckling direction does not depend on step size or
/// mesh. Handles that move farther relative to each other than one step should take are halved
/// before the step is tried, and so are frames in which a collider moves near a sheet by more than
/// half its Collider::depth() or a tenth of an edge of the mesh, down to 1/1024; so are steps that
/// fail while a collider squeezes the sheet.
///
/// Colliders that move squeeze sheets in steps that either converge or are no longer than three
/// tenths of the reach of their barrier. Where such a step stretches an edge by more than 2 % and
/// by more than before, or leaves a sheet 0.1 mm inside of a collider, it is not taken: the sheets
/// are jammed, and stay as they were at the end of the last one.
/// throws  EnergyNotFinite
std::vector<FrameStepResult> advance_frame(const std::vector<DrivenSheet>&, const FrameInterval&);

}  // namespace paperbake
