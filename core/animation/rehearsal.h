#pragma once

#include "core/animation/animate.h"

namespace paperbake {

/// What the rehearsal of a shot has found.
struct Rehearsal {
  int doublings = 0;  // of the number of triangles of the first mesh, so that the sheet can bend
  // the last frame whose keys it has seen; less than the first of the shot: none
  int last_frame = 0;
  // the sheet did not bend on the finest mesh that the method may have, and might on a finer one
  bool lacks_triangles = false;
};

/// Finds how often the number of triangles of the first mesh has to be doubled so that the sheet
/// can bend. A coarse mesh that is bent in two directions stretches instead: it buckles in waves,
/// and what begins as a smooth roll is crumpled paper a few frames later. Or it folds along its own
/// edges where paper would rise from the ground in a smooth arch. The finer mesh has to be there
/// from the start, because a sheet that has buckled keeps its waves and folds on a finer mesh, too.
///
/// The start of the shot is therefore simulated beforehand, until handles have moved by a tenth of
/// the sheet, but not for more than 64 frames; also beyond the last frame that is asked for, so
/// that a frame does not depend on how many are. A sheet that stretches by then, or ends on folds
/// of 20 degrees and more, is rehearsed again on a finer mesh, until it bends, or the mesh is as
/// fine as bends of paper under its own weight ask for. If it does not even bend then, it crumples,
/// or the method has too few triangles for it: only stretching gets a finer mesh in that case.
///
/// Only a sheet without inertia is rehearsed that has handles and colliders, and begins its shot
/// now: others get a finer mesh when they need it, or have it already. Other sheets are not there
/// in a rehearsal.
///
/// returns  no doublings: the first mesh is fine enough, or nothing was rehearsed
/// throws   Error(ErrorCode::stopped) when AnimateOptions::asks_to_stop says so
/// source   this project
Rehearsal rehearse(const Shot&, const MethodChoice&, const AnimateOptions&);

}  // namespace paperbake
