#pragma once

#include "baker/settings.h"
#include "core/render_sheet.h"
#include "core/shot_record.h"
#include "formats/alembic_cache.h"
#include "formats/certificate.h"

#include <functional>

namespace paperbake {

/// The second pass of a bake: a shot that was simulated goes, frame by frame, onto one mesh that has all of its handles,
/// singular points and lasting creases. No more than three frames are kept at a time, and as many as there are threads are made.
/// Velocities are central differences of what is rendered, one-sided at the ends of the record.
/// frames  of the record that are wanted; fps [1/s]
/// layers  of a recorded frame (by its place in the record) at the points of the mesh; may be empty
/// write   called for each of them, in order
using LayersOfFrame = std::function<std::vector<CacheLayer>(std::size_t k, const Points2& pattern)>;
void render_shot(const ShotRecord&, const Shot&, Quality, const FrameSpan& frames, double fps, int threads, const LayersOfFrame& layers,
                 const std::function<void(int frame, const CacheFrame&, const RenderNumbers&)>& write);

}  // namespace paperbake
