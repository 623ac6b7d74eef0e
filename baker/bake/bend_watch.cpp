#include "baker/bake/bend_watch.h"

#include "core/animation/swing.h"
#include "core/geometry/mesh_coarseness.h"
#include "core/render/curved_surface.h"

#include <cmath>

namespace paperbake {

static constexpr double some_frames = 0.1;  // [1] of a shot

void BendWatch::look(const AnimatedFrame& frame, const Pattern& pattern) {
  const Sheet& sheet = *frame.sheet;
  const FrameStatistics& now = frame.statistics;
  may_be_sharp_ |= !sheet.singular.empty();
  // those of the scene or job are there from the first frame on, others from where they are found
  if (may_be_sharp_ || !sheet.prescribed_creases.empty()) return;
  // what presses paper may crease it, and what moves fast is seen as a blur
  const bool may_be_creased = now.on_colliders > 0 || now.touching_others > 0 || now.inertia;
  const double fold = may_be_creased && frames_ > 0 ? 0 : sharpest_fold(sheet);
  const bool is_angular =
      rms_sagitta(sheet) > visible_motion * std::sqrt(area(pattern)) || fold > crease_begins;
  may_be_sharp_ = frames_ == 0 && is_angular;
  ++frames_;
  creased_frames_ += fold > whole_crease;
  if (!now.converged) return;
  coarse_frames_ += is_angular || now.mesh_error > visible_motion;
}

bool BendWatch::is_coarse() const {
  return !may_be_sharp_ && coarse_frames_ > some_frames * frames_;
}

bool BendWatch::is_creased() const {
  return !may_be_sharp_ && creased_frames_ > some_frames * frames_;
}

}  // namespace paperbake
