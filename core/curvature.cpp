#include "core/curvature.h"

#include "core/hinges.h"

#include <array>
#include <cmath>
#include <vector>

namespace paperbake {
namespace {

using Eigen::Matrix2d;

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// A fold spread over its two triangles, as one of the terms of S.
struct Term {
  double k;    // [1/m]
  Vector2d n;  // unit
};

/// What a border edge with the normal b adds to the terms of the two other edges, so that the determinant vanishes.
Matrix2d completion(const Term& p, const Term& q, const Vector2d& b) {
  if (p.k * q.k <= 0) return Matrix2d::Zero();
  const double pq = cross(p.n, q.n), pb = cross(p.n, b), qb = cross(q.n, b);
  return -p.k * q.k * pq * pq / (p.k * pb * pb + q.k * qb * qb) * b * b.transpose();
}

}  // namespace

Points3 vertex_curvature(const Sheet& sheet) {
  const Hinges hinges = find_hinges(sheet.triangles);
  const auto corner = [&](int t, int i) -> Vector2d { return sheet.pattern.row(sheet.triangles(t, i % 3)); };
  const auto area = [&](int t) { return 0.5 * cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0)); };
  std::vector<double> bend;  // theta/A of each hinge [1/m2]
  for (const Hinge& hinge : hinges.hinges) bend.push_back(fold_angle(sheet.x, hinge) / (area(hinge.triangles[0]) + area(hinge.triangles[1])));

  Points3 sum = Points3::Zero(sheet.pattern.rows(), 3);
  Eigen::VectorXd weight = Eigen::VectorXd::Zero(sheet.pattern.rows());
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    Matrix2d S = Matrix2d::Zero();
    std::array<Term, 3> terms;
    Vector2d border;
    int told = 0;
    for (int i = 0; i < 3; ++i) {
      const Vector2d edge = corner(t, i + 2) - corner(t, i + 1), n = Vector2d(edge.y(), -edge.x()).normalized();
      const int h = hinges.of_triangle[t][i];
      if (h < 0) {
        border = n;
        continue;
      }
      terms[told] = {bend[h] * edge.norm(), n};
      S += terms[told++].k * n * n.transpose();
    }
    if (told == 2) S += completion(terms[0], terms[1], border);
    for (int i = 0; i < 3; ++i) {
      sum.row(sheet.triangles(t, i)) += area(t) * Eigen::RowVector3d(S(0, 0), S(0, 1), S(1, 1));
      weight[sheet.triangles(t, i)] += area(t);
    }
  }
  for (int v = 0; v < sum.rows(); ++v)
    if (weight[v] > 0) sum.row(v) /= weight[v];
  return sum;
}

Principal principal_curvature(const Vector3d& tensor) {
  const double mean = 0.5 * (tensor[0] + tensor[2]), half_difference = 0.5 * (tensor[0] - tensor[2]);
  const double radius = std::hypot(half_difference, tensor[1]);
  const double phi = 0.5 * std::atan2(tensor[1], half_difference);  // of the algebraically larger eigenvalue
  if (mean >= 0) return {mean + radius, mean - radius, {std::cos(phi), std::sin(phi)}};
  return {mean - radius, mean + radius, {-std::sin(phi), std::cos(phi)}};
}

}  // namespace paperbake
