#include "formats/maps/crease_history.h"

#include "core/geometry/hinges.h"
#include "core/geometry/prescribed_creases.h"
#include "core/model/segment2.h"
#include "formats/maps/pattern_edge.h"

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

/// 0 up to soft[0], 1 from soft[1], linear between them.
double rise(double value, const double (&soft)[2]) {
  return std::clamp((value - soft[0]) / (soft[1] - soft[0]), 0.0, 1.0);
}

/// False if the creases are so far from each other that they are neither in the same place nor
/// overlap: most of them, told without a look at their directions.
bool may_touch(const DetectedCrease& a, const DetectedCrease& b, double same) {
  const auto apart = [&](const DetectedCrease& low, const DetectedCrease& high) {
    return (low.from.cwiseMax(low.to).array() + 2 * same < high.from.cwiseMin(high.to).array())
        .any();
  };
  return !apart(a, b) && !apart(b, a);
}

bool same_place(const DetectedCrease& a, const DetectedCrease& b, double same) {
  const bool straight = (a.from - b.from).norm() <= same && (a.to - b.to).norm() <= same;
  return straight || ((a.from - b.to).norm() <= same && (a.to - b.from).norm() <= same);
}

/// Whether the creases are parallel and the midpoint of one of them lies on the other.
bool overlap(const DetectedCrease& a, const DetectedCrease& b, double same) {
  const auto within = [&](const DetectedCrease& inner, const DetectedCrease& outer) {
    const Vector2d middle = 0.5 * (inner.from + inner.to);
    const Vector2d u = (inner.to - inner.from).normalized(),
                   w = (outer.to - outer.from).normalized();
    constexpr double aligned = 0.17;  // sin 10 degrees
    return std::abs(cross(u, w)) < aligned &&
           distance_to_segment(middle, outer.from, outer.to) <= same;
  };
  return within(a, b) || within(b, a);
}

}  // namespace

CreaseThresholds crease_thresholds(const Paper& paper) {
  CreaseThresholds thresholds;
  thresholds.yield_curvature = yield_curvature(paper);
  return thresholds;
}

std::vector<DetectedCrease> detect_creases(const Sheet& sheet, const Points3& plastic,
                                           const Pattern& pattern,
                                           const CreaseThresholds& thresholds) {
  const auto at = [&](int v) -> Vector2d { return sheet.pattern.row(v); };
  const double border = 1e-6 * longer_side(pattern);
  std::vector<DetectedCrease> creases;
  for (const Hinge& hinge : find_hinges(sheet.triangles).hinges) {
    const double turn = std::abs(dihedral_angle(sheet.x, hinge));
    if (turn <= thresholds.angle[0]) continue;
    const auto& v = hinge.vertices;
    const PatternEdge edge(sheet, hinge);
    const bool prescribed = is_folded(sheet, v[0], v[1]);
    double plastic_angle = prescribed ? turn : turn - thresholds.yield_curvature * edge.width();
    if (plastic.rows() > 0 && !prescribed)
      plastic_angle = std::abs(edge.turn_of(0.5 * (plastic.row(v[0]) + plastic.row(v[1]))));
    DetectedCrease crease;
    crease.strength = rise(turn, thresholds.angle) * rise(plastic_angle, thresholds.plastic_angle) *
                      std::min(1.0, turn / thresholds.full_angle);
    if (crease.strength <= 0) continue;
    crease.from = at(v[0]);
    crease.to = at(v[1]);
    crease.from_border =
        (nearest_border_point(pattern, crease.from) - crease.from).norm() <= border;
    crease.to_border = (nearest_border_point(pattern, crease.to) - crease.to).norm() <= border;
    creases.push_back(crease);
  }
  return creases;
}

void merge_creases(std::vector<DetectedCrease>& history, const std::vector<DetectedCrease>& now,
                   int frame, double same) {
  const std::size_t known = history.size();
  for (DetectedCrease crease : now) {
    crease.frame_of_birth = frame;
    DetectedCrease* old = nullptr;
    for (std::size_t k = 0; k < known; ++k) {
      if (!may_touch(history[k], crease, same)) continue;
      if (!old && same_place(history[k], crease, same)) old = &history[k];
      if (overlap(history[k], crease, same))
        crease.frame_of_birth = std::min(crease.frame_of_birth, history[k].frame_of_birth);
    }
    if (!old) {
      history.push_back(crease);
    } else if (crease.strength > old->strength) {
      crease.frame_of_birth = std::min(crease.frame_of_birth, old->frame_of_birth);
      *old = crease;
    }
  }
}

}  // namespace paperbake
