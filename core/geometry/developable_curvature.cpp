#include "core/geometry/developable_curvature.h"

#include "core/geometry/hinges.h"
#include "core/geometry/measure.h"
#include "core/linear_algebra/symmetric_eigen.h"
#include "core/model/segment2.h"

#include <Eigen/LU>

#include <array>
#include <cmath>
#include <vector>

namespace paperbake {
namespace {

using Eigen::Matrix2d;

/// Sxx, sqrt(2) Sxy, Syy: the inner product of two tensors is the dot product of these vectors.
Vector3d as_vector(const Matrix2d& S) { return {S(0, 0), std::sqrt(2.0) * S(0, 1), S(1, 1)}; }

/// The dihedral angle of an edge spread over its two triangles: the term k n (x) n of S.
struct Term {
  double k;    // [1/m]
  Vector2d n;  // unit
};

/// The term of a border edge with normal b that, together with the terms of the two other edges,
/// makes the determinant vanish.
Matrix2d completion(const Term& p, const Term& q, const Vector2d& b) {
  if (p.k * q.k <= 0) return Matrix2d::Zero();
  const double pq = cross(p.n, q.n), pb = cross(p.n, b), qb = cross(q.n, b);
  return -p.k * q.k * pq * pq / (p.k * pb * pb + q.k * qb * qb) * b * b.transpose();
}

/// What the triangles around a vertex determine of its curvature tensor.
struct Neighbourhood {
  double area = 0;  // [m2]
  // [m2] sum of area x projector onto the components that a triangle determines
  Eigen::Matrix3d known = Eigen::Matrix3d::Zero();
  // [m] sum of area x those components of S_t; sum of area x all of S_t, completed at borders
  Vector3d told = Vector3d::Zero(), guess = told;

  bool knows_all() const {
    constexpr double enough = 0.1;
    return area > 0 && symmetric_eigen(known).values[0] > enough * area;
  }
  /// otherwise  [1/m] value assumed for the undetermined components
  Vector3d curvature(const Vector3d& otherwise) const {
    constexpr double guessed = 0.05;
    const Eigen::Matrix3d unknown = guessed * (area * Eigen::Matrix3d::Identity() - known);
    return (known + unknown).inverse() * (told + unknown * otherwise);
  }
};

std::vector<Neighbourhood> neighbourhoods_of(const Sheet& sheet) {
  const Hinges hinges = find_hinges(sheet.triangles);
  const auto corner = [&](int t, int i) -> Vector2d {
    return sheet.pattern.row(sheet.triangles(t, i % 3));
  };
  std::vector<double> bend;  // [1/m2] theta/A of each hinge
  for (const Hinge& hinge : hinges.hinges)
    bend.push_back(dihedral_angle(sheet.x, hinge) / (pattern_area(sheet, hinge.triangles[0]) +
                                                     pattern_area(sheet, hinge.triangles[1])));

  std::vector<Neighbourhood> rings(sheet.pattern.rows());
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    Matrix2d S = Matrix2d::Zero();
    std::array<Term, 3> terms;
    Vector2d border;
    int told = 0;
    Eigen::Matrix3d known = Eigen::Matrix3d::Identity();
    for (int i = 0; i < 3; ++i) {
      const Vector2d edge = corner(t, i + 2) - corner(t, i + 1),
                     n = Vector2d(edge.y(), -edge.x()).normalized();
      const int h = hinges.of_triangle[t][i];
      if (h >= 0) {
        terms[told] = {bend[h] * edge.norm(), n};
        S += terms[told++].k * n * n.transpose();
        continue;
      }
      border = n;
      // of a second border edge only the part that the first has not removed
      const Vector3d rest = known * as_vector(n * n.transpose());
      if (rest.norm() > 1e-6) known -= rest * rest.transpose() / rest.squaredNorm();
    }
    if (told == 2) S += completion(terms[0], terms[1], border);
    for (int i = 0; i < 3; ++i) {
      Neighbourhood& ring = rings[sheet.triangles(t, i)];
      ring.area += pattern_area(sheet, t);
      ring.known += pattern_area(sheet, t) * known;
      ring.told += pattern_area(sheet, t) * known * as_vector(S);
      ring.guess += pattern_area(sheet, t) * as_vector(S);
    }
  }

  return rings;
}

}  // namespace

Points3 developable_curvature(const Sheet& sheet) {
  const std::vector<Neighbourhood> rings = neighbourhoods_of(sheet);
  std::vector<Vector3d> around(rings.size(), Vector3d::Zero());
  std::vector<int> neighbours(rings.size(), 0);
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i) {
      const int v = sheet.triangles(t, i);
      if (!rings[v].knows_all()) continue;
      for (int j = 1; j < 3; ++j) {
        const int other = sheet.triangles(t, (i + j) % 3);
        around[other] += rings[v].curvature(rings[v].guess / rings[v].area);
        ++neighbours[other];
      }
    }
  Points3 result = Points3::Zero(sheet.pattern.rows(), 3);
  for (int v = 0; v < result.rows(); ++v) {
    const Neighbourhood& ring = rings[v];
    if (ring.area <= 0) continue;
    const bool ask = neighbours[v] > 0 && !ring.knows_all();
    const Vector3d s = ring.curvature(ask ? Vector3d(around[v] / neighbours[v])
                                          : Vector3d(ring.guess / ring.area));
    result.row(v) << s[0], s[1] / std::sqrt(2.0), s[2];
  }
  return result;
}

}  // namespace paperbake
