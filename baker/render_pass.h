#pragma once

#include "baker/settings.h"
#include "core/render_sheet.h"
#include "core/shot_record.h"
#include "formats/alembic_cache.h"

#include <functional>

namespace paperbake {

/// How good one frame of the render mesh is.
struct RenderNumbers {
  int triangles = 0;
  double stretch_mean_pct = 0, stretch_max_pct = 0;  // of its edges
  double ms = 0;                                     // CPU time: positions and normals, no writing
};

/// The second pass of a bake: a shot that was simulated goes, frame by frame, onto one mesh that has all of its handles,
/// singular points and lasting creases. No more than three frames are kept at a time.
/// Velocities are central differences of what is rendered, one-sided at the ends of the record.
/// frames  of the record that are wanted; fps [1/s]
/// write   called for each of them, in order
void render_shot(const ShotRecord&, const Shot&, Quality, const FrameSpan& frames, double fps,
                 const std::function<void(int frame, const CacheFrame&, const RenderNumbers&)>& write);

}  // namespace paperbake
