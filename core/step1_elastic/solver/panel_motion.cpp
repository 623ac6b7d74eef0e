#include "core/step1_elastic/solver/panel_motion.h"

#include "core/geometry/rigid_motion.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <set>

namespace paperbake {
namespace {

constexpr double min_width = 0.02;  // [1] of the extent of points that are not in one line

bool are_in_one_line(const Points3& points) {
  if (points.rows() < 3) return true;
  const Points3 off = points.rowwise() - points.colwise().mean();
  const Eigen::Matrix3d spread = off.transpose() * off;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread, Eigen::EigenvaluesOnly);
  return !(axes.eigenvalues()[1] > min_width * min_width * axes.eigenvalues()[2]);
}

/// Places of the vertices of a sheet, as far as they are known.
class KnownPlaces {
 public:
  KnownPlaces(const Points3& x, const PositionConstraints& hard)
      : x_(x), sum_(Points3::Zero(x.rows(), 3)), count_(x.rows(), 0), is_held_(x.rows(), false) {
    for (const PositionConstraint& c : hard) {
      sum_.row(c.vertex) = c.target;
      count_[c.vertex] = 1;
      is_held_[c.vertex] = true;
    }
  }

  /// none: the known vertices do not say where these are to go
  std::optional<RigidMotion> motion_of(const std::vector<int>& vertices) const {
    std::vector<int> known;
    for (const int v : vertices)
      if (count_[v] > 0) known.push_back(v);
    Points3 from(known.size(), 3), to(known.size(), 3);
    for (std::size_t k = 0; k < known.size(); ++k) {
      from.row(k) = x_.row(known[k]);
      to.row(k) = sum_.row(known[k]) / count_[known[k]];
    }
    if (are_in_one_line(from)) return std::nullopt;
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
  const Points3& x_;
  Points3 sum_;  // [m] of the places that panels would take a vertex to
  std::vector<int> count_;
  std::vector<bool> is_held_;
};

/// The motion that does the same as the given one when it is done twice; `motion` turns by less
/// than 180 degrees.
RigidMotion half_of(const RigidMotion& motion) {
  Eigen::AngleAxisd about(motion.turn);
  about.angle() *= 0.5;
  const Eigen::Matrix3d turn = about.toRotationMatrix();
  return {turn, (turn + Eigen::Matrix3d::Identity()).inverse() * motion.shift};
}

}  // namespace

Panels::Panels(const Triangles& triangles, const Hinges& hinges, const std::vector<bool>& folded) {
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
      neighbours_.emplace_back(panel_of[left], panel_of[right]);
  }
}

std::optional<Points3> Panels::moved(const Points3& x, const PositionConstraints& hard) const {
  if (vertices_.size() < 2) return std::nullopt;
  KnownPlaces known(x, hard);
  std::vector<std::optional<RigidMotion>> motions(vertices_.size());
  const auto move = [&](std::size_t panel, const RigidMotion& motion) {
    motions[panel] = motion;
    known.move(vertices_[panel], motion);
  };
  for (bool goes_on = true; goes_on;) {
    goes_on = false;
    std::vector<std::pair<std::size_t, RigidMotion>> found;
    for (std::size_t panel = 0; panel < vertices_.size(); ++panel)
      if (!motions[panel])
        if (const auto motion = known.motion_of(vertices_[panel]))
          found.emplace_back(panel, *motion);
    for (const auto& [panel, motion] : found) {
      move(panel, motion);
      goes_on = true;
    }
  }
  if (std::none_of(motions.begin(), motions.end(), [](const auto& m) { return m.has_value(); }))
    return std::nullopt;
  for (std::size_t round = 0; round < vertices_.size(); ++round)
    for (const auto& [a, b] : neighbours_) {
      if (motions[a] && !motions[b]) move(b, *motions[a]);
      if (motions[b] && !motions[a]) move(a, *motions[b]);
    }
  return known.all();
}

PositionConstraints Panels::half_way(const Points3& x, PositionConstraints constraints) const {
  const KnownPlaces known(x, constraints);
  std::vector<std::optional<RigidMotion>> motion_of(x.rows());
  if (vertices_.size() > 1)
    for (const std::vector<int>& panel : vertices_)
      if (const auto motion = known.motion_of(panel))
        for (const int v : panel) motion_of[v] = motion;
  for (PositionConstraint& c : constraints) {
    const Vector3d from = x.row(c.vertex);
    const std::optional<RigidMotion>& motion = motion_of[c.vertex];
    c.target = motion ? Vector3d(half_of(*motion)(from) + 0.5 * (c.target - (*motion)(from)))
                      : Vector3d(0.5 * (from + c.target));
  }
  return constraints;
}

}  // namespace paperbake
