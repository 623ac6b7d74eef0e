#include "core/render/crease_rows.h"

#include "core/model/segment2.h"

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

constexpr double spacing = 0.66;  // [edges] largest distance of neighbouring points of a crease
// [edges] distance that the points of a crease keep from a border along which it runs
constexpr double from_border = 0.15;
// [edges] how far a point of another crease may lie beside a crease that goes through it. Where
// creases fan out from a singular point, farther ones would lead it along its neighbour, and sharp
// folds would cut through triangles.
constexpr double beside_line = 0.1;

/// Where segment a crosses segment b: fraction of a in (0, 1); negative: nowhere.
double crossing(const CreaseSegment& a, const CreaseSegment& b) {
  const std::optional<LinesMeet> meet = where_lines_meet({a.a, a.b - a.a}, {b.a, b.b - b.a}, 1e-6);
  if (!meet) return -1;
  const auto [s, t] = *meet;
  return s > 0 && s < 1 && t >= 0 && t <= 1 ? s : -1;
}

/// The point of the nearest of these lines, where one is nearer than `reach` [m]; else p itself.
Vector2d onto_a_line(const Vector2d& p, const std::vector<CreaseSegment>& lines, double reach) {
  Vector2d onto = p;
  for (const CreaseSegment& line : lines) {
    const Vector2d q = nearest_on_segment(p, line.a, line.b);
    if ((q - p).norm() >= reach) continue;
    reach = (q - p).norm();
    onto = q;
  }
  return onto;
}

}  // namespace

std::vector<CreaseSegment> chosen_creases(std::vector<CreaseSegment> creases, double room,
                                          double edge, const std::vector<CreaseSegment>& lines) {
  std::stable_sort(
      creases.begin(), creases.end(),
      [](const CreaseSegment& a, const CreaseSegment& b) { return a.weight > b.weight; });
  const double beside = 0.5 * edge;
  std::vector<CreaseSegment> taken;
  const auto lies_beside = [&](const CreaseSegment& c, const std::vector<CreaseSegment>& others) {
    return std::any_of(others.begin(), others.end(), [&](const CreaseSegment& other) {
      return distance_to_segment(c.a, other.a, other.b) < beside &&
             distance_to_segment(c.b, other.a, other.b) < beside;
    });
  };
  double length = 0;
  for (const CreaseSegment& c : creases) {
    if (lies_beside(c, taken) || lies_beside(c, lines)) continue;
    length += (c.b - c.a).norm();
    if (length > room) break;
    taken.push_back(c);
  }
  return taken;
}

std::vector<CreaseSegment> segments_of(const std::vector<PrescribedCrease>& prescribed) {
  std::vector<CreaseSegment> segments;
  for (const PrescribedCrease& crease : prescribed)
    for (std::size_t k = 0; k + 1 < crease.line.size(); ++k)
      segments.push_back({crease.line[k], crease.line[k + 1]});
  return segments;
}

std::vector<int> lay(const CreaseSegment& crease, const std::vector<CreaseSegment>& all,
                     const std::vector<CreaseSegment>& lines, const Pattern& pattern, double edge,
                     Sites& sites) {
  std::vector<double> stops{0, 1};
  for (const auto* others : {&all, &lines})
    for (const CreaseSegment& other : *others) {
      const double at = crossing(crease, other);
      if (at > 0) stops.push_back(at);
    }
  std::sort(stops.begin(), stops.end());
  const Vector2d d = crease.b - crease.a;
  std::vector<int> row;
  const auto put = [&](double t, bool end) {
    Vector2d p = onto_a_line(crease.a + t * d, lines, merged_within * edge);
    const Vector2d border = nearest_border_point(pattern, p);
    if ((border - p).norm() < (end ? merged_within : from_border) * edge || !contains(pattern, p)) {
      if (!end && sites.nearest(p) < 0) return;
      if (end) p = border;
    }
    const int known = sites.nearest(p);
    if (!end && known >= 0 &&
        distance_to_segment(sites.points[known], crease.a, crease.b) > beside_line * edge)
      return;
    row.push_back(known >= 0 ? known : sites.add(p));
  };
  put(0, true);
  for (std::size_t k = 0; k + 1 < stops.size(); ++k) {
    const int parts =
        static_cast<int>(std::ceil((stops[k + 1] - stops[k]) * d.norm() / (spacing * edge) - 1e-9));
    for (int i = 1; i <= parts; ++i)
      put(stops[k] + (stops[k + 1] - stops[k]) * i / parts, i == parts);
  }
  return row;
}

}  // namespace paperbake
