#pragma once

#include "core/animation/animate.h"

namespace paperbake {

/// What the rehearsal of a shot has found.
struct Rehearsal {
  int doublings = 0;  // of the number of triangles of the first mesh, so that the sheet can bend
  // the last frame whose keys it has seen; less than the first of the shot: none
  int last_frame = 0;
};

/// Finds how often the number of triangles of the first mesh has to be doubled so that the sheet
/// can bend. A coarse mesh that is bent in two directions stretches instead: it buckles in waves,
/// and what begins as a smooth roll is crumpled paper a few frames later. The finer mesh has to be
/// there from the start, because a sheet that has buckled keeps its waves on a finer mesh, too.
///
/// The start of the shot is therefore simulated once beforehand, until handles have moved by a
/// tenth of the sheet, but not for more than 64 frames; also beyond the last frame that is asked
/// for, so that a frame does not depend on how many are. Only a sheet without inertia is rehearsed
/// that has handles and colliders, and begins its shot now: others get a finer mesh when they need
/// it, or have it already. Other sheets are not there in a rehearsal.
///
/// returns  no doublings: the first mesh is fine enough, or nothing was rehearsed
/// throws   Error(ErrorCode::stopped) when AnimateOptions::asks_to_stop says so
/// source   this project
Rehearsal rehearse(const Shot&, const MethodChoice&, const AnimateOptions&);

}  // namespace paperbake
