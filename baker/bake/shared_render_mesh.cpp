#include "baker/bake/shared_render_mesh.h"

#include "baker/bake/render_shapes.h"
#include "baker/bake/task_queue.h"
#include "core/geometry/surface_transfer.h"
#include "core/render/untangle_sheets.h"

#include <algorithm>
#include <deque>
#include <set>

namespace paperbake {
namespace {

// for each sheet, triangles of its simulated meshes
using TrianglesOfSheets = std::vector<std::set<ShotRecord::SimulatedTriangle>>;

/// The simulated triangles of all frames that intersect each other, however flat the render meshes
/// are made, because these cut off the folds of layers that are near each other.
TrianglesOfSheets intersecting_triangles(const std::vector<RenderInput>& inputs,
                                         const RenderOptions& options,
                                         const std::vector<RenderSurface>& sheets) {
  const SheetUntangler untangler(sheets);
  std::vector<MeshPointCache> points;
  for (std::size_t s = 0; s < sheets.size(); ++s) points.emplace_back(*inputs[s].record, sheets[s]);
  const auto of_frame = [&](std::size_t k, const std::vector<MeshPoints>& at) {
    const StageClock::Part part(options.clock, Stage::render_mesh);
    TrianglesOfSheets triangles(sheets.size());
    std::vector<SheetUntangler::Simulated> simulated;
    const auto mesh = [&](std::size_t s) { return inputs[s].record->frames()[k].mesh; };
    for (std::size_t s = 0; s < at.size(); ++s) {
      // the vertices are located on the simulated mesh only where somebody asks for it
      const Sheet sheet = inputs[s].record->sheet(inputs[s].record->frames()[k]);
      if (sheets[s].may_have_intersecting_triangles(sheet))
        for (const int t : sheets[s].intersecting_triangles(sheet, at[s].get()))
          triangles[s].insert({mesh(s), t});
      if (sheets.size() > 1) simulated.push_back({sheet, &at[s].get()});
    }
    if (simulated.size() == sheets.size() && untangler.linear_surfaces_intersect(simulated))
      for (std::size_t s = 0; s < at.size(); ++s)
        for (int t = 0; t < simulated[s].sheet.triangles.rows(); ++t)
          triangles[s].insert({mesh(s), t});
    return triangles;
  };
  const std::size_t threads = std::max(options.threads, 1), frames = frames_of_any(inputs);
  TrianglesOfSheets found(sheets.size());
  std::deque<std::future<TrianglesOfSheets>> pending;
  for (std::size_t k = 0; k < frames || !pending.empty(); ++k) {
    if (k < frames && simulated_alike(inputs, k)) continue;
    if (k < frames) {
      std::vector<MeshPoints> at;
      for (std::size_t s = 0; s < sheets.size() && k < inputs[s].record->frames().size(); ++s)
        at.push_back(points[s].at(k));
      for (std::size_t s = 0; s < at.size(); ++s) points[s].forget_before(k);
      pending.push_back(std::async(launch_policy(options.threads),
                                   [&of_frame, k, at] { return of_frame(k, at); }));
      if (pending.size() < threads) continue;
    }
    const TrianglesOfSheets more = pending.front().get();
    pending.pop_front();
    for (std::size_t s = 0; s < found.size(); ++s) found[s].insert(more[s].begin(), more[s].end());
  }
  return found;
}

}  // namespace

std::vector<RenderSurface> make_render_surfaces(const std::vector<RenderInput>& inputs,
                                                const RenderOptions& options) {
  const StageClock::Part part(options.clock, Stage::render_mesh);
  constexpr int max_rounds = 4;
  TrianglesOfSheets exact(inputs.size());  // whose edges are among those of the render mesh
  std::vector<std::vector<CreaseSegment>> seam_lines(inputs.size()), jump_lines(inputs.size());
  for (std::size_t s = 0; s < inputs.size(); ++s)
    if (const auto& authored = inputs[s].shot->authored;
        authored && options.features == MeshFeatures::all) {
      for (const auto& [a, b] : seams(*authored)) seam_lines[s].push_back({a, b});
      for (const auto& [a, b] : jumps(*authored)) jump_lines[s].push_back({a, b});
    }
  for (int round = 0;; ++round) {
    std::vector<RenderSurface> sheets;
    for (std::size_t s = 0; s < inputs.size(); ++s) {
      const Shot& shot = *inputs[s].shot;
      RenderFeatures features = inputs[s].record->features(shot);
      if (options.smooth_without_points && !inputs[s].record->may_be_creased()) {
        features.creases.clear();
        features.may_crease = false;
      }
      if (options.features == MeshFeatures::handles) {
        features.points.resize(shot.handles.size());
        features.creases.clear();
      } else {
        features.edges = inputs[s].record->edges(exact[s]);
      }
      features.seams = seam_lines[s];
      features.jumps = jump_lines[s];
      sheets.push_back(
          make_render_surface(shot.pattern, features, inputs[s].record->edge(), options.quality));
    }
    if (round == max_rounds || options.features == MeshFeatures::handles) return sheets;
    TrianglesOfSheets wanted = exact;
    const TrianglesOfSheets found = intersecting_triangles(inputs, options, sheets);
    for (std::size_t s = 0; s < wanted.size(); ++s)
      wanted[s].insert(found[s].begin(), found[s].end());
    std::size_t more = 0;
    for (std::size_t s = 0; s < wanted.size(); ++s) more += wanted[s].size() - exact[s].size();
    if (more == 0) return sheets;
    exact = std::move(wanted);
  }
}

}  // namespace paperbake
