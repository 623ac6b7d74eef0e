#include "core/step1_elastic/solver/panel_motion.h"

#include "core/geometry/rigid_motion.h"
#include "core/linear_algebra/symmetric_eigen.h"
#include "core/model/segment2.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

namespace paperbake {
namespace {

bool are_in_one_line(const Points2& points) {
  if (points.rows() < 3) return true;
  const Points2 off = points.rowwise() - points.colwise().mean();
  const SymmetricEigen<2> axes = symmetric_eigen(Eigen::Matrix2d(off.transpose() * off));
  return !(axes.values[0] > min_width * min_width * axes.values[1]);
}

/// Places of the vertices of a sheet, as far as they are known.
class KnownPlaces {
 public:
  KnownPlaces(const Points2& pattern, const Points3& x, const PositionConstraints& hard)
      : pattern_(pattern),
        x_(x),
        sum_(Points3::Zero(x.rows(), 3)),
        count_(x.rows(), 0),
        is_held_(x.rows(), false) {
    for (const PositionConstraint& c : hard) {
      sum_.row(c.vertex) = c.target;
      count_[c.vertex] = 1;
      is_held_[c.vertex] = true;
    }
  }

  bool is_known(int v) const { return count_[v] > 0; }
  Vector3d place(int v) const { return sum_.row(v) / count_[v]; }
  void set(int v, const Vector3d& place) {
    sum_.row(v) = place;
    count_[v] = 1;
  }

  /// none: the known vertices do not say where these are to go
  std::optional<RigidMotion> motion_of(const std::vector<int>& vertices) const {
    std::vector<int> known;
    for (const int v : vertices)
      if (count_[v] > 0) known.push_back(v);
    Points3 from(known.size(), 3), to(known.size(), 3);
    Points2 pattern(known.size(), 2);
    for (std::size_t k = 0; k < known.size(); ++k) {
      pattern.row(k) = pattern_.row(known[k]);
      from.row(k) = x_.row(known[k]);
      to.row(k) = sum_.row(known[k]) / count_[known[k]];
    }
    if (are_in_one_line(pattern)) return std::nullopt;
    return nearest_rigid_motion(from, to);
  }

  void move(const std::vector<int>& vertices, const RigidMotion& motion) {
    for (const int v : vertices) {
      if (is_held_[v]) continue;
      sum_.row(v) += motion(x_.row(v).transpose()).transpose();
      ++count_[v];
    }
  }

  /// Unknown ones stay where they were.
  Points3 all() const {
    Points3 places = x_;
    for (Eigen::Index v = 0; v < places.rows(); ++v)
      if (count_[v] > 0) places.row(v) = sum_.row(v) / count_[v];
    return places;
  }

 private:
  const Points2& pattern_;
  const Points3& x_;
  Points3 sum_;  // [m] of the places that panels would take a vertex to
  std::vector<int> count_;
  std::vector<bool> is_held_;
};

}  // namespace

Panels::Panels(const Points2& pattern, const Triangles& triangles, const Hinges& hinges,
               const std::vector<bool>& folded)
    : hinges_(hinges.hinges), pattern_(pattern) {
  std::vector<int> panel_of(triangles.rows(), -1);
  for (int seed = 0; seed < triangles.rows(); ++seed) {
    if (panel_of[seed] >= 0) continue;
    const int panel = static_cast<int>(vertices_.size());
    std::set<int> vertices;
    std::vector<int> reached{seed};
    panel_of[seed] = panel;
    while (!reached.empty()) {
      const int t = reached.back();
      reached.pop_back();
      for (int i = 0; i < 3; ++i) {
        vertices.insert(triangles(t, i));
        const int h = hinges.of_triangle[t][i];
        if (h < 0 || folded[h]) continue;
        for (const int next : hinges.hinges[h].triangles)
          if (panel_of[next] < 0) {
            panel_of[next] = panel;
            reached.push_back(next);
          }
      }
    }
    vertices_.emplace_back(vertices.begin(), vertices.end());
  }
  for (std::size_t h = 0; h < folded.size(); ++h) {
    const auto [left, right] = hinges.hinges[h].triangles;
    if (folded[h] && panel_of[left] != panel_of[right])
      folds_.push_back({panel_of[left], panel_of[right], static_cast<int>(h)});
  }
}

/// The panels on their way from x to where constraints take them.
class Panels::Motion {
 public:
  Motion(const Panels& panels, const Points3& x, const PositionConstraints& hard)
      : panels_(panels),
        x_(x),
        known_(panels.pattern_, x, hard),
        motions_(panels.vertices_.size()) {}

  /// Moves the panels that constraints hold, and those between them that can only go one way.
  void begin(const std::vector<double>& pressed) {
    spread();
    if (!has_begun()) return;
    for (const Fold& fold : panels_.folds_)
      if (close(fold, pressed[fold.hinge])) spread();
  }

  /// Moves the panels with their known vertices, as far as these say how.
  void spread() {
    for (bool goes_on = true; goes_on;) {
      std::vector<std::pair<int, RigidMotion>> found;
      for (std::size_t panel = 0; panel < motions_.size(); ++panel)
        if (!motions_[panel])
          if (const auto motion = known_.motion_of(panels_.vertices_[panel]))
            found.emplace_back(panel, *motion);
      for (const auto& [panel, motion] : found) move(panel, motion);
      goes_on = !found.empty();
    }
  }

