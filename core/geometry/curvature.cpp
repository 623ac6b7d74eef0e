#include "core/geometry/curvature.h"

#include "core/geometry/hinges.h"
#include "core/geometry/prescribed_creases.h"
#include "core/linear_algebra/symmetric_eigen.h"
#include "core/model/segment2.h"

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

/// Distance of a triangle's circumcentre from its edge ab, negative beyond the edge. There the
/// plane of the triangle has the slope of a round surface through its corners. [m]
double circumcentre_height(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  const Vector2d u = a - c, v = b - c;
  return 0.5 * (b - a).norm() * u.dot(v) / std::abs(cross(u, v));
}

using Eigen::Matrix2d;

constexpr double min_seen = 0.25;  // [1] of a direction, by a ring that is not blind to it

/// The curvature that a one-ring shows. judge() computes it from the sum over its edges and from
/// the value of that sum for a surface of curvature 1, both divided by the area of the ring.
struct Ring {
  Matrix2d curvature;
  Matrix2d blind;  // projector onto the directions in which the ring has hardly any edges
};
Ring judge(const Matrix2d& folds, const Matrix2d& round) {
  const SymmetricEigen<2> eigen = symmetric_eigen(round);
  Matrix2d root = Matrix2d::Zero(), blind = Matrix2d::Zero();
  for (int i = 0; i < 2; ++i) {
    const Vector2d u = eigen.vectors.col(i);
    if (eigen.values[i] < min_seen)
      blind += u * u.transpose();
    else
      root += u * u.transpose() / std::sqrt(eigen.values[i]);
  }
  return {root * folds * root, blind};
}

/// l n (x) n of an edge, with its length l and its unit normal n in the pattern. [m] Sxx, Sxy, Syy
Eigen::RowVector3d across_edge(const Points2& pattern, const Hinge& hinge) {
  const Vector2d along = pattern.row(hinge.vertices[1]) - pattern.row(hinge.vertices[0]);
  return Eigen::RowVector3d(along.y() * along.y(), -along.x() * along.y(), along.x() * along.x()) /
         along.norm();
}

/// Adds what an edge contributes to the rings in which it is: it is a spoke of its two ends, and a
/// link of its two wings.
void add_to_rings(const Hinge& hinge, const Eigen::RowVector3d& sum, Points3& of_rings) {
  for (int k = 0; k < 4; ++k) of_rings.row(hinge.vertices[k]) += (k < 2 ? 1.0 : 0.5) * sum;
}

/// The sum over the edges of each ring for a surface of curvature 1.
Points3 round_sums(const Points2& pattern, const Hinges& hinges) {
  const auto at = [&](int v) -> Vector2d { return pattern.row(v); };
  Points3 sums = Points3::Zero(pattern.rows(), 3);
  for (const Hinge& hinge : hinges.hinges) {
    const auto& v = hinge.vertices;
    const double round = circumcentre_height(at(v[0]), at(v[1]), at(v[2])) +
                         circumcentre_height(at(v[0]), at(v[1]), at(v[3]));
    add_to_rings(hinge, round * across_edge(pattern, hinge), sums);
  }
  return sums;
}

Eigen::VectorXd ring_areas(const Points2& pattern, const Triangles& triangles) {
  const auto at = [&](int v) -> Vector2d { return pattern.row(v); };
  Eigen::VectorXd area = Eigen::VectorXd::Zero(pattern.rows());
  for (int t = 0; t < triangles.rows(); ++t) {
    const Vector2d p = at(triangles(t, 1)) - at(triangles(t, 0)),
                   q = at(triangles(t, 2)) - at(triangles(t, 0));
    for (int k = 0; k < 3; ++k) area[triangles(t, k)] += 0.5 * cross(p, q);
  }
  return area;
}

}  // namespace

std::vector<double> bending_turns(const Sheet& sheet, const Hinges& hinges) {
  std::vector<double> turns;
  for (const Hinge& hinge : hinges.hinges)
    turns.push_back(is_folded(sheet, hinge.vertices[0], hinge.vertices[1])
                        ? 0
                        : dihedral_angle(sheet.x, hinge));
  return turns;
}

Points3 vertex_curvature(const Sheet& sheet) {
  const Hinges hinges = find_hinges(sheet.triangles);
  return vertex_curvature(sheet.pattern, sheet.triangles, hinges, bending_turns(sheet, hinges));
}

