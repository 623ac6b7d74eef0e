#include "core/animation/found_fold.h"

#include "core/animation/fold_place.h"
#include "core/animation/initial_sheet.h"
#include "core/geometry/hinges.h"
#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/geometry/mesh_transfer.h"
#include "core/geometry/prescribed_creases.h"
#include "core/hands/folding_hands.h"
#include "core/linear_algebra/symmetric_eigen.h"
#include "core/model/segment2.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace paperbake {
namespace {

constexpr double kept_energy = 0.9;    // [1] of what is stored, at most
constexpr double max_stretch = 0.005;  // [1] |l - L|/L of an edge
constexpr double max_move = 0.1;       // [1] of the longer side, in contact
// The mesh on which a sheet must be folded, too, has so many times as many triangles. Twice is
// enough for a roll to bend less in a row of them than a fold does. On four times as many, a fold
// would do so as well: paper that has yielded keeps its bend as wide as a row of the coarse mesh.
constexpr int refinement_of_finer_mesh = 2;

/// The triangles of a sheet within a row of a line.
std::vector<int> triangles_along(const FoldLine& line, const Sheet& sheet) {
  const double row = mean_edge(sheet.pattern, sheet.triangles);
  std::vector<int> along;
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    const Eigen::RowVector3i c = sheet.triangles.row(t);
    const Vector2d middle =
        (sheet.pattern.row(c[0]) + sheet.pattern.row(c[1]) + sheet.pattern.row(c[2])) / 3;
    if (distance_to_segment(middle, line.a, line.b) < row) along.push_back(t);
  }
  return along;
}

/// Takes the plastic curvature of triangles along a line out of the grid.
/// returns  [rad] their mean plastic turn about the line
double uncurl(PlasticGrid& grid, const Sheet& sheet, const FoldLine& line,
              const std::vector<int>& triangles) {
  if (grid.is_virgin()) return 0;
  const PlasticGrid::Cover cover = grid.cover(sheet.pattern, sheet.triangles);
  const PlasticMemory memory = grid.read(cover);
  PlasticMemory removed(static_cast<int>(sheet.triangles.rows()));
  const Vector2d along = (line.b - line.a).normalized(), across(-along.y(), along.x());
  double turn = 0;
  for (const int t : triangles) {
    const Eigen::RowVector3d s = memory.curvature.row(t);
    turn += pattern_area(sheet, t) * across.dot(symmetric_matrix(s) * across);
    removed.curvature.row(t) = -s;
  }
  grid.write(cover, removed);
  return turn / (line.b - line.a).norm();
}

/// Takes the plastic curvature along a line out of the grid of the unfolded sheet.
/// returns  [rad] the mean plastic turn about the line
double uncurl_along(const FoldLine& line, const UnfoldedSheet& unfolded, const PastStep& then) {
  // the triangles and the turn of the line are of the mesh that the sheet has now
  if (then.is_now) {
    uncurl(unfolded.grid, then.sheet, line, line.band);
    return line.plastic_turn;
  }
  return uncurl(unfolded.grid, then.sheet, line, triangles_along(line, then.sheet));
}

/// The sheet as it was when a step began, on a mesh with one crease more. It is not folded there.
/// refinement  as in Method::mesh_with_creases
std::optional<Sheet> with_crease(const FoldLine& line, const UnfoldedSheet& unfolded,
                                 const PastStep& then, const Method& method, int refinement,
                                 std::vector<char>& fixed) {
  Pattern pattern = unfolded.shot.pattern;
  pattern.prescribed_creases = then.sheet.prescribed_creases;
  pattern.prescribed_creases.push_back({{line.a, line.b}, 0, false});
  std::vector<Vector2d> points = required_points(unfolded.shot);
  for (const SingularPoint& point : then.sheet.singular) points.push_back(point.pattern);
  std::optional<PatternMesh> mesh = method.mesh_with_creases(pattern, points, refinement);
  if (!mesh) return std::nullopt;

  fixed = are_required(*mesh);
  Sheet sheet = on_other_mesh(then.sheet, std::move(mesh->vertices), std::move(mesh->triangles));
  sheet.prescribed_creases = std::move(pattern.prescribed_creases);
  return sheet;
}

