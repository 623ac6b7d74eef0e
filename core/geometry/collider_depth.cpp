#include "core/geometry/collider_depth.h"

#include "core/geometry/box_tree.h"
#include "core/geometry/connected_parts.h"
#include "core/geometry/measure.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/squared_distance_3.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <queue>
#include <utility>

namespace paperbake {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Face = Kernel::Triangle_3;
using FaceIterator = std::vector<Face>::const_iterator;
using Tree =
    CGAL::AABB_tree<CGAL::AABB_traits<Kernel, CGAL::AABB_triangle_primitive<Kernel, FaceIterator>>>;
using Corners = std::array<Vector3d, 3>;

constexpr double exact_share = 0.01;  // [1] of the depth
constexpr int max_divisions = 20000;  // of the triangles of one surface

Vector3d row(const Points3& x, int v) { return x.row(v).transpose(); }
Point point(const Vector3d& p) { return {p.x(), p.y(), p.z()}; }

Corners corners_of(const Points3& x, const Triangles& triangles, int t) {
  return {row(x, triangles(t, 0)), row(x, triangles(t, 1)), row(x, triangles(t, 2))};
}

/// The largest value over a triangle of the least of some linear functions.
struct LinearMaximum {
  double value;
  Vector3d weights;
};

/// at_corners  values of each function at the three corners
/// The maximum is a corner, a point of a side where two functions are equal, or an inner point
/// where three are.
LinearMaximum maximize_least(const std::vector<Vector3d>& at_corners) {
  LinearMaximum best{-std::numeric_limits<double>::infinity(), Vector3d::Zero()};
  const auto try_point = [&](const Vector3d& w) {
    double least = std::numeric_limits<double>::infinity();
    for (const Vector3d& f : at_corners) least = std::min(least, f.dot(w));
    if (least > best.value) best = {least, w};
  };
  for (int i = 0; i < 3; ++i) try_point(Vector3d::Unit(i));
  const std::size_t n = at_corners.size();
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < a; ++b) {
      const Vector3d d = at_corners[a] - at_corners[b];
      for (int i = 0; i < 3; ++i)
        if (const int j = (i + 1) % 3; d[i] * d[j] < 0)
          try_point((d[i] * Vector3d::Unit(j) - d[j] * Vector3d::Unit(i)) / (d[i] - d[j]));
      for (std::size_t c = 0; c < b; ++c) {
        const Vector3d inner = d.cross(at_corners[a] - at_corners[c]);
        const Vector3d w = inner / inner.sum();
        if (w.allFinite() && w.minCoeff() > 0) try_point(w);
      }
    }
  return best;
}

}  // namespace

/// Faces that hang together.
class ColliderDepth::Part {
 public:
  Part(const Points3& x, const std::vector<std::array<int, 3>>& faces,
       ColliderMesh::PaperSide paper_side)
      : corners_(faces) {
    for (const auto& f : faces) {
      faces_.emplace_back(point(row(x, f[0])), point(row(x, f[1])), point(row(x, f[2])));
      for (const int v : f) {
        box_.extend(row(x, v));
        around_[v].push_back(static_cast<int>(faces_.size()) - 1);
      }
      normals_.push_back(triangle_normal(row(x, f[0]), row(x, f[1]), row(x, f[2])));
      origins_.push_back(row(x, f[0]));
    }
    find_borders();
    if (closed_) face_outwards();
    tree_.insert(faces_.cbegin(), faces_.cend());
    tree_.build();
    tree_.accelerate_distance_queries();
    // of an open part only a plane bounds the depth, as a ground does
    planes_bound_ = closed_ ? is_convex(x) : share_plane(x);
    if (closed_ && paper_side == ColliderMesh::PaperSide::inside) {
      hollow_ = true;
      planes_bound_ = false;
      for (Vector3d& n : normals_) n = -n;
    }
  }

  Penetration deepest(const Points3& x, const Triangles&) const;

