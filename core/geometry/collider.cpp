#include "core/geometry/collider.h"

#include "core/geometry/connected_parts.h"
#include "core/geometry/measure.h"
#include "core/geometry/mesh_edges.h"
#include "core/geometry/principal_axes.h"
#include "core/geometry/proximity.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <utility>

namespace paperbake {

namespace {

// An edge counts as flat if it turns less than the first of these, and less than a surface of the
// second as radius turns from facet to facet: a fine mesh bends by many edges that turn little.
constexpr double flat = 0.01, flattest = 10;              // [rad], [m]
constexpr double deepest = 3e-3, deepest_of_open = 1e-3;  // [m] limits of depth()
constexpr double of_thickness = 0.3;  // [1] depth() over the shortest side of a closed mesh's box
constexpr double other_direction = 0.866;  // [1] cosine of 30 degrees
constexpr double coincident = 1e-9;        // [m] for closer points the normal of the mesh is used

Vector3d row(const Points3& x, int v) { return x.row(v).transpose(); }

/// Turns the triangles of a closed mesh so that each of its parts, which may have been modelled
/// inside out, faces outwards; or inwards, where it holds the paper.
void face_outwards(ColliderMesh& mesh) {
  Triangles& triangles = mesh.triangles;
  const std::vector<int> part = connected_parts(triangles, mesh.x.rows());
  std::vector<double> volume(mesh.x.rows(), 0);  // six times that of the part with this number
  for (int t = 0; t < triangles.rows(); ++t)
    volume[part[triangles(t, 0)]] += row(mesh.x, triangles(t, 0))
                                         .cross(row(mesh.x, triangles(t, 1)))
                                         .dot(row(mesh.x, triangles(t, 2)));
  const bool holds_paper = mesh.paper_side == ColliderMesh::PaperSide::inside;
  for (int t = 0; t < triangles.rows(); ++t)
    if ((volume[part[triangles(t, 0)]] < 0) != holds_paper)
      std::swap(triangles(t, 1), triangles(t, 2));
}

/// [m] Sides of the box along the principal axes of the points, the shortest first.
Vector3d sides_of_box(const Points3& x) {
  const Points3 apart = x.rowwise() - x.colwise().mean().eval();
  const Points3 along = apart * principal_axes(x).vectors;
  Vector3d sides = (along.colwise().maxCoeff() - along.colwise().minCoeff()).transpose();
  // a cube has no principal axes of its own: there the box along x, y, z may be smaller
  const Vector3d straight = (x.colwise().maxCoeff() - x.colwise().minCoeff()).transpose();
  if (straight.prod() < sides.prod()) sides = straight;
  std::sort(sides.data(), sides.data() + 3);
  return sides;
}

bool is_closed(const MeshEdges& edges) {
  return std::all_of(edges.begin(), edges.end(), [](const MeshEdge& e) {
    return e.size() == 2 && e[0].forwards != e[1].forwards;
  });
}

}  // namespace

/// The edges of the mesh and, if it moves, the trees over its first shape. Over another shape with
/// the same items a tree is divided in the same way: dividing it anew costs more than all the rest.
struct Collider::FirstShape {
  explicit FirstShape(const Triangles& triangles) : edges(triangles) {}

