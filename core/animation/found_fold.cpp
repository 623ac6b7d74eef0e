#include "core/animation/found_fold.h"

#include "core/animation/initial_sheet.h"
#include "core/geometry/collider_gap.h"
#include "core/geometry/hinges.h"
#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/geometry/mesh_transfer.h"
#include "core/geometry/prescribed_creases.h"
#include "core/model/error.h"
#include "core/model/segment2.h"
#include "core/step2_crumple/crumple.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace paperbake {
namespace {

constexpr double kept_energy = 0.9;    // [1] of what is stored, at most
constexpr double max_stretch = 0.005;  // [1] |l - L|/L of an edge
constexpr double max_move = 0.1;       // [1] of the longer side, in contact
constexpr double deepest = 2e-5;       // [m] in a collider

/// [m2] Area of a triangle on the pattern.
double area_of(const Sheet& sheet, int t) {
  const Eigen::RowVector3i c = sheet.triangles.row(t);
  const Vector2d a = sheet.pattern.row(c[0]), b = sheet.pattern.row(c[1]),
                 d = sheet.pattern.row(c[2]);
  return 0.5 * cross(b - a, d - a);
}

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
    Eigen::Matrix2d S;
    S << s[0], s[1], s[1], s[2];
    turn += area_of(sheet, t) * across.dot(S * across);
    removed.curvature.row(t) = -s;
  }
  grid.write(cover, removed);
  return turn / (line.b - line.a).norm();
}

/// Takes the plastic curvature along a line out of the grid of `is`, which is that of `then`.
/// returns  [rad] the mean plastic turn about the line
double uncurl_along(const FoldLine& line, const UnfoldedSheet& is, const PastStep& then) {
  // the triangles and the turn of the line are of the mesh that the sheet has now
  if (then.is_now) {
    uncurl(is.grid, then.sheet, line, line.band);
    return line.plastic_turn;
  }
  return uncurl(is.grid, then.sheet, line, triangles_along(line, then.sheet));
}

/// The sheet as it was when a step began, on a mesh with one crease more, along which it folds.
std::optional<FoundFold> with_crease(const FoldLine& line, const UnfoldedSheet& is,
                                     const PastStep& then, const Method& method) {
  Pattern pattern = is.shot.pattern;
  pattern.prescribed_creases = then.sheet.prescribed_creases;
  pattern.prescribed_creases.push_back({{line.a, line.b}, 0, false});
  std::vector<Vector2d> points = required_points(is.shot);
  for (const SingularPoint& point : then.sheet.singular) points.push_back(point.pattern);
  std::optional<Method::FirstMesh> mesh = method.mesh_with_creases(pattern, points);
  if (!mesh) return std::nullopt;

  is.grid = then.grid;
  const double plastic_turn = uncurl_along(line, is, then);
  Sheet sheet;
  const MeshTransfer onto(then.sheet.pattern, then.sheet.triangles, mesh->pattern);
  sheet.x = onto(then.sheet.x);
  sheet.v = onto(then.sheet.v);
  sheet.pattern = std::move(mesh->pattern);
  sheet.triangles = std::move(mesh->triangles);
  sheet.singular = then.sheet.singular;
  sheet.prescribed_creases = std::move(pattern.prescribed_creases);
  sheet.crease_edges = then.sheet.crease_edges;
  const PrescribedCrease& crease = sheet.prescribed_creases.back();
  for (const Hinge& hinge : find_hinges(sheet.triangles).hinges) {
    const Vector2d a = sheet.pattern.row(hinge.vertices[0]),
                   b = sheet.pattern.row(hinge.vertices[1]);
    if (crease_under({crease}, a, b)) sheet.crease_edges.push_back({a, b, plastic_turn, true, {}});
  }
  std::vector<char> fixed(sheet.pattern.rows(), 0);
  for (const int v : mesh->point_vertex) fixed[v] = 1;
  Elastic elastic = is.elastic.on_mesh(sheet, disc_factors(sheet, is.shot));
  return FoundFold{std::move(sheet), std::move(elastic), std::move(fixed), is.grid};
}

/// [J] What the sheet stores, and what its handles spend on being where they cannot be.
double spent_by(const Elastic& elastic, const Sheet& sheet, const StepInput& input) {
  return elastic.evaluate_energies(sheet).energy + spring_energy(input.constraints, sheet.x);
}

/// What the fold is compared with.
struct Before {
  explicit Before(const UnfoldedSheet& is)
      : spent(spent_by(is.elastic, is.sheet, is.now.input)),
        inside(is.elastic.inside(is.sheet, is.now.input.colliders.to)),
        stretched(length_distortion(is.sheet).largest),
        crossed(crossings(is.sheet)) {}
  double spent;      // [J]
  double inside;     // [m] depth in a collider
  double stretched;  // [1] |l - L|/L of the worst edge
  int crossed;       // [1] pairs of triangles
};

/// Takes a step with the sheet.
/// returns  whether it could
bool take(FoundFold& fold, const UnfoldedSheet& is, const LoadStep& step) {
  fold_by_hands(fold.sheet, is.shot.hands, step.row);
  try {
    fold.step = advance_frame({{fold.elastic, fold.sheet, step.input, step.relative_motion,
                                longer_side(is.shot.pattern), nullptr}},
                              {"", step.dt, 0, {}})
                    .front();
  } catch (const Error&) {  // the energy is not finite
    return false;
  }
  return fold.step.failure_reason.empty();
}

/// Takes steps that led to where the sheet is once more.
bool follow(FoundFold& fold, const UnfoldedSheet& is, const std::vector<PastStep>& steps) {
  for (const PastStep& step : steps)
    if (!take(fold, is, step.load)) return false;
  fold.grid = is.grid;
  return true;
}

