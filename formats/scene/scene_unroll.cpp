#include "formats/scene/scene_unroll.h"

#include "core/geometry/measure.h"
#include "core/model/degrees.h"
#include "core/model/error.h"
#include "core/model/segment2.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <utility>

namespace paperbake {
namespace {

// relative change of an edge's length: more would stretch the paper before it moves
constexpr double max_edge_change = 0.01;

double twice_area(const Points2& p, int a, int b, int c) {
  const Vector2d ab = (p.row(b) - p.row(a)).transpose(), ac = (p.row(c) - p.row(a)).transpose();
  return cross(ab, ac);
}

template <class Visit>
void for_each_corner(const Triangles& triangles, Visit visit) {
  for (int t = 0; t < triangles.rows(); ++t)
    for (int k = 0; k < 3; ++k)
      visit(t, triangles(t, k), triangles(t, (k + 1) % 3), triangles(t, (k + 2) % 3));
}

/// Largest relative difference of an edge's length on the flat shape from that in space.
double worst_stretch(const WeldedMesh& mesh, const Points2& flat) {
  double worst = 0;
  for_each_corner(mesh.triangles, [&](int, int a, int b, int) {
    const double in_space = (mesh.x.row(a) - mesh.x.row(b)).norm();
    worst = std::max(worst, std::abs((flat.row(a) - flat.row(b)).norm() - in_space) / in_space);
  });
  return worst;
}

/// Number of triangles that are clockwise in the flat shape.
int clockwise_triangles(const Triangles& triangles, const Points2& flat) {
  int count = 0;
  for (int t = 0; t < triangles.rows(); ++t)
    count += twice_area(flat, triangles(t, 0), triangles(t, 1), triangles(t, 2)) <= 0;
  return count;
}

std::map<std::pair<int, int>, int> triangle_left_of(const Triangles& triangles) {
  std::map<std::pair<int, int>, int> left;
  for_each_corner(triangles, [&](int t, int a, int b, int) { left[{a, b}] = t; });
  return left;
}

struct AngleDefect {
  double degrees = 0;
  int vertex = 0;
};

/// The angle defect of largest magnitude: 360 degrees minus the sum of the angles around an inner
/// vertex. It is 0 where the surface can be laid flat.
AngleDefect worst_angle_defect(const WeldedMesh& mesh) {
  std::vector<double> angle(mesh.x.rows(), 0);
  std::vector<bool> border(mesh.x.rows(), false);
  const auto left = triangle_left_of(mesh.triangles);
  for_each_corner(mesh.triangles, [&](int, int a, int b, int c) {
    const Vector3d ab = mesh.x.row(b) - mesh.x.row(a), ac = mesh.x.row(c) - mesh.x.row(a);
    angle[a] += angle_between(ab, ac);
    if (!left.count({b, a})) border[a] = border[b] = true;
  });
  AngleDefect worst;
  for (int v = 0; v < mesh.x.rows(); ++v) {
    const double degrees = degrees_of(2 * M_PI - angle[v]);
    if (!border[v] && std::abs(degrees) > std::abs(worst.degrees)) worst = {degrees, v};
  }
  return worst;
}

/// Position of the third corner of a triangle, left of a -> b, by its lengths in space.
Vector2d third_corner(const WeldedMesh& mesh, const Points2& flat, int a, int b, int c) {
  const Vector3d ab = mesh.x.row(b) - mesh.x.row(a), ac = mesh.x.row(c) - mesh.x.row(a);
  const double along = ac.dot(ab) / ab.norm(), across = ab.cross(ac).norm() / ab.norm();
  const Vector2d direction = (flat.row(b) - flat.row(a)).transpose().normalized();
  return flat.row(a).transpose() + along * direction +
         across * Vector2d(-direction.y(), direction.x());
}

/// The triangle nearest to the centre: starting there keeps rounding errors smallest.
int middle_triangle(const WeldedMesh& mesh) {
  const Vector3d middle = mesh.x.colwise().mean();
  int nearest = 0;
  double nearest_distance = 1e300;
  for (int t = 0; t < mesh.triangles.rows(); ++t) {
    const auto corner = [&](int k) { return mesh.x.row(mesh.triangles(t, k)).transpose(); };
    const double distance = ((corner(0) + corner(1) + corner(2)) / 3 - middle).norm();
    if (distance < nearest_distance) {
      nearest_distance = distance;
      nearest = t;
    }
  }
  return nearest;
}

Points2 unfold(const WeldedMesh& mesh) {
  Points2 flat = Points2::Zero(mesh.x.rows(), 2);
  std::vector<bool> placed(mesh.x.rows(), false), reached(mesh.triangles.rows(), false);
  const auto left = triangle_left_of(mesh.triangles);
  const int first = middle_triangle(mesh), a = mesh.triangles(first, 0),
            b = mesh.triangles(first, 1);
  flat(b, 0) = (mesh.x.row(b) - mesh.x.row(a)).norm();
  placed[a] = placed[b] = true;
  // breadth first over edges whose ends are placed: the triangle on their left is next
  std::deque<std::pair<int, int>> edges = {{a, b}};
  while (!edges.empty()) {
    const auto [from, to] = edges.front();
    edges.pop_front();
    const auto next = left.find({from, to});
    if (next == left.end() || reached[next->second]) continue;
    reached[next->second] = true;
    const int third = mesh.triangles.row(next->second).sum() - from - to;
    if (!placed[third]) flat.row(third) = third_corner(mesh, flat, from, to, third);
    placed[third] = true;
    for (const auto& edge : {std::pair(third, to), std::pair(from, third), std::pair(to, from)})
      edges.push_back(edge);
  }
  return flat;
}

}  // namespace

bool keeps_lengths(const WeldedMesh& mesh, const Points2& flat) {
  return worst_stretch(mesh, flat) <= max_edge_change;
}

std::optional<Points2> pattern_from_uv(const WeldedMesh& mesh) {
  if (mesh.uv.rows() == 0) return std::nullopt;
  double both = 0, uv2 = 0;
  for_each_corner(mesh.triangles, [&](int, int a, int b, int) {
    const double uv = (mesh.uv.row(a) - mesh.uv.row(b)).norm();
    both += uv * (mesh.x.row(a) - mesh.x.row(b)).norm();
    uv2 += uv * uv;
  });
  if (uv2 == 0) return std::nullopt;
  Points2 flat = both / uv2 * mesh.uv;
  const int clockwise = clockwise_triangles(mesh.triangles, flat);
  if (clockwise == mesh.triangles.rows())
    flat.col(0) *= -1;
  else if (clockwise > 0)
    return std::nullopt;
  if (!keeps_lengths(mesh, flat)) return std::nullopt;
  return flat;
}

Points2 unrolled(const WeldedMesh& mesh, const std::string& place) {
  const Points2 flat = unfold(mesh);
  const double stretch = worst_stretch(mesh, flat);
  if (stretch <= max_edge_change && clockwise_triangles(mesh.triangles, flat) == 0) return flat;
  const AngleDefect defect = worst_angle_defect(mesh);
  // developable at every vertex, but it cannot be laid flat: it is a closed strip
  if (std::abs(defect.degrees) < 0.5)
    throw Error(ErrorCode::scene, place,
                "The sheet closes on itself and cannot be laid flat in one piece.",
                "Cut the mesh along a seam, or give it UVs that are cut there.");
  const Vector3d at = mesh.x.row(defect.vertex);
  throw Error(
      ErrorCode::scene, place,
      fmt::format("The sheet is not developable: when laid flat, an edge changes by {:.3g} %; "
                  "the worst angle defect is {:.3g} degrees, "
                  "at ({:.4g}, {:.4g}, {:.4g}) m.",
                  100 * stretch, defect.degrees, at.x(), at.y(), at.z()),
      "Model the sheet flat, or bent without stretch like a cylinder or a cone, or give it "
      "the UVs of the flat shape.");
}

}  // namespace paperbake
