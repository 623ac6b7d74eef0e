#pragma once

#include "baker/job/settings.h"
#include "core/render/render_surface.h"
#include "core/render/shot_record.h"
#include "formats/cache/alembic_cache.h"
#include "formats/files/certificate.h"

#include <functional>
#include <vector>

namespace paperbake {

/// A sheet that was simulated, to be rendered.
struct RenderInput {
  const ShotRecord* record;
  const Shot* shot;
  /// Layers of a recorded frame (by its place in the record) at the points of the mesh; may be
  /// empty.
  std::function<std::vector<CacheLayer>(std::size_t k, const Points2& pattern)> layers;
  /// Called for each frame that is wanted, in order.
  std::function<void(int frame, const CacheFrame&, const RenderStatistics&)> write;
};

/// The second pass of a bake: sheets that were simulated go, frame by frame, each onto one mesh
/// that has all of its handles, singular points and lasting creases; and all simulated edges, where
/// layers, or sheets, are so near each other that it would pass through itself without them. No
/// more than three frames are kept at a time, and as many as there are threads are made. Velocities
/// are central differences of what is rendered, one-sided at the ends of the record.
/// sheets  that come near each other, or one; their records begin with the same frame
/// frames  of the records that are wanted; fps [1/s]
void render_shot(const std::vector<RenderInput>& sheets, Quality, const FrameSpan& frames,
                 double fps, int threads);

/// Numbers of sheets that ever come so near each other that boxes round them meet; every one is in
/// one list, alone or not. Lists and what is in them are in order.
std::vector<std::vector<std::size_t>> near_each_other(const std::vector<const ShotRecord*>&);

}  // namespace paperbake
