#include "core/geometry/prescribed_creases.h"

#include "core/model/segment2.h"

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

constexpr double rounding = 1e-6;  // [1] of the length of an edge

}  // namespace

const PrescribedCrease* crease_under(const std::vector<PrescribedCrease>& folds, const Vector2d& a,
                                     const Vector2d& b) {
  for (const PrescribedCrease& fold : folds)
    for (std::size_t k = 0; k + 1 < fold.line.size(); ++k)
      if (is_part({a, b}, {fold.line[k], fold.line[k + 1]})) return &fold;
  return nullptr;
}

bool is_part(const Segment2& edge, const Segment2& line) {
  const double near = rounding * (edge.b - edge.a).norm();
  return distance_to_segment(edge.a, line.a, line.b) <= near &&
         distance_to_segment(edge.b, line.a, line.b) <= near;
}

bool is_on_crease(const std::vector<PrescribedCrease>& folds, const Points2& pattern, int a,
                  int b) {
  return !folds.empty() && crease_under(folds, pattern.row(a), pattern.row(b));
}

CreaseEdge crease_edge(const Sheet& sheet, const PrescribedCrease& crease, const Vector2d& a,
                       const Vector2d& b) {
  const Vector2d d = b - a;
  const double length = d.norm(), near = rounding * length;
  CreaseEdge edge{a, b, crease.angle, crease.folded, {}};
  double known = 0, sum = 0;  // [1] share of the edge, and the rest angle over it
  bool folded = false;
  for (const CreaseEdge& part : sheet.crease_edges) {
    if (std::abs(cross(d, part.a - a)) > near * length ||
        std::abs(cross(d, part.b - a)) > near * length)
      continue;
    const double from = (part.a - a).dot(d) / (length * length),
                 to = (part.b - a).dot(d) / (length * length);
    const double share = std::min(1.0, std::max(from, to)) - std::max(0.0, std::min(from, to));
    if (share <= 1e-6) continue;
    known += share;
    sum += share * part.rest_angle;

    folded |= part.folded;
    if (part.pressed) edge.pressed = part.pressed;
  }
  if (known > 0) {
    edge.rest_angle = sum / known;
    edge.folded = folded;
  }
  return edge;
}

bool is_folded(const Sheet& sheet, int a, int b) {
  if (sheet.prescribed_creases.empty()) return false;
  const Vector2d p = sheet.pattern.row(a), q = sheet.pattern.row(b);
  const PrescribedCrease* crease = crease_under(sheet.prescribed_creases, p, q);
  return crease && crease_edge(sheet, *crease, p, q).folded;
}

std::vector<bool> which_are_folded(const Sheet& sheet) {
  std::vector<bool> folded;
  for (const PrescribedCrease& crease : sheet.prescribed_creases)
    folded.push_back(crease.folded ||
                     std::any_of(sheet.crease_edges.begin(), sheet.crease_edges.end(),
                                 [&](const CreaseEdge& edge) {
                                   return edge.folded && crease_under({crease}, edge.a, edge.b);
                                 }));
  return folded;
}

std::vector<PrescribedCrease> folded_creases(const Sheet& sheet) {
  std::vector<PrescribedCrease> creases;
  const std::vector<bool> folded = which_are_folded(sheet);
  for (std::size_t k = 0; k < folded.size(); ++k)
    if (folded[k]) creases.push_back(sheet.prescribed_creases[k]);
  return creases;
}

std::vector<const PrescribedCrease*> crease_of_hinges(const Sheet& sheet, const Hinges& hinges) {
  std::vector<const PrescribedCrease*> lines;
  if (sheet.prescribed_creases.empty()) return lines;
  for (const Hinge& hinge : hinges.hinges)
    lines.push_back(crease_under(sheet.prescribed_creases, sheet.pattern.row(hinge.vertices[0]),
                                 sheet.pattern.row(hinge.vertices[1])));
  return lines;
}

std::vector<Vector2d> crease_points(const std::vector<PrescribedCrease>& folds) {
  std::vector<Vector2d> stops;
  std::vector<Segment2> segments;
  for (const PrescribedCrease& fold : folds) {
    stops.insert(stops.end(), fold.line.begin(), fold.line.end());
    for (std::size_t k = 0; k + 1 < fold.line.size(); ++k)
      segments.push_back({fold.line[k], fold.line[k + 1]});
  }
  for (std::size_t i = 0; i < segments.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Segment2& one = segments[i];
      const std::optional<LinesMeet> meet =
          where_lines_meet(line_through(one), line_through(segments[j]), 1e-9);
      if (!meet) continue;
      const auto [s, t] = *meet;
      if (s >= 0 && s <= 1 && t >= 0 && t <= 1) stops.push_back(one.a + s * (one.b - one.a));
    }
  return stops;
}

}  // namespace paperbake