 private:
  /// A point and what is known of it.
  struct DepthSample {
    Vector3d at;
    double depth;  // [m] negative: its distance, outside
    int face;      // the nearest
  };
  class Search;

  void find_borders() {
    std::map<std::pair<int, int>, int> runs;  // directed edge -> how many faces have it
    for (const auto& f : corners_)
      for (int i = 0; i < 3; ++i) ++runs[{f[i], f[(i + 1) % 3]}];
    closed_ = true;
    for (std::size_t k = 0; k < corners_.size(); ++k) {
      border_.push_back({});
      for (int i = 0; i < 3; ++i) {
        const int a = corners_[k][(i + 1) % 3], b = corners_[k][(i + 2) % 3];
        const auto back = runs.find({b, a});
        border_[k][i] = back == runs.end();
        closed_ &= back != runs.end() && back->second == 1 && runs[{a, b}] == 1;
        if (border_[k][i])
          border_edges_.emplace_back(faces_[k][(i + 1) % 3], faces_[k][(i + 2) % 3]);
      }
    }
  }

  Corners corners_of_face(int face) const {
    Corners c;
    for (int i = 0; i < 3; ++i)
      c[i] = Vector3d(faces_[face][i].x(), faces_[face][i].y(), faces_[face][i].z());
    return c;
  }

  void face_outwards() {
    double six_volumes = 0;
    for (std::size_t k = 0; k < faces_.size(); ++k) {
      const Corners c = corners_of_face(static_cast<int>(k));
      six_volumes += c[0].cross(c[1]).dot(c[2]);
    }
    if (six_volumes < 0)
      for (Vector3d& n : normals_) n = -n;
  }

  /// Whether no vertex is in front of the plane of a face.
  bool is_convex(const Points3& x) const {
    const double flat = 1e-7 * box_.diagonal().norm();
    std::vector<Eigen::AlignedBox3d> vertices;
    for (const auto& [v, faces] : around_) vertices.emplace_back(row(x, v));
    BoxTree tree;
    tree.build(std::move(vertices));
    for (std::size_t k = 0; k < faces_.size(); ++k)
      if (tree.reaches_above(normals_[k], normals_[k].dot(origins_[k]) + flat)) return false;
    return true;
  }

  /// If all faces of an open part lie in one plane, each gets that of the largest, which rounding
  /// turns least. Returns whether they do.
  bool share_plane(const Points3& x) {
    const double flat = 1e-7 * box_.diagonal().norm();
    const auto smaller = [](const Face& a, const Face& b) {
      return a.squared_area() < b.squared_area();
    };
    const std::size_t largest =
        std::max_element(faces_.begin(), faces_.end(), smaller) - faces_.begin();
    const Vector3d normal = normals_[largest], origin = origins_[largest];
    for (const Vector3d& n : normals_)
      if (n.dot(normal) <= 0) return false;
    for (const auto& [v, faces] : around_)
      if (std::abs(normal.dot(row(x, v) - origin)) >= flat) return false;
    std::fill(normals_.begin(), normals_.end(), normal);
    std::fill(origins_.begin(), origins_.end(), origin);
    return true;
  }

  /// The number of zeros among the barycentric coordinates of a point of a face, and one of them.
  std::pair<int, int> zeros(int face, const Vector3d& p) const {
    const Corners c = corners_of_face(face);
    const Vector3d n = (c[1] - c[0]).cross(c[2] - c[0]);
    int count = 0, which = -1;
    for (int i = 0; i < 3; ++i) {
      const double w = n.dot((c[(i + 1) % 3] - p).cross(c[(i + 2) % 3] - p)) / n.squaredNorm();
      if (!(std::abs(w) > 1e-9)) {
        ++count;
        which = i;
      }
    }
    return {count, which};
  }