/// Lets a fold that holds the sheet where it is go on as the sheet did.
void continue_motion(FoundFold& fold, const UnfoldedSheet& is) {
  const MeshTransfer onto(is.sheet.pattern, is.sheet.triangles, fold.sheet.pattern);
  const Points3 shift = fold.sheet.x - onto(is.sheet.x);
  fold.sheet.v = onto(is.sheet.v);
  fold.elastic.continue_from(is.elastic,
                             [&](const Points3& x) -> Points3 { return onto(x) + shift; });
}

/// Whether paper folds in this way.
bool is_possible(FoundFold& fold, const UnfoldedSheet& is, const Before& before) {
  const MeshTransfer onto(is.sheet.pattern, is.sheet.triangles, fold.sheet.pattern);
  fold.moved = max_row_norm(fold.sheet.x - onto(is.sheet.x));
  fold.spent = spent_by(fold.elastic, fold.sheet, is.now.input);
  if (!(fold.spent <= kept_energy * before.spent) ||
      !(length_distortion(fold.sheet).largest <= std::max(max_stretch, before.stretched)))
    return false;
  if (fold.step.last.contact && (fold.moved > max_move * longer_side(is.shot.pattern) ||
                                 crossings(fold.sheet) > before.crossed))
    return false;
  return fold.elastic.inside(fold.sheet, is.now.input.colliders.to) <=
         std::max(deepest, before.inside);
}

/// Tries places of a fold, and keeps the one with which least is spent.
class Trials {
 public:
  /// steps  that lead to where the sheet is; not empty
  Trials(const UnfoldedSheet& is, const std::vector<PastStep>& steps, const Method& method)
      : is_(is), steps_(steps), method_(method), before_(is), known_(is.elastic.state()) {}

  /// returns  whether the place is better than all that were tried before
  bool improves(const FoldLine& line) {
    std::optional<FoundFold> fold = with_crease(line, is_, steps_.front(), method_);
    const bool could = fold && follow(*fold, is_, steps_);
    if (could && steps_.front().is_now) continue_motion(*fold, is_);
    const bool possible = could && is_possible(*fold, is_, before_);
    is_.elastic.restore(known_);
    if (!could || !(fold->spent < least_)) return false;
    least_ = fold->spent;
    best = possible ? std::move(fold) : std::nullopt;
    return true;
  }

  std::optional<FoundFold> best;  // none: paper does not fold at the best place

 private:
  const UnfoldedSheet& is_;
  const std::vector<PastStep>& steps_;
  const Method& method_;
  const Before before_;
  const SolverState known_;
  double least_ = std::numeric_limits<double>::infinity();
};

/// The place of a fold that colliders press with which both its sides can lie flat and straight
/// between it and their handles. With the coordinate c across the line on the pattern, and s in
/// space, along the faces and towards the fold, one side lies at s = u + c and the other, folded
/// back about c = d, at s = u + 2 d - c; so the means over the handles of the two sides give
///
///   d = (s_far - s_near + c_far + c_near)/2
///
/// returns  nothing if no collider presses the sheet there, or one side has no handle
std::optional<FoldLine> taut_place(const FoldLine& line, const UnfoldedSheet& is) {
  const double row = mean_edge(is.sheet.pattern, is.sheet.triangles),
               widest = 4 / yield_curvature(is.shot.paper);
  const StepInput& now = is.now.input;
  Points2 ends(3, 2);
  ends << line.a.transpose(), line.b.transpose(), (0.5 * (line.a + line.b)).transpose();
  const Points3 at = MeshTransfer(is.sheet.pattern, is.sheet.triangles, ends)(is.sheet.x);
  const std::optional<ColliderGap> gap = gap_around(now.colliders.to, at.row(2), widest);
  if (!gap) return std::nullopt;
  const Vector2d along = (line.b - line.a).normalized(), across(-along.y(), along.x());
  Vector3d out = gap->normal.cross(Vector3d(at.row(1) - at.row(0))).normalized();
  double c[2] = {0, 0}, s[2] = {0, 0};
  int handles[2] = {0, 0};
  for (const PositionConstraint& handle : now.constraints) {
    const double off = across.dot(is.sheet.pattern.row(handle.vertex).transpose() - line.a);
    if (std::abs(off) < row) continue;
    const int side = off > 0;
    ++handles[side];
    c[side] += off;
    s[side] += out.dot(handle.target - at.row(2).transpose());
  }
  if (handles[0] == 0 || handles[1] == 0) return std::nullopt;
  for (const int side : {0, 1}) {
    c[side] /= handles[side];
    s[side] /= handles[side];
  }
  if (s[0] > 0) {  // `out` points away from the fold
    s[0] = -s[0];
    s[1] = -s[1];
  }
  const double d = 0.5 * (s[1] - s[0] + c[1] + c[0]);
  if (!(std::abs(d) < 1.5 * row)) return std::nullopt;
  return parallel_line(line, d, is.shot.pattern);
}

}  // namespace

std::optional<FoundFold> fold_along(const std::vector<FoldLine>& lines, const UnfoldedSheet& is,
                                    const Method& method) {
  const std::vector<PastStep> here{{is.sheet, is.grid, is.now, true}};
  const std::optional<FoldLine> taut = taut_place(lines[lines.size() / 2], is);
  Trials trials(is, taut && !is.past.empty() ? is.past : here, method);
  if (taut)
    trials.improves(*taut);
  else
    for (const FoldLine& line : lines) trials.improves(line);
  if (!trials.best) return std::nullopt;
  is.grid = trials.best->grid;
  trials.best->elastic.set_plastic_grid(&is.grid);
  return std::move(trials.best);
}

}  // namespace paperbake
