#include "core/animation/fold_place.h"

#include "core/geometry/collider_gap.h"
#include "core/geometry/measure.h"
#include "core/geometry/mesh_transfer.h"
#include "core/step2_crumple/crumple.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace paperbake {
namespace {

/// Two handles on either side of a fold.
struct HandlePair {
  Vector2d p, q;   // [m] on the pattern
  double nearest;  // [m] distance of the handles where they come nearest to each other
};

/// [m] The least distance of two handles, from a row of the shot on, in frames in which both hold.
double least_distance(const Handle& a, const Handle& b, const UnfoldedSheet& unfolded) {
  double least = std::numeric_limits<double>::infinity();
  const Eigen::Index rows = std::max(a.keyed.rows(), b.keyed.rows());
  for (int row = unfolded.now.row; row < rows; ++row)
    if (a.held(unfolded.first_frame + row) && b.held(unfolded.first_frame + row))
      least = std::min(least, (keyed_position(a, row) - keyed_position(b, row)).norm());
  return least;
}

std::vector<HandlePair> pairs_across(const FoldLine& line, const UnfoldedSheet& unfolded) {
  const Vector2d along = (line.b - line.a).normalized(), across(-along.y(), along.x());
  std::vector<HandlePair> pairs;
  for (const Handle& a : unfolded.shot.handles)
    for (const Handle& b : unfolded.shot.handles) {
      if (a.mode != HandleMode::absolute || b.mode != HandleMode::absolute ||
          across.dot(a.pattern - line.a) >= 0 || across.dot(b.pattern - line.a) <= 0)
        continue;
      const double nearest = least_distance(a, b, unfolded);
      if (std::isfinite(nearest)) pairs.push_back({a.pattern, b.pattern, nearest});
    }
  return pairs;
}

/// [m] By how much handles come nearer to each other than flat sides do, folded about the line.
double excess(const std::vector<HandlePair>& pairs, const Vector2d& a, const Vector2d& b) {
  const Vector2d along = (b - a).normalized(), across(-along.y(), along.x());
  double most = -std::numeric_limits<double>::infinity();
  for (const HandlePair& pair : pairs) {
    const Vector2d mirrored = pair.q - 2 * across.dot(pair.q - a) * across;
    most = std::max(most, (pair.p - mirrored).norm() - pair.nearest);
  }
  return most;
}

}  // namespace

std::optional<FoldLine> taut_place(const FoldLine& line, const UnfoldedSheet& unfolded) {
  const double edge = mean_edge(unfolded.sheet.pattern, unfolded.sheet.triangles),
               widest = 4 / yield_curvature(unfolded.shot.paper);
  const StepInput& now = unfolded.now.input;
  Points2 ends(3, 2);
  ends << line.a.transpose(), line.b.transpose(), (0.5 * (line.a + line.b)).transpose();
  const Points3 at =
      MeshTransfer(unfolded.sheet.pattern, unfolded.sheet.triangles, ends)(unfolded.sheet.x);
  const std::optional<ColliderGap> gap = gap_around(now.colliders.to, at.row(2), widest);
  if (!gap) return std::nullopt;
  const Vector2d along = (line.b - line.a).normalized(), across(-along.y(), along.x());
  Vector3d out = gap->normal.cross(Vector3d(at.row(1) - at.row(0))).normalized();
  double c[2] = {0, 0}, s[2] = {0, 0};
  int handles[2] = {0, 0};
  for (const PositionConstraint& handle : now.constraints) {
    const double off = across.dot(unfolded.sheet.pattern.row(handle.vertex).transpose() - line.a);
    if (std::abs(off) < edge) continue;
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
  if (!(std::abs(d) < 1.5 * edge)) return std::nullopt;
  return parallel_line(line, d, unfolded.shot.pattern);
}

std::optional<FoldLine> flat_place(const FoldLine& line, const UnfoldedSheet& unfolded) {
  // of a grid search; each refinement searches a fifth of the range around the best
  constexpr int steps = 10, refinements = 3;
  const std::vector<HandlePair> pairs = pairs_across(line, unfolded);
  if (pairs.empty() || excess(pairs, line.a, line.b) <= 0) return std::nullopt;
  const double edge = mean_edge(unfolded.sheet.pattern, unfolded.sheet.triangles);
  const Vector2d along = (line.b - line.a).normalized(), across(-along.y(), along.x());
  Vector2d best(0, 0);  // [m] how far the two ends move
  double least = std::numeric_limits<double>::infinity(), reach = edge;
  for (int again = 0; again <= refinements; ++again, reach /= steps / 2) {
    const Vector2d from = best;
    for (int i = -steps; i <= steps; ++i)
      for (int k = -steps; k <= steps; ++k) {
        const Vector2d off = from + reach / steps * Vector2d(i, k);
        if (off.cwiseAbs().maxCoeff() > edge) continue;
        const double here = excess(pairs, line.a + off[0] * across, line.b + off[1] * across);
        if (here >= least) continue;
        least = here;
        best = off;
      }
  }
  if (least > 0) return std::nullopt;
  FoldLine moved = line;
  moved.a += best[0] * across;
  moved.b += best[1] * across;
  return parallel_line(moved, 0, unfolded.shot.pattern);
}

}  // namespace paperbake