  DepthSample sample(const Vector3d& p) const {
    const auto [nearest, primitive] = tree_.closest_point_and_primitive(point(p));
    const Vector3d at(nearest.x(), nearest.y(), nearest.z());
    const int face = static_cast<int>(primitive - faces_.cbegin());
    const double distance = (p - at).norm();
    double above = normals_[face].dot(p - at);
    const auto [count, zero] = zeros(face, at);
    bool border = count > 0 && border_[face][zero];
    // of the faces round an edge or a corner that turns most towards the point knows its side
    if (count > 0)
      for (const int v : corners_[face])
        for (const int other : around_.at(v)) {
          if (other == face ||
              CGAL::squared_distance(nearest, faces_[other]) > 1e-18 + 1e-18 * distance)
            continue;
          const double turned = normals_[other].dot(p - at);
          if (std::abs(turned) > std::abs(above) * (1 + 1e-12)) above = turned;
          if (count > 1) border |= touches_border(other, at);
        }
    // beyond the border of an open part there is neither front nor back
    const bool beyond = !closed_ && border && std::abs(above) < 0.999 * distance;
    return {p, above < 0 && !beyond ? distance : -distance, face};
  }

  bool touches_border(int face, const Vector3d& at) const {
    for (int i = 0; i < 3; ++i)
      if (border_[face][i]) {
        const Point &a = faces_[face][(i + 1) % 3], &b = faces_[face][(i + 2) % 3];
        if (CGAL::squared_distance(point(at), Kernel::Segment_3(a, b)) < 1e-18) return true;
      }
    return false;
  }

  /// What bounds the depth of p from above as face F sees it: a convex function of p.
  double bound(int face, const Vector3d& p) const {
    return planes_bound_ ? normals_[face].dot(origins_[face] - p)
                         : std::sqrt(CGAL::squared_distance(point(p), faces_[face]));
  }

  /// How far from the border a triangle passes through an open part, at most. [m]
  double cut_from_border(const Corners& c) const {
    const Face triangle(point(c[0]), point(c[1]), point(c[2]));
    std::vector<FaceIterator> met;
    tree_.all_intersected_primitives(triangle, std::back_inserter(met));
    double most = 0;
    for (const FaceIterator& face : met)
      for (const Point& p : ends_of_cut(triangle, *face))
        most = std::max(most, distance_to_border(p));
    return most;
  }

  /// Where edges of either triangle pass through the other one. Triangles in one plane do not pass
  /// through each other.
  static std::vector<Point> ends_of_cut(const Face& a, const Face& b) {
    constexpr double rounding = 1e-9;  // [m]
    std::vector<Point> ends;
    for (const auto& [edges, through] : {std::pair(&a, &b), std::pair(&b, &a)}) {
      const auto normal =
          CGAL::cross_product((*through)[1] - (*through)[0], (*through)[2] - (*through)[0]);
      for (int i = 0; i < 3; ++i) {
        const Point &p = (*edges)[i], &q = (*edges)[i + 1];
        const double before = normal * (p - (*through)[0]), after = normal * (q - (*through)[0]);
        if ((before < 0) == (after < 0)) continue;
        const Point at = p + before / (before - after) * (q - p);
        if (CGAL::squared_distance(at, *through) < rounding * rounding) ends.push_back(at);
      }
    }
    return ends;
  }

  bool meets(const Corners& c) const {
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) return false;
    return tree_.do_intersect(Face(point(c[0]), point(c[1]), point(c[2])));
  }

  double distance_to_border(const Point& p) const {
    double least = std::numeric_limits<double>::infinity();
    for (const Kernel::Segment_3& edge : border_edges_)
      least = std::min(least, CGAL::squared_distance(p, edge));
    return std::sqrt(least);
  }

  std::vector<std::array<int, 3>> corners_;
  std::vector<Face> faces_;
  std::vector<Vector3d> normals_, origins_;
  std::vector<std::array<bool, 3>> border_;  // of the edge opposite each corner
  std::vector<Kernel::Segment_3> border_edges_;
  std::map<int, std::vector<int>> around_;  // faces at each vertex
  Eigen::AlignedBox3d box_;
  bool closed_ = false, hollow_ = false, planes_bound_ = false;
  Tree tree_;
};