Points3 vertex_curvature(const Points2& pattern, const Triangles& triangles, const Hinges& hinges,
                         const std::vector<double>& turns) {
  Points3 folds = Points3::Zero(pattern.rows(), 3);
  for (std::size_t h = 0; h < turns.size(); ++h)
    add_to_rings(hinges.hinges[h], turns[h] * across_edge(pattern, hinges.hinges[h]), folds);
  const Points3 seen = round_sums(pattern, hinges);
  const Eigen::VectorXd area = ring_areas(pattern, triangles);
  std::vector<Ring> rings(pattern.rows(), {Matrix2d::Zero(), Matrix2d::Identity()});
  for (std::size_t v = 0; v < rings.size(); ++v)
    if (area[v] > 0)
      rings[v] =
          judge(symmetric_matrix(folds.row(v)) / area[v], symmetric_matrix(seen.row(v)) / area[v]);

  // in directions to which a ring is blind it takes the curvature of its neighbours
  std::vector<Matrix2d> around(rings.size(), Matrix2d::Zero());
  std::vector<int> neighbours(rings.size(), 0);
  for (int t = 0; t < triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const int v = triangles(t, i), other = triangles(t, j);
        if (!rings[other].blind.isZero(0)) continue;
        around[v] += rings[other].curvature;
        ++neighbours[v];
      }
  Points3 result(pattern.rows(), 3);
  for (std::size_t v = 0; v < rings.size(); ++v) {
    Matrix2d s = rings[v].curvature;
    if (neighbours[v] > 0) s += rings[v].blind * around[v] * rings[v].blind / neighbours[v];
    result.row(v) << s(0, 0), s(0, 1), s(1, 1);
  }
  return result;
}

std::vector<char> obtuse_rings(const Points2& pattern, const Triangles& triangles,
                               const Hinges& hinges) {
  const Points3 seen = round_sums(pattern, hinges);
  const Eigen::VectorXd area = ring_areas(pattern, triangles);
  std::vector<char> at_border(pattern.rows(), 0), obtuse(pattern.rows(), 0);
  for (int t = 0; t < triangles.rows(); ++t) {
    const auto& edges = hinges.of_triangle[t];
    if (*std::min_element(edges.begin(), edges.end()) < 0)
      for (const int v : triangles.row(t)) at_border[v] = 1;
  }
  for (std::size_t v = 0; v < obtuse.size(); ++v)
    obtuse[v] = !at_border[v] && area[v] > 0 &&
                symmetric_eigen(symmetric_matrix(seen.row(v) / area[v])).values[0] < min_seen;
  return obtuse;
}

/// |k2| of a curvature tensor. [1/m]
static double lesser_curvature(const Vector3d& tensor) {
  return std::abs(std::abs(0.5 * (tensor[0] + tensor[2])) -
                  std::hypot(0.5 * (tensor[0] - tensor[2]), tensor[1]));
}

Principal principal_curvature(const Vector3d& tensor) {
  const double mean = 0.5 * (tensor[0] + tensor[2]),
               half_difference = 0.5 * (tensor[0] - tensor[2]);
  const double radius = std::hypot(half_difference, tensor[1]);
  // direction of the algebraically larger eigenvalue
  const double phi = 0.5 * std::atan2(tensor[1], half_difference);
  if (mean >= 0) return {mean + radius, mean - radius, {std::cos(phi), std::sin(phi)}};
  return {mean - radius, mean + radius, {-std::sin(phi), std::cos(phi)}};
}

SecondTurn second_turn(const Sheet& sheet, const Hinges& hinges, const Points3& curvature) {
  const std::size_t vertices = sheet.pattern.rows();
  SecondTurn second{std::vector<char>(vertices, 0), std::vector<double>(vertices, 0.0),
                    std::vector<double>(vertices, 0.0)};
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    const auto corner = sheet.triangles.row(t);
    const Vector2d u = (sheet.pattern.row(corner[1]) - sheet.pattern.row(corner[0])).transpose();
    const Vector2d v = (sheet.pattern.row(corner[2]) - sheet.pattern.row(corner[0])).transpose();
    for (int i = 0; i < 3; ++i) {
      second.area[corner[i]] += cross(u, v) / 6;
      if (hinges.of_triangle[t][i] < 0)
        second.border[corner[(i + 1) % 3]] = second.border[corner[(i + 2) % 3]] = 1;
    }
  }
  for (std::size_t v = 0; v < vertices; ++v)
    second.turn[v] = lesser_curvature(curvature.row(v)) * std::sqrt(second.area[v]);
  return second;
}

}  // namespace paperbake