  /// Moves the far end of a fold between two panels that turn about folds which meet in a point c.
  /// Both keep its distance from c and its angles to their folds:
  ///
  ///   s.u, s.w and |s| stay,
  ///
  /// where s, u and w are the arms from c to the far end and along the two folds. There are two
  /// such places, on the two sides of the plane of u and w.
  /// pressed  [rad]
  /// returns  whether it did
  bool close(const Fold& fold, double pressed) {
    if (motions_[fold.left] || motions_[fold.right]) return false;
    const Hinge& hinge = panels_.hinges_[fold.hinge];
    for (int k = 0; k < 2; ++k) {
      const int c = hinge.vertices[k], end = hinge.vertices[1 - k];
      if (!known_.is_known(c) || known_.is_known(end)) continue;
      const int u = farthest_known(fold.left, c), w = farthest_known(fold.right, c);
      if (u < 0 || w < 0) continue;
      const Vector3d at = x_.row(c), s = x_.row(end).transpose() - at;
      const auto arm = [&](int v) { return Vector3d(x_.row(v).transpose() - at); };
      const double bulge = pressed != 0 ? pressed : dihedral_angle(x_, hinge);
      const auto on_pattern = [&](int v) {
        return Vector2d((panels_.pattern_.row(v) - panels_.pattern_.row(c)).transpose());
      };
      const bool turns_left = cross(on_pattern(u), on_pattern(w)) > 0;
      const auto moved = third_arm({arm(u), arm(w), s}, known_.place(u) - known_.place(c),
                                   known_.place(w) - known_.place(c), (bulge < 0) != turns_left);
      if (!moved) continue;
      known_.set(end, known_.place(c) + *moved);
      return true;
    }
    return false;
  }

  /// Moves what is left with its neighbours.
  void follow() {
    for (std::size_t round = 0; round < motions_.size(); ++round)
      for (const Fold& fold : panels_.folds_) {
        const auto &left = motions_[fold.left], &right = motions_[fold.right];
        if (left && !right)
          move(fold.right, *left);
        else if (right && !left)
          move(fold.left, *right);
      }
  }

  bool has_begun() const {
    return std::any_of(motions_.begin(), motions_.end(), [](const auto& m) { return bool(m); });
  }
  bool is_complete() const {
    return std::all_of(motions_.begin(), motions_.end(), [](const auto& m) { return bool(m); });
  }
  Points3 places() const { return known_.all(); }

 private:
  void move(int panel, const RigidMotion& motion) {
    motions_[panel] = motion;
    known_.move(panels_.vertices_[panel], motion);
  }

  int farthest_known(int panel, int from) const {
    int farthest = -1;
    double most = 0;
    for (const int v : panels_.vertices_[panel])
      if (const double far = (x_.row(v) - x_.row(from)).norm(); known_.is_known(v) && far > most) {
        most = far;
        farthest = v;
      }
    return farthest;
  }

  /// The arm s of a rigid corner when its other two arms, u and w, have turned.
  /// before  u, w and s
  /// on_left s lies on the side of u x w, if it leaves the plane of u and w
  /// returns none: u and w are in one line
  static std::optional<Vector3d> third_arm(const std::array<Vector3d, 3>& before, const Vector3d& u,
                                           const Vector3d& w, bool on_left) {
    constexpr double least_angle = 1e-3;  // [rad]
    const Vector3d normal = u.cross(w);
    const double area = normal.norm();
    if (!(area > least_angle * u.norm() * w.norm())) return std::nullopt;
    Eigen::Matrix2d products;
    products << u.dot(u), u.dot(w), u.dot(w), w.dot(w);
    const Vector2d shares =
        products.inverse() * Vector2d(before[2].dot(before[0]), before[2].dot(before[1]));
    const Vector3d in_plane = shares.x() * u + shares.y() * w;
    const double off = std::sqrt(std::max(0.0, before[2].squaredNorm() - in_plane.squaredNorm()));
    return in_plane + (on_left ? off : -off) / area * normal;
  }

  const Panels& panels_;
  const Points3& x_;
  KnownPlaces known_;
  std::vector<std::optional<RigidMotion>> motions_;  // of the panels
};

std::optional<Points3> Panels::moved(const Points3& x, const PositionConstraints& hard,
                                     const std::vector<double>& pressed) const {
  if (vertices_.size() < 2) return std::nullopt;
  Motion motion(*this, x, hard);
  motion.begin(pressed);
  if (!motion.has_begun()) return std::nullopt;
  motion.follow();
  return motion.places();
}

std::optional<Points3> Panels::moved_from_pattern(const PositionConstraints& hard,
                                                  const std::vector<double>& pressed) const {
  if (vertices_.size() < 2) return std::nullopt;
  Points3 flat = Points3::Zero(pattern_.rows(), 3);
  flat.leftCols<2>() = pattern_;
  Motion motion(*this, flat, hard);
  motion.begin(pressed);
  if (!motion.is_complete()) return std::nullopt;
  return motion.places();
}

PositionConstraints Panels::half_way(const Points3& x, PositionConstraints constraints) const {
  const KnownPlaces known(pattern_, x, constraints);
  std::vector<std::optional<RigidMotion>> motion_of(x.rows());
  if (vertices_.size() > 1)
    for (const std::vector<int>& panel : vertices_)
      if (const auto motion = known.motion_of(panel))
        for (const int v : panel) motion_of[v] = motion;
  for (PositionConstraint& c : constraints) {
    const Vector3d from = x.row(c.vertex);
    const std::optional<RigidMotion>& motion = motion_of[c.vertex];
    c.target =
        motion ? paperbake::half_way(*motion, from, c.target) : Vector3d(0.5 * (from + c.target));
  }
  return constraints;
}

}  // namespace paperbake
