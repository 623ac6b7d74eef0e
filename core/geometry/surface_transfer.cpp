#include "core/geometry/surface_transfer.h"

#include "core/geometry/mesh_edges.h"
#include "core/geometry/point_location.h"
#include "core/model/segment2.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace paperbake {
namespace {

/// How far apart the values of two corners may be that are one. Uv sets are of the order of 1; the
/// others may be in any unit.
double tolerance_of(const AuthoredAttribute& attribute) {
  // [1] of the largest; whole numbers up to 5 million are told apart
  constexpr double same_uv = 1e-6, same_value = 2e-7;
  const double largest = attribute.values.size() > 0 ? attribute.values.cwiseAbs().maxCoeff() : 0.0;
  return attribute.kind == AttributeKind::uv ? same_uv * std::max(1.0, largest)
                                             : same_value * largest;
}

/// The two triangles beside an inner edge, and which of their corners are its ends.
struct Beside {
  int triangle[2], at_a[2], at_b[2];
};

std::vector<Beside> inner_edges(const Triangles& triangles) {
  std::vector<Beside> found;
  for (const MeshEdge& e : MeshEdges(triangles)) {
    if (e.size() != 2 || e[0].forwards == e[1].forwards) continue;
    const TriangleSide &there = e[!e[0].forwards], &back = e[e[0].forwards];
    const auto after = [](const TriangleSide& side, int k) { return (side.corner + k) % 3; };
    found.push_back({{there.triangle, back.triangle},
                     {after(there, 1), after(back, 2)},
                     {after(there, 2), after(back, 1)}});
  }
  return found;
}

/// Whether an attribute has one value on both sides of an edge.
/// near  its tolerance
bool agrees(const AuthoredAttribute& attribute, double near, const Beside& e) {
  const auto at = [&](int side, int corner) {
    return attribute.values.row(3 * e.triangle[side] + corner);
  };
  const auto same = [&](const int(&corner)[2]) {
    return (at(0, corner[0]) - at(1, corner[1])).norm() <= near;
  };
  return same(e.at_a) && same(e.at_b);
}

/// Where the corners of the triangles of another mesh lie on the authored one. A corner on an edge
/// of that lies on the side of its own triangle.
struct CornerPlaces {
  std::vector<MeshPoint> corners;  // 3|T|
  std::vector<int> centres;        // |T| authored triangle at the centre
};

/// Barycentric coordinates of p in a triangle, also outside it.
Vector3d weights_in(const AuthoredSurface& authored, int triangle, const Vector2d& p) {
  const auto corner = [&](int k) {
    return Vector2d(authored.pattern.row(authored.triangles(triangle, k)));
  };
  return barycentric(p, corner(0), corner(1), corner(2));
}

CornerPlaces places_on(const AuthoredSurface& authored, const Points2& pattern,
                       const Triangles& triangles) {
  constexpr double inwards = 1e-4;  // of the way to the centre
  constexpr double on_edge =
      1e-6;  // of the authored triangle: the point is on its border or inside
  const PointLocator locator(authored.pattern, authored.triangles);
  CornerPlaces places;
  for (int t = 0; t < triangles.rows(); ++t) {
    Vector2d centre(0, 0);
    for (int k = 0; k < 3; ++k) centre += pattern.row(triangles(t, k)).transpose() / 3;
    places.centres.push_back(locator.locate(centre).triangle);
    for (int k = 0; k < 3; ++k) {
      const Vector2d p = pattern.row(triangles(t, k));
      const int beside = locator.locate(p + inwards * (centre - p)).triangle;
      const Vector3d weights = weights_in(authored, beside, p);
      places.corners.push_back(weights.minCoeff() > -on_edge ? MeshPoint{beside, weights}
                                                             : locator.locate(p));
    }
  }
  return places;
}

MeshSurface::Attribute on_corners(const AuthoredAttribute& attribute, const CornerPlaces& places,
                                  const Triangles& triangles) {
  using Value = Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, 4>;
  const double near = tolerance_of(attribute);
  MeshSurface::Attribute found{attribute.name, attribute.kind, {}, Triangles(triangles.rows(), 3)};
  std::vector<Value> values;
  std::map<int, std::vector<int>> of_vertex;  // rows of values
  for (int t = 0; t < triangles.rows(); ++t)
    for (int k = 0; k < 3; ++k) {
      const MeshPoint& place = places.corners[3 * static_cast<std::size_t>(t) + k];
      const auto at = [&](int corner) {
        return place.weights[corner] * attribute.values.row(3 * place.triangle + corner);
      };
      const Value value = at(0) + at(1) + at(2);
      std::vector<int>& known = of_vertex[triangles(t, k)];
      const auto same = std::find_if(known.begin(), known.end(),
                                     [&](int row) { return (values[row] - value).norm() <= near; });
      if (same == known.end()) {
        known.push_back(static_cast<int>(values.size()));
        values.push_back(value);
        found.of_corner(t, k) = known.back();
      } else {
        found.of_corner(t, k) = *same;
      }
    }
  found.values.resize(static_cast<Eigen::Index>(values.size()), attribute.values.cols());
  for (std::size_t i = 0; i < values.size(); ++i)
    found.values.row(static_cast<Eigen::Index>(i)) = values[i];
  return found;
}

/// Segments of the same mesh, with those joined that go on straight at a vertex of no other one.
std::vector<std::pair<int, int>> joined(std::vector<std::pair<int, int>> segments,
                                        const Points2& pattern) {
  constexpr double straight = 1e-6;  // [rad]
  std::map<int, std::vector<std::size_t>> at;
  for (std::size_t s = 0; s < segments.size(); ++s)
    for (const int v : {segments[s].first, segments[s].second}) at[v].push_back(s);
  for (auto& [v, meeting] : at) {
    if (meeting.size() != 2) continue;
    auto &first = segments[meeting[0]], &second = segments[meeting[1]];
    const int a = first.first == v ? first.second : first.first,
              b = second.first == v ? second.second : second.first;
    const Vector2d in = (pattern.row(v) - pattern.row(a)).normalized(),
                   out = (pattern.row(b) - pattern.row(v)).normalized();
    if (in.dot(out) < 0 || std::abs(cross(in, out)) > straight) continue;
    std::vector<std::size_t>& at_b = at[b];
    std::replace(at_b.begin(), at_b.end(), meeting[1], meeting[0]);
    first = {a, b};
    second = {-1, -1};
  }
  segments.erase(std::remove(segments.begin(), segments.end(), std::pair(-1, -1)), segments.end());
  return segments;
}

/// What has two values along an edge.
struct Jumps {
  bool uv_or_material = false, other = false;
};

/// The lines of edges whose jumps are as wanted, as their ends on the pattern.
template <class Wanted>
std::vector<std::pair<Vector2d, Vector2d>> lines_of(const AuthoredSurface& authored,
                                                    const Wanted& wanted) {
  if (authored.attributes.empty() && authored.material_of.empty()) return {};
  std::vector<double> near;
  for (const AuthoredAttribute& attribute : authored.attributes)
    near.push_back(tolerance_of(attribute));
  std::vector<std::pair<int, int>> edges;
  for (const Beside& e : inner_edges(authored.triangles)) {
    Jumps jumps;
    jumps.uv_or_material = !authored.material_of.empty() && authored.material_of[e.triangle[0]] !=
                                                                authored.material_of[e.triangle[1]];
    for (std::size_t i = 0; i < near.size(); ++i)
      if (!agrees(authored.attributes[i], near[i], e))
        (authored.attributes[i].kind == AttributeKind::uv ? jumps.uv_or_material : jumps.other) =
            true;
    if (!wanted(jumps)) continue;
    edges.emplace_back(authored.triangles(e.triangle[0], e.at_a[0]),
                       authored.triangles(e.triangle[0], e.at_b[0]));
  }
  std::vector<std::pair<Vector2d, Vector2d>> found;
  for (const auto& [a, b] : joined(std::move(edges), authored.pattern))
    found.emplace_back(authored.pattern.row(a), authored.pattern.row(b));
  return found;
}

}  // namespace

std::vector<std::pair<Vector2d, Vector2d>> seams(const AuthoredSurface& authored) {
  return lines_of(authored, [](const Jumps& jumps) { return jumps.uv_or_material; });
}

std::vector<std::pair<Vector2d, Vector2d>> jumps(const AuthoredSurface& authored) {
  return lines_of(authored,
                  [](const Jumps& jumps) { return jumps.other && !jumps.uv_or_material; });
}

MeshSurface surface_on(const AuthoredSurface& authored, const Points2& pattern,
                       const Triangles& triangles) {
  MeshSurface found;
  found.materials = authored.materials;
  found.properties = authored.properties;
  if (authored.attributes.empty() && authored.material_of.empty()) return found;
  const CornerPlaces places = places_on(authored, pattern, triangles);
  for (const AuthoredAttribute& attribute : authored.attributes)
    found.attributes.push_back(on_corners(attribute, places, triangles));
  if (!authored.material_of.empty())
    for (const int triangle : places.centres)
      found.material_of.push_back(authored.material_of[triangle]);
  return found;
}

}  // namespace paperbake