/// Folds a sheet along its last crease. rest_angle [rad]
void fold_on_last_crease(Sheet& sheet, double rest_angle) {
  const PrescribedCrease& crease = sheet.prescribed_creases.back();
  for (const Hinge& hinge : find_hinges(sheet.triangles).hinges) {
    const Vector2d a = sheet.pattern.row(hinge.vertices[0]),
                   b = sheet.pattern.row(hinge.vertices[1]);
    if (crease_under({crease}, a, b)) sheet.crease_edges.push_back({a, b, rest_angle, true, {}});
  }
}

enum class Crease { folded, none };

/// The sheet as it was when a step began, on a mesh that has a line among its edges: folded there,
/// or not folded and finer.
std::optional<FoundFold> begin(const FoldLine& line, Crease crease, const UnfoldedSheet& unfolded,
                               const PastStep& then, const Method& method) {
  std::vector<char> fixed;
  std::optional<Sheet> sheet = with_crease(
      line, unfolded, then, method, crease == Crease::folded ? 1 : refinement_of_finer_mesh, fixed);
  if (!sheet) return std::nullopt;
  unfolded.grid = then.grid;
  if (crease == Crease::folded)
    fold_on_last_crease(*sheet, uncurl_along(line, unfolded, then));
  else
    sheet->prescribed_creases.pop_back();
  Elastic elastic = unfolded.elastic.on_mesh(*sheet, disc_factors(*sheet, unfolded.shot));
  return FoundFold{std::move(*sheet), std::move(elastic), std::move(fixed), unfolded.grid};
}

/// [J] What the sheet stores, and what its handles spend on being where they cannot be.
double spent_by(Elastic& elastic, const Sheet& sheet, const StepInput& input) {
  return elastic.evaluate_energies(sheet).energy + spring_energy(input.constraints, sheet.x);
}

/// What the fold is compared with.
struct Before {
  explicit Before(const UnfoldedSheet& unfolded)
      : spent(spent_by(unfolded.elastic, unfolded.sheet, unfolded.now.input)),
        inside(unfolded.elastic.inside(unfolded.sheet, unfolded.now.input.colliders.to)),
        stretched(worst_edge(unfolded.sheet).error),
        crossed(crossings(unfolded.sheet)) {}
  double spent;      // [J]
  double inside;     // [m] depth in a collider
  double stretched;  // [1] |l - L|/L of the worst edge
  int crossed;       // [1] pairs of triangles
};

/// Takes a step with the sheet.
/// returns  whether it could
bool take(FoundFold& fold, const UnfoldedSheet& unfolded, const LoadStep& step) {
  fold_by_hands(fold.sheet, unfolded.shot.hands, step.row);
  try {
    fold.step = advance_frame({{fold.elastic, fold.sheet, step.input, step.relative_motion,
                                longer_side(unfolded.shot.pattern), nullptr}},
                              {"", step.dt, step.halvings, {}})
                    .front();
  } catch (const EnergyNotFinite&) {
    return false;
  }
  return fold.step.failure_reason.empty();
}

/// Takes steps that led to where the sheet is once more.
bool follow(FoundFold& fold, const UnfoldedSheet& unfolded, const std::vector<PastStep>& steps) {
  for (const PastStep& step : steps)
    if (!take(fold, unfolded, step.load)) return false;
  fold.grid = unfolded.grid;
  return true;
}

/// Lets a fold that holds the sheet where it is go on as the sheet did.
void continue_motion(FoundFold& fold, const UnfoldedSheet& unfolded) {
  const MeshTransfer onto(unfolded.sheet.pattern, unfolded.sheet.triangles, fold.sheet.pattern);
  const Points3 shift = fold.sheet.x - onto(unfolded.sheet.x);
  fold.sheet.v = onto(unfolded.sheet.v);
  fold.elastic.continue_from(unfolded.elastic,
                             [&](const Points3& x) -> Points3 { return onto(x) + shift; });
}

