#include "core/animation/fold_search.h"

#include "core/geometry/measure.h"

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

constexpr std::size_t most_past_steps = 8;

void archive_motion(Serializer& a, ColliderMotion& motion, const Colliders& colliders) {
  archive_shapes(a, motion.from, colliders);
  archive_shapes(a, motion.to, colliders);
  // one that does not move is one object
  for (std::size_t c = 0; a.reads() && c < colliders.size(); ++c)
    if (motion.from[c]->mesh().x == motion.to[c]->mesh().x) motion.from[c] = motion.to[c];
}

}  // namespace

FoldSearch::FoldSearch(SimulatedSheet& simulated, const Method& method, int first_frame)
    : simulated_(simulated), method_(method), first_frame_(first_frame) {}

bool FoldSearch::is_on() const {
  return simulated_.plastic_grid && !simulated_.has_bends && method_.finds_folds(simulated_.sheet);
}

/// Places of a line along which paper has yielded or must yield.
std::vector<FoldLine> FoldSearch::lines(const ColliderShapes& colliders, const Signs& signs) const {
  if (!(signs.yielded || signs.on_colliders) || !is_on()) return {};
  const Sheet& sheet = simulated_.sheet;
  const PlasticGrid& grid = *simulated_.plastic_grid;
  const auto memory = [&] { return grid.read(grid.cover(sheet.pattern, sheet.triangles)); };
  std::vector<FoldLine> lines;
  if (signs.yielded) lines = method_.fold_lines(sheet, memory());
  if (lines.empty() && signs.on_colliders) lines = method_.pressed_lines(sheet, memory, colliders);
  return lines;
}

std::optional<FoundFold> FoldSearch::find(const LoadStep& now, const Signs& signs,
                                          const AdmissibilityCheck& is_admissible) {
  // [1] of what a sheet stored when a fold was last tried: while it stores as much to within this,
  // no fold is tried again, because one has to save a tenth of it
  constexpr double new_energy = 0.1;
  const Sheet& sheet = simulated_.sheet;
  const std::vector<FoldLine> found = lines(now.input.colliders.to, signs);
  if (found.empty()) return std::nullopt;
  const double stored = simulated_.elastic.evaluate_energies(sheet).energy;
  if (std::abs(stored - stored_unfolded_) < new_energy * stored_unfolded_) return std::nullopt;
  stored_unfolded_ = stored;
  const SolverState known = simulated_.elastic.state();
  std::optional<FoundFold> fold = fold_along(found,
                                             {simulated_.shot, sheet, simulated_.elastic,
                                              *simulated_.plastic_grid, first_frame_, now, past_},
                                             method_);
  if (!fold || is_admissible(sheet, fold->sheet, fold->moved)) return fold;
  simulated_.elastic.restore(known);
  return std::nullopt;
}

bool FoldSearch::joins(LoadStep& last, const LoadStep& next) const {
  constexpr double longest = 0.15;  // [1] of an edge
  const double spacing = longest * mean_edge(simulated_.sheet.pattern, simulated_.sheet.triangles);
  const double travel = std::max(farthest_move(last.input.colliders.from, next.input.colliders.to),
                                 simulated_.side * (last.relative_motion + next.relative_motion));
  if (travel > spacing || last.halvings != next.halvings ||
      vertices_of(last.input.constraints) != vertices_of(next.input.constraints))
    return false;
  const ColliderShapes from = last.input.colliders.from;
  const double dt = last.dt + next.dt, motion = last.relative_motion + next.relative_motion;
  last = next;
  last.input.colliders.from = from;
  last.dt = dt;
  last.relative_motion = motion;
  return true;
}

void FoldSearch::remember(const LoadStep& load) {
  if (!past_.empty() && joins(past_.back().load, load)) return;
  if (past_.size() == most_past_steps) past_.erase(past_.begin());
  past_.push_back({simulated_.sheet, *simulated_.plastic_grid, load});
}

void FoldSearch::archive(Serializer& a) {
  a(stored_unfolded_);
  std::size_t count = past_.size();
  a(count);
  const Colliders* colliders = simulated_.shot.colliders.get();
  a.require(count == 0 || (count <= most_past_steps && simulated_.plastic_grid && colliders));
  if (count == 0) return past_.clear();
  if (a.reads()) past_.assign(count, {{}, *simulated_.plastic_grid, {}});
  for (PastStep& step : past_) {
    LoadStep& load = step.load;
    a(step.sheet, step.grid, load.input.constraints, load.input.time, load.dt, load.relative_motion,
      load.row, load.halvings);
    archive_motion(a, load.input.colliders, *colliders);
    a.require(load.dt > 0 && load.row >= 0 && load.halvings >= 0 &&
              load.halvings <= max_halvings_for_inertia);
    for (const PositionConstraint& c : load.input.constraints)
      a.require(c.vertex >= 0 && c.vertex < step.sheet.x.rows());
  }
}

}  // namespace paperbake
