#include "baker/bake/render_pass.h"

#include "baker/bake/frame_renderer.h"
#include "baker/bake/shared_render_mesh.h"
#include "core/geometry/surface_transfer.h"

#include <optional>
#include <utility>

namespace paperbake {
struct RenderPass::State {
  State(std::vector<RenderInput> sheets, const RenderOptions& with)
      : inputs(std::move(sheets)),
        options(with),
        surfaces(make_render_surfaces(inputs, options)),
        renderer(inputs, surfaces, options),
        rendered(inputs.size()) {
    for (std::size_t s = 0; s < inputs.size(); ++s) {
      rendered[s].mesh.triangles = surfaces[s].mesh().triangles;
      rendered[s].mesh.normal_of_corner = surfaces[s].normal_of_corner();
      rendered[s].mesh.uv = surfaces[s].mesh().pattern / longer_side(inputs[s].shot->pattern);
      if (const auto& authored = inputs[s].shot->authored)
        rendered[s].mesh.surface = std::make_shared<const MeshSurface>(
            surface_on(*authored, surfaces[s].mesh().pattern, surfaces[s].mesh().triangles));
    }
  }

  Points3 velocity(std::size_t sheet) const;
  bool next();

  std::vector<RenderInput> inputs;
  RenderOptions options;
  std::vector<RenderSurface> surfaces;
  FrameRenderer renderer;
  std::optional<FrameOfSheets> before, now, after;
  std::size_t k = 0;  // of the frame in the records that comes next
  std::vector<RenderedSheet> rendered;
};

Points3 RenderPass::State::velocity(std::size_t s) const {
  const auto has = [&](const std::optional<FrameOfSheets>& other) {
    return other && s < other->frames.size();
  };
  const Points3& x = now->frames[s].x;
  if (has(before) && has(after))
    return 0.5 * options.fps * (after->frames[s].x - before->frames[s].x);
  if (has(after)) return options.fps * (after->frames[s].x - x);
  if (has(before)) return options.fps * (x - before->frames[s].x);
  return Points3::Zero(x.rows(), 3);
}

bool RenderPass::State::next() {
  const auto& recorded = inputs.front().record->frames();
  for (; k < recorded.size(); ++k) {
    before = std::move(now);
    now = std::move(after);
    after.reset();
    if (options.frames.contains(recorded[k].frame)) break;
  }
  if (k == recorded.size()) return false;
  if (k > 0 && !before) before = renderer(k - 1);
  if (!now) now = renderer(k);
  if (k + 1 < recorded.size()) after = renderer(k + 1);
  rendered.resize(now->frames.size());
  for (std::size_t s = 0; s < rendered.size(); ++s) {
    rendered[s].frame = recorded[k].frame;
    rendered[s].record_index = k;
    rendered[s].mesh.velocity = velocity(s);
    rendered[s].mesh.x = now->frames[s].x;
    rendered[s].mesh.normal = now->frames[s].normals;
    rendered[s].mesh.crease = now->frames[s].crease;
    rendered[s].statistics = now->verdicts[s].statistics;
    rendered[s].judgement = now->verdicts[s].judgement;
    rendered[s].handle_error = now->verdicts[s].handle_error;
  }
  ++k;
  return true;
}

RenderPass::RenderPass(std::vector<RenderInput> sheets, const RenderOptions& options)
    : state_(std::make_unique<State>(std::move(sheets), options)) {}

RenderPass::~RenderPass() = default;

bool RenderPass::next() { return state_->next(); }

std::vector<RenderedSheet>& RenderPass::sheets() { return state_->rendered; }

const Points2& RenderPass::pattern(std::size_t sheet) const {
  return state_->surfaces[sheet].mesh().pattern;
}

}  // namespace paperbake