/// Whether paper folds in this way.
bool is_possible(FoundFold& fold, const UnfoldedSheet& unfolded, const Before& before) {
  const MeshTransfer onto(unfolded.sheet.pattern, unfolded.sheet.triangles, fold.sheet.pattern);
  fold.moved = max_row_norm(fold.sheet.x - onto(unfolded.sheet.x));
  fold.spent = spent_by(fold.elastic, fold.sheet, unfolded.now.input);
  if (!(fold.spent <= kept_energy * before.spent) ||
      !(worst_edge(fold.sheet).error <= std::max(max_stretch, before.stretched)))
    return false;
  if (fold.step.last.contact && (fold.moved > max_move * longer_side(unfolded.shot.pattern) ||
                                 crossings(fold.sheet) > before.crossed))
    return false;
  return fold.elastic.inside(fold.sheet, unfolded.now.input.colliders.to) <=
         std::max(tolerated_depth_of_change, before.inside);
}

/// Tries places of a fold, and keeps the one with which least is spent.
class Trials {
 public:
  /// steps  that lead to where the sheet is; not empty
  Trials(const UnfoldedSheet& unfolded, const std::vector<PastStep>& steps, const Method& method)
      : unfolded_(unfolded),
        steps_(steps),
        method_(method),
        before_(unfolded),
        known_(unfolded.elastic.state()) {}

  /// returns  whether the place is better than all that were tried before
  bool improves(const FoldLine& line) {
    std::optional<FoundFold> fold = begin(line, Crease::folded, unfolded_, steps_.front(), method_);
    const bool could = fold && follow(*fold, unfolded_, steps_);
    if (could && steps_.front().is_now) continue_motion(*fold, unfolded_);
    const bool possible = could && is_possible(*fold, unfolded_, before_);
    unfolded_.elastic.restore(known_);
    if (!could || !(fold->spent < least_)) return false;
    least_ = fold->spent;
    best = possible ? std::move(fold) : std::nullopt;
    best_line_ = line;
    return true;
  }

  /// Whether the sheet is being folded, too, if it takes the steps unfolded on a finer mesh with
  /// the line of the best place. If it is not, its bend was one of its mesh.
  bool bends_on_finer_mesh() const {
    std::optional<FoundFold> same =
        begin(best_line_, Crease::none, unfolded_, steps_.front(), method_);
    bool bends = same && follow(*same, unfolded_, steps_);
    if (bends) {
      const auto memory = [&] {
        return unfolded_.grid.read(
            unfolded_.grid.cover(same->sheet.pattern, same->sheet.triangles));
      };
      bends = !method_.fold_lines(same->sheet, memory()).empty() ||
              !method_.pressed_lines(same->sheet, memory, unfolded_.now.input.colliders.to).empty();
    }
    unfolded_.elastic.restore(known_);
    return bends;
  }

  std::optional<FoundFold> best;  // none: paper does not fold at the best place

 private:
  const UnfoldedSheet& unfolded_;
  const std::vector<PastStep>& steps_;
  const Method& method_;
  const Before before_;
  const SolverState known_;
  FoldLine best_line_{};
  double least_ = std::numeric_limits<double>::infinity();
};

}  // namespace

std::optional<FoundFold> fold_along(const std::vector<FoldLine>& lines,
                                    const UnfoldedSheet& unfolded, const Method& method) {
  const FoldLine& middle = lines[lines.size() / 2];
  const std::vector<PastStep> here{{unfolded.sheet, unfolded.grid, unfolded.now, true}};
  const std::optional<FoldLine> taut = taut_place(middle, unfolded);
  Trials trials(unfolded, taut && !unfolded.past.empty() ? unfolded.past : here, method);
  if (taut) {
    trials.improves(*taut);
  } else if (const std::optional<FoldLine> flat = flat_place(middle, unfolded)) {
    trials.improves(*flat);
  } else {
    for (const FoldLine& line : lines) trials.improves(line);
  }
  if (!trials.best || !(taut || trials.bends_on_finer_mesh())) return std::nullopt;
  unfolded.grid = trials.best->grid;
  trials.best->elastic.set_plastic_grid(&unfolded.grid);
  return std::move(trials.best);
}

}  // namespace paperbake
