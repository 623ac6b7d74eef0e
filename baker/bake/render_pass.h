#pragma once

#include "baker/bake/stage_clock.h"
#include "baker/job/settings.h"
#include "baker/output/cache_judge.h"
#include "core/model/frame_statistics.h"
#include "core/model/shot.h"
#include "core/render/render_surface.h"
#include "core/render/shot_record.h"
#include "formats/cache/alembic_cache.h"

#include <cstddef>
#include <memory>
#include <vector>

namespace paperbake {

/// A simulated sheet that is to be rendered.
struct RenderInput {
  const ShotRecord* record;
  const Shot* shot;
};

/// One frame of one sheet on its render mesh.
struct RenderedSheet {
  int frame = 0;
  std::size_t record_index = 0;  // of the frame in the record
  CacheFrame mesh;
  RenderStatistics statistics;
  Judgement judgement;
  double handle_error = 0;  // [m] largest distance of a held point of the mesh from its key
};

/// Second stage of a bake: puts the simulated frames of sheets on one mesh for the whole shot,
/// which has all handles, singular points and lasting creases of its sheet; and all simulated
/// edges, if layers or sheets come so near each other that the surface would intersect without
/// them. Velocities are central differences of what is rendered, one-sided at the ends of the
/// record. As many frames are made ahead as there are threads; at most three finished ones are
/// kept.
class RenderPass {
 public:
  // handles: a mesh that has no singular points and no creases, where none can be made with them
  enum class Features { all, handles };
  struct Options {
    Quality quality;
    FrameSpan frames;  // of the records that are wanted
    double fps;        // [1/s]
    int threads;
    Features features = Features::all;
    StageClock* clock = nullptr;  // null: nobody asks for times
  };
  /// sheets  that come near each other, or one; their records begin with the same frame
  RenderPass(std::vector<RenderInput> sheets, const Options&);
  ~RenderPass();
  RenderPass(const RenderPass&) = delete;
  RenderPass& operator=(const RenderPass&) = delete;

  /// Moves on to the next wanted frame. returns  false after the last one
  bool next();
  /// The frame on those sheets that have it, the first ones. Valid until next() is called; may be
  /// changed.
  std::vector<RenderedSheet>& sheets();
  /// |V|x2 [m] where the vertices of a render mesh lie on the pattern.
  const Points2& pattern(std::size_t sheet) const;

 private:
  class MeshPointCache;
  class ShapeCache;
  struct FrameOfSheets;
  class FrameRenderer;
  struct State;
  std::unique_ptr<State> state_;
};

/// Groups sheets that ever come so near each other that their bounding boxes overlap; every sheet
/// is in one group, alone or not. Groups and the indices in them are in ascending order.
std::vector<std::vector<std::size_t>> groups_near_each_other(const std::vector<const ShotRecord*>&);

}  // namespace paperbake
