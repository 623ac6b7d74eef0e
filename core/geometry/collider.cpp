#include "core/geometry/collider.h"

#include "core/geometry/mesh_edges.h"
#include "core/geometry/principal_axes.h"
#include "core/geometry/proximity.h"
#include "core/model/serializer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace paperbake {

namespace {

constexpr double flat = 0.01;  // [rad] an edge with a smaller dihedral angle counts as flat
constexpr double deepest = 3e-3, deepest_of_open = 1e-3;  // [m] limits of depth()
constexpr double of_thickness = 0.3;  // [1] depth() over the shortest side of a closed mesh's box
constexpr double other_direction = 0.866;  // [1] cosine of 30 degrees

Vector3d row(const Points3& x, int v) { return x.row(v).transpose(); }

double volume(const Points3& x, const Triangles& triangles) {
  double six = 0;
  for (int t = 0; t < triangles.rows(); ++t)
    six += row(x, triangles(t, 0)).cross(row(x, triangles(t, 1))).dot(row(x, triangles(t, 2)));
  return six / 6;
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

void Collider::Tree::build(std::vector<Eigen::AlignedBox3d> boxes) {
  nodes_.clear();
  std::vector<int> items(boxes.size());
  std::iota(items.begin(), items.end(), 0);
  if (!items.empty()) build(items, 0, static_cast<int>(items.size()), boxes);
}

int Collider::Tree::build(std::vector<int>& items, int begin, int end,
                          const std::vector<Eigen::AlignedBox3d>& boxes) {
  const int at = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  Eigen::AlignedBox3d box;
  for (int k = begin; k < end; ++k) box.extend(boxes[items[k]]);
  nodes_[at].box = box;
  if (end - begin == 1) {
    nodes_[at].item = items[begin];
    return at;
  }
  int axis = 0;
  box.sizes().maxCoeff(&axis);
  const int middle = (begin + end) / 2;
  std::nth_element(items.begin() + begin, items.begin() + middle, items.begin() + end,
                   [&](int a, int b) {
                     const double ca = boxes[a].min()[axis] + boxes[a].max()[axis],
                                  cb = boxes[b].min()[axis] + boxes[b].max()[axis];
                     return ca != cb ? ca < cb : a < b;
                   });
  const int left = build(items, begin, middle, boxes), right = build(items, middle, end, boxes);
  nodes_[at].left = left;
  nodes_[at].right = right;
  return at;
}

void Collider::Tree::visit(const Eigen::AlignedBox3d& box,
                           const std::function<void(int)>& visit) const {
  if (nodes_.empty()) return;
  std::array<int, 64> open;
  int top = 0;
  open[top++] = 0;
  while (top > 0) {
    const Node& node = nodes_[open[--top]];
    if (!node.box.intersects(box)) continue;
    if (node.item >= 0)
      visit(node.item);
    else {
      open[top++] = node.right;
      open[top++] = node.left;
    }
  }
}

Collider::Collider(ColliderMesh mesh) : mesh_(std::move(mesh)) {
  frames_ = std::make_shared<const std::vector<Points3>>(std::move(mesh_.frames));
  mesh_.frames.clear();
  prepare();
}

Collider::Collider(const Collider& other, const Points3& x)
    : mesh_{other.mesh_.name,      x, other.mesh_.triangles, {}, other.mesh_.friction,
            other.mesh_.paper_side},
      frames_(other.frames_) {
  prepare();
}

ColliderMesh Collider::mesh_with_frames() const {
  ColliderMesh mesh = mesh_;
  mesh.frames = frames();
  return mesh;
}

void Collider::prepare() {
  Triangles& triangles = mesh_.triangles;
  const Points3& x = mesh_.x;
  closed_ = is_closed(MeshEdges(triangles));
  const bool holds_paper = mesh_.paper_side == ColliderMesh::PaperSide::inside;
  if (closed_ && (volume(x, triangles) < 0) != holds_paper) triangles.col(1).swap(triangles.col(2));
  const MeshEdges edges(triangles);
  const Vector3d sides = sides_of_box(x);
  depth_ = closed_ ? std::min(deepest, of_thickness * sides[0]) : deepest_of_open;
  find_normals();
  find_corners(edges, find_sharp_edges(edges));
}

void Collider::find_normals() {
  const Triangles& triangles = mesh_.triangles;
  const Points3& x = mesh_.x;
  const int n = static_cast<int>(triangles.rows());
  face_normal_.resize(n, 3);
  vertex_normal_ = Points3::Zero(x.rows(), 3);
  border_vertex_.assign(x.rows(), 0);
  std::vector<Eigen::AlignedBox3d> boxes(n);
  for (int t = 0; t < n; ++t) {
    const std::array<Vector3d, 3> c{row(x, triangles(t, 0)), row(x, triangles(t, 1)),
                                    row(x, triangles(t, 2))};
    const Vector3d normal = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
    face_normal_.row(t) = normal;
    for (int i = 0; i < 3; ++i) {
      const Vector3d u = (c[(i + 1) % 3] - c[i]).normalized(),
                     w = (c[(i + 2) % 3] - c[i]).normalized();
      vertex_normal_.row(triangles(t, i)) += std::acos(std::clamp(u.dot(w), -1.0, 1.0)) * normal;
      boxes[t].extend(c[i]);
    }
  }
  for (int v = 0; v < x.rows(); ++v)
    if (const double length = vertex_normal_.row(v).norm(); length > 0)
      vertex_normal_.row(v) /= length;
  triangle_tree_.build(boxes);
}

std::vector<char> Collider::find_sharp_edges(const MeshEdges& edges) {
  const Triangles& triangles = mesh_.triangles;
  const Points3& x = mesh_.x;
  edge_normal_.resize(triangles.rows());
  border_edge_.assign(triangles.rows(), {0, 0, 0});
  std::vector<char> sharp(x.rows(), 0);
  std::vector<Eigen::AlignedBox3d> edge_boxes;
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
    const auto inward = [&](const TriangleSide& s) -> Vector3d {
      const Vector3d to = row(x, triangles(s.triangle, s.corner)) - row(x, a);
      return (to - along * along.dot(to)).normalized();
    };
    Edge edge{a, b, {inward(sides[0]), -row(face_normal_, sides[0].triangle)}, border};
    if (border) {
      border_vertex_[a] = border_vertex_[b] = 1;
    } else {
      edge.inward[1] = inward(sides[1]);
      const double turns = std::acos(std::clamp(
          face_normal_.row(sides[0].triangle).dot(face_normal_.row(sides[1].triangle)), -1.0, 1.0));
      const bool convex = edge.inward[0].dot(row(face_normal_, sides[1].triangle)) < 0;
      if (turns < flat || !convex) continue;
    }
    sharp[a] = sharp[b] = 1;
    edges_.push_back(edge);
    Eigen::AlignedBox3d box(row(x, a));
    edge_boxes.push_back(box.extend(row(x, b)));
  }
  edge_tree_.build(edge_boxes);
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
  std::vector<Eigen::AlignedBox3d> corner_boxes;
  for (int v = 0; v < x.rows(); ++v) {
    if (!sharp[v]) continue;
    if (border_vertex_[v]) outgoing[v].push_back(-row(vertex_normal_, v));
    corners_.push_back({v, border_vertex_[v] != 0, outgoing[v]});
    corner_boxes.emplace_back(row(x, v));
  }
  corner_tree_.build(corner_boxes);
}

namespace {
Eigen::AlignedBox3d grown(const Vector3d& low, const Vector3d& high, double by) {
  return {low - Vector3d::Constant(by), high + Vector3d::Constant(by)};
}
}  // namespace

void Collider::near_triangles(const Vector3d& low, const Vector3d& high, double within,
                              const std::function<void(int)>& visit) const {
  triangle_tree_.visit(grown(low, high, within), visit);
}
void Collider::near_edges(const Vector3d& low, const Vector3d& high, double within,
                          const std::function<void(int)>& visit) const {
  edge_tree_.visit(grown(low, high, within), visit);
}
void Collider::near_corners(const Vector3d& low, const Vector3d& high, double within,
                            const std::function<void(int)>& visit) const {
  corner_tree_.visit(grown(low, high, within), visit);
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

std::vector<SurfacePoint> Collider::nearest(const Vector3d& p, const std::vector<int>& triangles,
                                            int side) const {
  constexpr double coincident = 1e-9;  // [m] for closer points the normal of the mesh is used
  std::vector<SurfacePoint> found;
  std::vector<OnTriangle> all;
  all.reserve(triangles.size());
  std::size_t first = 0;
  for (const int t : triangles) {
    all.push_back(on_triangle(p, t));
    if (all.back().apart.squaredNorm() < all[first].apart.squaredNorm()) first = all.size() - 1;
  }
  if (all.empty()) return found;
  const auto& [at, apart, pseudo_normal, border] = all[first];
  const double d = apart.norm();
  // beyond the border of an open mesh there is neither front nor back
  const double sign = border && std::abs(apart.dot(row(face_normal_, triangles[first]))) < 0.999 * d
                          ? 1
                          : side * (apart.dot(pseudo_normal) < 0 ? -1 : 1);
  found.push_back({at, d < coincident ? Vector3d(side * pseudo_normal) : Vector3d(sign / d * apart),
                   sign * d, triangles[first], border});
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
  // widen the search until something is found, and once more until nothing closer can be missed
  SurfacePoint best{p, Vector3d::UnitZ(), std::numeric_limits<double>::infinity()};
  for (double reach = std::min(within, 2e-3);; reach = std::min(within, 4 * reach)) {
    std::vector<int> triangles;
    near_triangles(p, p, reach, [&](int t) { triangles.push_back(t); });
    std::sort(triangles.begin(), triangles.end());
    if (const auto found = nearest(p, triangles, side);
        !found.empty() && std::abs(found.front().distance) <= reach)
      return found.front();
    if (!(reach < within)) return best;
  }
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
  near_triangles(p.cwiseMin(q), p.cwiseMax(q), 0, [&](int t) {
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

namespace {

/// Where the vertices of a collider are in a frame.
const Points3& positions_at(const Collider& collider, int row) {
  const std::vector<Points3>& frames = collider.frames();
  if (frames.empty()) return collider.mesh().x;
  return frames[std::clamp(row, 0, static_cast<int>(frames.size()) - 1)];
}

std::shared_ptr<const Collider> shape_at(const Collider& collider, int row) {
  const Points3& x = positions_at(collider, row);
  if (&x == &collider.mesh().x || x == collider.mesh().x)
    return {std::shared_ptr<void>(), &collider};
  return std::make_shared<const Collider>(collider, x);
}

}  // namespace

ColliderShapes shapes_at(const Colliders& colliders, int row) {
  ColliderShapes shapes;
  for (const Collider& c : colliders) shapes.push_back(shape_at(c, row));
  return shapes;
}

ColliderMotion motion_to(const Colliders& colliders, int row) {
  return motion_to(colliders, row, shapes_at(colliders, row - 1));
}

ColliderMotion motion_to(const Colliders& colliders, int row, ColliderShapes before) {
  ColliderMotion motion{std::move(before), {}};
  for (std::size_t c = 0; c < colliders.size(); ++c)
    motion.to.push_back(motion.from[c]->mesh().x == positions_at(colliders[c], row)
                            ? motion.from[c]
                            : shape_at(colliders[c], row));
  return motion;
}

double farthest_move(const Colliders& colliders, int row) {
  double most = 0;
  for (const Collider& c : colliders)
    most = std::max(
        most, (positions_at(c, row) - positions_at(c, row - 1)).rowwise().squaredNorm().maxCoeff());
  return std::sqrt(most);
}

ColliderShapes between(const ColliderShapes& a, const ColliderShapes& b, double share) {
  ColliderShapes on_the_way;
  for (std::size_t c = 0; c < a.size(); ++c)
    on_the_way.push_back(
        a[c] == b[c] ? b[c]
                     : std::make_shared<const Collider>(
                           *b[c], Points3((1 - share) * a[c]->mesh().x + share * b[c]->mesh().x)));
  return on_the_way;
}

void archive_shapes(Serializer& a, ColliderShapes& shapes, const Colliders& colliders) {
  if (a.reads()) shapes.clear();
  for (std::size_t c = 0; c < colliders.size(); ++c) {
    const Collider& first = colliders[c];
    Points3 x;  // [m] none: those of the first frame
    if (!a.reads() && shapes[c].get() != &first) x = shapes[c]->mesh().x;
    a(x);
    if (!a.reads()) continue;
    a.require(x.rows() == 0 || (x.rows() == first.mesh().x.rows() && x.allFinite()));
    if (x.rows() == 0)
      shapes.emplace_back(std::shared_ptr<void>(), &first);
    else
      shapes.push_back(std::make_shared<const Collider>(first, x));
  }
}

double farthest_move(const Collider& from, const Collider& to) {
  return &from == &to ? 0
                      : std::sqrt((to.mesh().x - from.mesh().x).rowwise().squaredNorm().maxCoeff());
}

double farthest_move(const ColliderShapes& from, const ColliderShapes& to) {
  double most = 0;
  for (std::size_t c = 0; c < from.size(); ++c)
    most = std::max(most, farthest_move(*from[c], *to[c]));
  return most;
}

namespace {

/// The rotation from x, y, z to a triangle: its first edge, its normal, and across both.
Eigen::Matrix3d frame_of(const std::array<Vector3d, 3>& corners) {
  Eigen::Matrix3d frame;
  frame.col(0) = (corners[1] - corners[0]).normalized();
  frame.col(1) = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
  frame.col(2) = frame.col(0).cross(frame.col(1));
  return frame;
}

}  // namespace

Vector3d carried(const Collider& from, const Collider& to, const Vector3d& p, double within,
                 int side) {
  if (&from == &to) return p;
  const SurfacePoint near = from.nearest(p, within, side);
  if (near.triangle < 0) return p;
  std::array<Vector3d, 3> before, after;
  for (int i = 0; i < 3; ++i) {
    const int v = from.mesh().triangles(near.triangle, i);
    before[i] = row(from.mesh().x, v);
    after[i] = row(to.mesh().x, v);
  }
  const ClosestPoints at = vertex_to_triangle({p, before[0], before[1], before[2]});
  const Vector3d there =
      -(at.weights[1] * after[0] + at.weights[2] * after[1] + at.weights[3] * after[2]);
  return there + frame_of(after) * (frame_of(before).transpose() * (p - near.at));
}

double push_out(const ColliderShapes& colliders, const Points3& known, double clearance,
                Points3& x) {
  constexpr double to_and_fro = 3;  // [1] passes: a point pushed out may have entered elsewhere
  double deepest_found = 0;
  for (const auto& shape : colliders) {
    const Collider& collider = *shape;
    for (int v = 0; v < x.rows(); ++v) {
      const double range = (x.row(v) - known.row(v)).norm() + collider.depth();
      if (!collider.closed() && collider.nearest(row(x, v), range + clearance, 1).triangle < 0)
        continue;
      const int side = collider.side_of(row(x, v), row(known, v), range + 3 * collider.depth());
      for (int k = 0; k < to_and_fro; ++k) {
        const SurfacePoint near = collider.nearest(row(x, v), range + clearance, side);
        if (!(near.distance < clearance)) break;
        if (k == 0) deepest_found = std::max(deepest_found, -near.distance);
        x.row(v) += (clearance - near.distance) * near.normal.transpose();
      }
    }
  }
  return deepest_found;
}

}  // namespace paperbake
