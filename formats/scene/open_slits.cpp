#include "formats/scene/open_slits.h"

#include "core/geometry/measure.h"
#include "core/geometry/mesh_edges.h"
#include "core/model/segment2.h"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

namespace paperbake {
namespace {

// half of the width of a slit that was opened: [1] of the longer side, and at most, so that no edge
// changes its length by much, of the edges there
constexpr double half_width = 1e-4, share_of_edges = 0.005;

/// A border edge, with the paper on its left.
struct BorderEdge {
  int from, to;
  Vector2d a, b, along;  // [m] its ends, and its direction, of length 1

  Vector2d left() const { return {-along.y(), along.x()}; }
};

/// Whether two border edges run along each other in opposite directions, within `near` [m].
bool lie_on_each_other(const BorderEdge& e, const BorderEdge& f, double near) {
  constexpr double opposite = -0.999;  // [1] cosine
  if (e.along.dot(f.along) > opposite) return false;
  const double from = std::max(0.0, e.along.dot(f.b - e.a)),
               to = std::min((e.b - e.a).norm(), e.along.dot(f.a - e.a));
  if (to - from <= near) return false;
  const Vector2d middle = e.a + 0.5 * (from + to) * e.along;
  return distance_to_segment(middle, f.a, f.b) <= near;
}

/// [m] The shortest edge at each vertex.
std::vector<double> shortest_edges(const Points2& flat, const MeshEdges& edges) {
  std::vector<double> shortest(flat.rows(), std::numeric_limits<double>::infinity());
  for (const MeshEdge& edge : edges) {
    const double length = (flat.row(edge.high) - flat.row(edge.low)).norm();
    for (const int v : {edge.low, edge.high}) shortest[v] = std::min(shortest[v], length);
  }
  return shortest;
}

}  // namespace

void open_slits(Points2& flat, const Triangles& triangles) {
  const MeshEdges edges(triangles);
  std::vector<BorderEdge> border;
  for (const auto& [from, to] : border_of(edges)) {
    const Vector2d a = flat.row(from), b = flat.row(to);
    if (a != b) border.push_back({from, to, a, b, (b - a).normalized()});
  }
  // edges that run along each other overlap in x: only those have to be compared
  std::sort(border.begin(), border.end(), [](const BorderEdge& e, const BorderEdge& f) {
    return std::pair(std::min(e.a.x(), e.b.x()), e.from) <
           std::pair(std::min(f.a.x(), f.b.x()), f.from);
  });
  const double width = half_width * longer_side(flat);
  std::vector<char> is_tip(flat.rows(), 0);
  Points2 inwards = Points2::Zero(flat.rows(), 2);
  for (std::size_t i = 0; i < border.size(); ++i)
    for (std::size_t j = i + 1; j < border.size(); ++j) {
      const BorderEdge &e = border[i], &f = border[j];
      if (std::min(f.a.x(), f.b.x()) > std::max(e.a.x(), e.b.x()) + width) break;
      if (!lie_on_each_other(e, f, width)) continue;
      if (e.to == f.from) is_tip[e.to] = 1;
      if (f.to == e.from) is_tip[f.to] = 1;
      for (const BorderEdge* edge : {&e, &f})
        for (const int v : {edge->from, edge->to}) inwards.row(v) += edge->left().transpose();
    }
  constexpr double some = 1e-6;  // the sides of a wedge nearly cancel each other
  const std::vector<double> shortest = shortest_edges(flat, edges);
  for (int v = 0; v < flat.rows(); ++v)
    if (!is_tip[v] && inwards.row(v).norm() > some)
      flat.row(v) += std::min(width, share_of_edges * shortest[v]) * inwards.row(v).normalized();
}

}  // namespace paperbake
