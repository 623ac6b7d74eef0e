#include "core/curvature.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

/// One side of an edge: triangle (a, b, opposite), counter-clockwise in the pattern.
struct HalfEdge {
  int a, b, opposite;
  int low() const { return std::min(a, b); }
  int high() const { return std::max(a, b); }
};

/// Half-edges sorted so that the two sides of an edge are neighbours.
std::vector<HalfEdge> sorted_half_edges(const Triangles& triangles) {
  std::vector<HalfEdge> sides;
  sides.reserve(3 * triangles.rows());
  for (Eigen::Index t = 0; t < triangles.rows(); ++t)
    for (int k = 0; k < 3; ++k)
      sides.push_back({triangles(t, k), triangles(t, (k + 1) % 3), triangles(t, (k + 2) % 3)});
  std::sort(sides.begin(), sides.end(), [](const HalfEdge& p, const HalfEdge& q) {
    if (p.low() != q.low()) return p.low() < q.low();
    if (p.high() != q.high()) return p.high() < q.high();
    return p.a < q.a;
  });
  return sides;
}

/// Angle by which the normal turns from one side of the edge to the other; > 0 where the sheet bulges to its normal. [rad]
double dihedral_angle(const Points3& x, const HalfEdge& left, const HalfEdge& right) {
  const Vector3d a = x.row(left.a), b = x.row(left.b), c = x.row(left.opposite), d = x.row(right.opposite);
  const Vector3d e = b - a;
  const Vector3d n_left = e.cross(c - a), n_right = (d - a).cross(e);
  // both arguments carry |n_left||n_right|, so the normals need not be unit, and a collapsed triangle turns nothing
  return std::atan2(n_left.cross(n_right).dot(e.normalized()), n_left.dot(n_right));
}

}  // namespace

Points3 vertex_curvature(const Sheet& sheet) {
  Points3 S = Points3::Zero(sheet.pattern.rows(), 3);
  Eigen::VectorXd area = Eigen::VectorXd::Zero(sheet.pattern.rows());
  for (Eigen::Index t = 0; t < sheet.triangles.rows(); ++t) {
    const Eigen::RowVector3i v = sheet.triangles.row(t);
    const Vector2d p = sheet.pattern.row(v[1]) - sheet.pattern.row(v[0]), q = sheet.pattern.row(v[2]) - sheet.pattern.row(v[0]);
    const double A = 0.5 * (p.x() * q.y() - p.y() * q.x());
    for (int k = 0; k < 3; ++k) area[v[k]] += A;
  }

  const std::vector<HalfEdge> sides = sorted_half_edges(sheet.triangles);
  for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
    const HalfEdge &left = sides[i], &right = sides[i + 1];
    if (left.low() != right.low() || left.high() != right.high()) continue;  // a border edge
    const Vector2d along = sheet.pattern.row(left.b) - sheet.pattern.row(left.a);
    const double l = along.norm();
    if (l == 0) continue;
    const double turn = dihedral_angle(sheet.x, left, right) / l;  // n = (-along.y, along.x) / l
    const Eigen::RowVector3d theta_l_nn(turn * along.y() * along.y(), -turn * along.x() * along.y(), turn * along.x() * along.x());
    for (const int end : {left.a, left.b}) S.row(end) += theta_l_nn;                                   // a spoke of its ends
    for (const int across : {left.opposite, right.opposite}) S.row(across) += 0.5 * theta_l_nn;       // a link of the others
  }
  for (Eigen::Index v = 0; v < S.rows(); ++v)
    if (area[v] > 0) S.row(v) /= area[v];
  return S;
}

Principal principal_curvature(const Vector3d& tensor) {
  const double mean = 0.5 * (tensor[0] + tensor[2]), half_difference = 0.5 * (tensor[0] - tensor[2]);
  const double radius = std::hypot(half_difference, tensor[1]);
  const double phi = 0.5 * std::atan2(tensor[1], half_difference);  // of the algebraically larger eigenvalue
  if (mean >= 0) return {mean + radius, mean - radius, {std::cos(phi), std::sin(phi)}};
  return {mean - radius, mean + radius, {-std::sin(phi), std::cos(phi)}};
}

}  // namespace paperbake