  MeshEdges edges;
  std::vector<std::array<int, 2>> sharp_edges;
  std::vector<int> corners;
  BoxTree triangle_tree, edge_tree, corner_tree;
};

Collider::Collider(ColliderMesh mesh) : mesh_(std::move(mesh)) {
  if (is_closed(MeshEdges(mesh_.triangles))) face_outwards(mesh_);
  const auto first = std::make_shared<FirstShape>(mesh_.triangles);
  first_ = first;
  prepare();
  if (mesh_.frames.empty()) return;
  first->sharp_edges = ends_of_edges();
  first->corners = vertices_of_corners();
  first->triangle_tree = triangle_tree_;
  first->edge_tree = edge_tree_;
  first->corner_tree = corner_tree_;
}

Collider::Collider(const Collider& other, const Points3& x)
    : mesh_(other.mesh_), first_(other.first_) {
  mesh_.x = x;
  prepare();
}

void Collider::prepare() {
  closed_ = is_closed(first_->edges);
  const Vector3d sides = sides_of_box(mesh_.x);
  depth_ = closed_ ? std::min(deepest, of_thickness * sides[0]) : deepest_of_open;
  find_normals();
  find_corners(first_->edges, find_sharp_edges(first_->edges));
  build_trees();
}

std::vector<std::array<int, 2>> Collider::ends_of_edges() const {
  std::vector<std::array<int, 2>> ends;
  for (const Edge& edge : edges_) ends.push_back({edge.a, edge.b});
  return ends;
}

std::vector<int> Collider::vertices_of_corners() const {
  std::vector<int> vertices;
  for (const Corner& corner : corners_) vertices.push_back(corner.vertex);
  return vertices;
}

void Collider::build_trees() {
  const auto box_of = [&](std::initializer_list<int> vertices) {
    Eigen::AlignedBox3d box;
    for (const int v : vertices) box.extend(row(mesh_.x, v));
    return box;
  };
  const auto make = [](BoxTree& tree, const BoxTree& of_first, bool alike,
                       const std::vector<Eigen::AlignedBox3d>& boxes) {
    if (!alike || of_first.empty()) return tree.build(boxes);
    tree = of_first;
    tree.refit(boxes);
  };
  std::vector<Eigen::AlignedBox3d> boxes;
  for (int t = 0; t < mesh_.triangles.rows(); ++t)
    boxes.push_back(box_of({mesh_.triangles(t, 0), mesh_.triangles(t, 1), mesh_.triangles(t, 2)}));
  make(triangle_tree_, first_->triangle_tree, true, boxes);
  boxes.clear();
  for (const Edge& edge : edges_) boxes.push_back(box_of({edge.a, edge.b}));
  make(edge_tree_, first_->edge_tree, ends_of_edges() == first_->sharp_edges, boxes);
  boxes.clear();
  for (const Corner& corner : corners_) boxes.push_back(box_of({corner.vertex}));
  make(corner_tree_, first_->corner_tree, vertices_of_corners() == first_->corners, boxes);
}

void Collider::find_normals() {
  const Triangles& triangles = mesh_.triangles;
  const Points3& x = mesh_.x;
  const int n = static_cast<int>(triangles.rows());
  face_normal_.resize(n, 3);
  vertex_normal_ = Points3::Zero(x.rows(), 3);
  border_vertex_.assign(x.rows(), 0);
  for (int t = 0; t < n; ++t) {
    const std::array<Vector3d, 3> c{row(x, triangles(t, 0)), row(x, triangles(t, 1)),
                                    row(x, triangles(t, 2))};
    const Vector3d normal = triangle_normal(c[0], c[1], c[2]);
    face_normal_.row(t) = normal;
    for (int i = 0; i < 3; ++i) {
      const Vector3d u = (c[(i + 1) % 3] - c[i]).normalized(),
                     w = (c[(i + 2) % 3] - c[i]).normalized();
      vertex_normal_.row(triangles(t, i)) += std::acos(std::clamp(u.dot(w), -1.0, 1.0)) * normal;
    }
  }
  for (int v = 0; v < x.rows(); ++v)
    if (const double length = vertex_normal_.row(v).norm(); length > 0)
      vertex_normal_.row(v) /= length;
}

std::vector<char> Collider::find_sharp_edges(const MeshEdges& edges) {
  const Triangles& triangles = mesh_.triangles;
  const Points3& x = mesh_.x;
  edge_normal_.resize(triangles.rows());
  border_edge_.assign(triangles.rows(), {0, 0, 0});
  std::vector<char> sharp(x.rows(), 0);
  for (const MeshEdge& sides : edges) {
    const int a = sides.low, b = sides.high;
    Vector3d sum = Vector3d::Zero();
    for (const TriangleSide& s : sides) sum += row(face_normal_, s.triangle);
    const bool border = sides.size() == 1;
    for (const TriangleSide& s : sides) {
      edge_normal_[s.triangle][s.corner] = sum.normalized();
      border_edge_[s.triangle][s.corner] = border;
    }
    const Vector3d along = (row(x, b) - row(x, a)).normalized();
    const auto across = [&](const TriangleSide& s) -> Vector3d {
      const Vector3d to = row(x, triangles(s.triangle, s.corner)) - row(x, a);
      return to - along * along.dot(to);
    };
    const auto inward = [&](const TriangleSide& s) -> Vector3d { return across(s).normalized(); };
    Edge edge{a, b, {inward(sides[0]), -row(face_normal_, sides[0].triangle)}, {}, border};
    if (border) {
      border_vertex_[a] = border_vertex_[b] = 1;
    } else {
      edge.inward[1] = inward(sides[1]);
      const double turns = std::acos(std::clamp(
          face_normal_.row(sides[0].triangle).dot(face_normal_.row(sides[1].triangle)), -1.0, 1.0));
      const bool convex = edge.inward[0].dot(row(face_normal_, sides[1].triangle)) < 0;
      const double apart = std::min(across(sides[0]).norm(), across(sides[1]).norm());
      if (turns < std::min(flat, apart / flattest) || !convex) continue;
    }
    sharp[a] = sharp[b] = 1;
    for (int i = 0; i < 2; ++i) {
      const Vector3d normal = along.cross(edge.inward[i]);
      const double other = normal.dot(edge.inward[1 - i]);
      // none where one of the faces has no area
      edge.outward[i] = other > 0 ? -normal : other < 0 ? normal : Vector3d(Vector3d::Zero());
    }
    edges_.push_back(edge);
  }
  return sharp;
}

void Collider::find_corners(const MeshEdges& edges, const std::vector<char>& sharp) {
  const Points3& x = mesh_.x;
  std::vector<std::vector<Vector3d>> outgoing(x.rows());
  for (const MeshEdge& e : edges) {
    const Vector3d along = (row(x, e.high) - row(x, e.low)).normalized();
    outgoing[e.low].push_back(along);
    outgoing[e.high].push_back(-along);
  }
  for (int v = 0; v < x.rows(); ++v) {
    if (!sharp[v]) continue;
    if (border_vertex_[v]) outgoing[v].push_back(-row(vertex_normal_, v));
    corners_.push_back({v, border_vertex_[v] != 0, outgoing[v]});
  }
}

Collider::OnTriangle Collider::on_triangle(const Vector3d& p, int t) const {
  const std::array<int, 3> v{mesh_.triangles(t, 0), mesh_.triangles(t, 1), mesh_.triangles(t, 2)};
  const ClosestPoints near =
      vertex_to_triangle({p, row(mesh_.x, v[0]), row(mesh_.x, v[1]), row(mesh_.x, v[2])});
  int zeros = 0, zero = -1, corner = -1;
  for (int i = 0; i < 3; ++i) near.weights[1 + i] == 0 ? (++zeros, zero = i) : corner = i;
  OnTriangle on{p - near.apart, near.apart, row(face_normal_, t), false};
  if (zeros == 1) {
    on.pseudo_normal = edge_normal_[t][zero];
    on.border = border_edge_[t][zero];
  }
  if (zeros == 2) {
    on.pseudo_normal = row(vertex_normal_, v[corner]);
    on.border = border_vertex_[v[corner]];
  }
  return on;
}

SurfacePoint Collider::surface_point(int t, const OnTriangle& on, int side) const {
  const auto& [at, apart, pseudo_normal, border] = on;
  const double d = apart.norm();
  // beyond the border of an open mesh there is neither front nor back
  const double sign = border && std::abs(apart.dot(row(face_normal_, t))) < 0.999 * d
                          ? 1
                          : side * (apart.dot(pseudo_normal) < 0 ? -1 : 1);
  return {at, d < coincident ? Vector3d(side * pseudo_normal) : Vector3d(sign / d * apart),
          sign * d, t, border};
}

std::vector<SurfacePoint> Collider::nearest(const Vector3d& p, const std::vector<int>& triangles,
                                            int side) const {
  std::vector<SurfacePoint> found;
  std::vector<OnTriangle> all;
  all.reserve(triangles.size());
  std::size_t first = 0;
  for (const int t : triangles) {
    all.push_back(on_triangle(p, t));
    if (all.back().apart.squaredNorm() < all[first].apart.squaredNorm()) first = all.size() - 1;
  }
  if (all.empty()) return found;
  found.push_back(surface_point(triangles[first], all[first], side));
  for (std::size_t k = 0; k < all.size(); ++k) {
    const double distance = all[k].apart.norm();
    if (distance < coincident ||
        side * all[k].apart.dot(row(face_normal_, triangles[k])) < 0.5 * distance)
      continue;
    const Vector3d n = all[k].apart / distance;
    const bool known = std::any_of(found.begin(), found.end(), [&](const SurfacePoint& s) {
      return s.normal.dot(n) > other_direction;
    });
    if (!known) found.push_back({all[k].at, n, distance, triangles[k]});
  }
  return found;
}

SurfacePoint Collider::nearest(const Vector3d& p, double within, int side) const {
  OnTriangle best{};
  int nearest = -1;
  double least = std::numeric_limits<double>::infinity();  // [m2]
  triangle_tree_.visit_nearest(p, within, [&](int t) {
    const OnTriangle on = on_triangle(p, t);
    const double squared = on.apart.squaredNorm();
    if (squared < least || (squared == least && t < nearest)) {
      best = on;
      nearest = t;
      least = squared;
    }
    return std::sqrt(squared);
  });
  if (nearest < 0 || !(std::sqrt(least) <= within))
    return {p, Vector3d::UnitZ(), std::numeric_limits<double>::infinity()};
  return surface_point(nearest, best, side);
}

int Collider::side_of(const Vector3d& p, double within) const {
  return !closed_ && nearest(p, within, 1).distance < -depth_ ? -1 : 1;
}

int Collider::side_of(const Vector3d& p, const Vector3d& known, double within) const {
  constexpr double pressed = 1e-4;  // [m] less deep behind the front it need not have come round
  if (closed_) return 1;
  if (const int side = passes_through(known, p); side != 0) return side;
  return nearest(p, within, 1).distance < -pressed ? -1 : side_of(known, within);
}

int Collider::passes_through(const Vector3d& p, const Vector3d& q) const {
  constexpr double rounding = 1e-9;  // [m] edges belong to both triangles
  double first = 2;                  // [1] of the way
  int side = 0;
  triangle_tree_.visit(Eigen::AlignedBox3d(p).extend(q), [&](int t) {
    const Vector3d a = row(mesh_.x, mesh_.triangles(t, 0)), normal = row(face_normal_, t);
    const double before = normal.dot(p - a), after = normal.dot(q - a);
    if ((before < 0) == (after < 0)) return;
    const double at = before / (before - after);
    if (at < first && on_triangle(p + at * (q - p), t).apart.norm() < rounding) {
      first = at;
      side = before < 0 ? -1 : 1;
    }
  });
  return side;
}

}  // namespace paperbake