/// One surface in one part.
class ColliderDepth::Part::Search {
 public:
  Search(const Part& part, const Points3& x, const Triangles& triangles)
      : part_(part), x_(x), triangles_(triangles), known_(x.rows(), -1) {}

  Penetration run() {
    for (int t = 0; t < triangles_.rows(); ++t) look_at(t);
    if (!part_.closed_) follow_behind();
    for (int k = 0; k < max_divisions && !open_.empty(); ++k) {
      const Piece piece = open_.top();
      open_.pop();
      if (piece.most <= best_.depth + allowed()) break;
      divide(piece);
    }
    if (!part_.closed_) limit_to_cut();
    return best_;
  }

 private:
  struct Piece {
    double most;  // [m] no point of it is deeper
    int triangle;
    std::array<DepthSample, 3> corners;
    Eigen::Matrix3d weights;  // of its corners in the triangle, one a column
    bool operator<(const Piece& other) const { return most < other.most; }
  };

  double allowed() const { return std::max(depth_exact_to, exact_share * best_.depth); }

  const DepthSample& at_vertex(int v) {
    if (known_[v] < 0) {
      known_[v] = static_cast<int>(samples_.size());
      samples_.push_back(part_.sample(row(x_, v)));
    }
    return samples_[known_[v]];
  }

  void look_at(int t) {
    const Corners c = corners_of(x_, triangles_, t);
    Eigen::AlignedBox3d box(c[0]);
    if (!box.extend(c[1]).extend(c[2]).intersects(part_.box_) && !part_.hollow_) return;
    const double longest =
        std::max({(c[0] - c[1]).norm(), (c[1] - c[2]).norm(), (c[2] - c[0]).norm()});
    bool some_inside = false, lies_on_one = !part_.closed_;
    for (int i = 0; i < 3; ++i) {
      const DepthSample& corner = at_vertex(triangles_(t, i));
      if (corner.depth < -longest) return;
      some_inside |= corner.depth > 0;
      lies_on_one &= std::abs(corner.depth) < depth_exact_to &&
                     corner.face == at_vertex(triangles_(t, 0)).face;
    }
    // what lies on a table top passes through it by rounding alone
    if (lies_on_one) return;
    if ((part_.closed_ && some_inside) || part_.meets(c)) {
      pierced_.push_back(t);
      add({0,
           t,
           {at_vertex(triangles_(t, 0)), at_vertex(triangles_(t, 1)), at_vertex(triangles_(t, 2))},
           Eigen::Matrix3d::Identity()});
    }
  }

  void improve(double depth, int triangle, const Vector3d& weights) {
    if (depth > best_.depth) best_ = {depth, triangle, weights};
  }

