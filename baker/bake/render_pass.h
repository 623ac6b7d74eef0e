#pragma once

#include "baker/bake/render_input.h"
#include "baker/output/cache_judge.h"
#include "core/model/frame_statistics.h"
#include "formats/cache/alembic_cache.h"

#include <cstddef>
#include <memory>
#include <vector>

namespace paperbake {

/// One frame of one sheet on its render mesh.
struct RenderedSheet {
  int frame = 0;
  std::size_t record_index = 0;  // of the frame in the record
  CacheFrame mesh;
  RenderStatistics statistics;
  Judgement judgement;
  double handle_error = 0;  // [m] largest distance of a held point of the mesh from its key
};

/// Second stage of a bake: puts the simulated frames of sheets on one mesh for the whole shot
/// (shared_render_mesh.h). Velocities are central differences of what is rendered, one-sided at the
/// ends of the record. As many frames are made ahead as there are threads (frame_renderer.h); at
/// most three finished ones are kept.
class RenderPass {
 public:
  /// sheets  that come near each other, or one; their records begin with the same frame
  RenderPass(std::vector<RenderInput> sheets, const RenderOptions&);
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
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace paperbake