  /// Bounds a piece, and keeps it where it might hold something deeper.
  void add(Piece piece) {
    std::vector<int> faces;
    const auto use = [&](int face) {
      if (std::find(faces.begin(), faces.end(), face) == faces.end()) faces.push_back(face);
    };
    double outside = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
      const DepthSample& corner = piece.corners[i];
      use(corner.face);
      improve(corner.depth, piece.triangle, piece.weights.col(i));
      double radius = 0;
      for (int k = 1; k < 3; ++k)
        radius = std::max(radius, (piece.corners[(i + k) % 3].at - corner.at).norm());
      outside = std::min(outside, radius + corner.depth);
    }
    constexpr int max_faces = 6;
    for (int round = 0; round < max_faces - 3; ++round) {
      std::vector<Vector3d> functions;
      for (const int face : faces)
        functions.emplace_back(part_.bound(face, piece.corners[0].at),
                               part_.bound(face, piece.corners[1].at),
                               part_.bound(face, piece.corners[2].at));
      const LinearMaximum most = maximize_least(functions);
      piece.most = std::min(outside, most.value);
      if (piece.most <= best_.depth + allowed()) return;
      const DepthSample there = part_.sample(most.weights[0] * piece.corners[0].at +
                                             most.weights[1] * piece.corners[1].at +
                                             most.weights[2] * piece.corners[2].at);
      improve(there.depth, piece.triangle, piece.weights * most.weights);
      if (piece.most <= best_.depth + allowed()) return;
      const std::size_t before = faces.size();
      use(there.face);
      if (faces.size() == before) break;
    }
    open_.push(std::move(piece));
  }

  /// Halves the longest side.
  void divide(const Piece& piece) {
    int i = 0;
    const auto side = [&](int k) {
      return (piece.corners[k].at - piece.corners[(k + 1) % 3].at).squaredNorm();
    };
    for (int k = 1; k < 3; ++k)
      if (side(k) > side(i)) i = k;
    const int j = (i + 1) % 3;
    const DepthSample middle = part_.sample(0.5 * (piece.corners[i].at + piece.corners[j].at));
    for (const int replaced : {i, j}) {
      Piece half = piece;
      half.corners[replaced] = middle;
      half.weights.col(replaced) = 0.5 * (piece.weights.col(i) + piece.weights.col(j));
      add(std::move(half));
    }
  }

  /// From where the surface passes through an open part, on over all vertices behind its front.
  void follow_behind() {
    std::vector<std::vector<int>> at(x_.rows());
    if (!pierced_.empty())
      for (int t = 0; t < triangles_.rows(); ++t)
        for (int i = 0; i < 3; ++i) at[triangles_(t, i)].push_back(t);
    std::vector<char> seen(x_.rows(), 0);
    std::vector<int> next = pierced_;
    while (!next.empty()) {
      const int t = next.back();
      next.pop_back();
      for (int i = 0; i < 3; ++i) {
        const int v = triangles_(t, i);
        if (seen[v]) continue;
        seen[v] = 1;
        if (!(at_vertex(v).depth > 0)) continue;
        improve(at_vertex(v).depth, t, Vector3d::Unit(i));
        next.insert(next.end(), at[v].begin(), at[v].end());
      }
    }
  }

  /// What hangs over the border of an open part has cut into it from there: that far it has to be
  /// lifted.
  void limit_to_cut() {
    double cut = 0;
    for (const int t : pierced_)
      if (cut < best_.depth)
        cut = std::max(cut, part_.cut_from_border(corners_of(x_, triangles_, t)));
    best_.depth = std::min(best_.depth, cut);
  }

  const Part& part_;
  const Points3& x_;
  const Triangles& triangles_;
  std::vector<int> known_;  // index of the sample at each vertex; -1: none yet
  std::vector<DepthSample> samples_;
  std::vector<int> pierced_;
  std::priority_queue<Piece> open_;
  Penetration best_;
};

Penetration ColliderDepth::Part::deepest(const Points3& x, const Triangles& triangles) const {
  return Search(*this, x, triangles).run();
}

ColliderDepth::ColliderDepth(const ColliderMesh& mesh) {
  const std::vector<int> part = connected_parts(mesh.triangles, mesh.x.rows());
  std::map<int, std::vector<std::array<int, 3>>> faces;
  for (int t = 0; t < mesh.triangles.rows(); ++t) {
    const Corners c = corners_of(mesh.x, mesh.triangles, t);
    if ((c[1] - c[0]).cross(c[2] - c[0]).squaredNorm() > 0)
      faces[part[mesh.triangles(t, 0)]].push_back(
          {mesh.triangles(t, 0), mesh.triangles(t, 1), mesh.triangles(t, 2)});
  }
  for (const auto& [n, of_part] : faces)
    parts_.push_back(std::make_unique<Part>(mesh.x, of_part, mesh.paper_side));
}

ColliderDepth::~ColliderDepth() = default;
ColliderDepth::ColliderDepth(ColliderDepth&&) noexcept = default;

Penetration ColliderDepth::deepest(const Points3& x, const Triangles& triangles) const {
  Penetration deepest;
  for (const auto& part : parts_)
    if (Penetration found = part->deepest(x, triangles); found.depth > deepest.depth)
      deepest = found;
  return deepest;
}

}  // namespace paperbake
