#include "core/step1_elastic/bending.h"

#include "core/error.h"

#include <cmath>
#include <unordered_map>

namespace paperbake {
namespace {

Eigen::Matrix3d cross_matrix(const Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

struct FoldNormals {
  Vector3d e, n_left, n_right;  // edge, normals of the wings (length 2 x area)
};

FoldNormals fold_normals(const Points3& x, const Hinge& hinge) {
  const auto at = [&](int k) -> Vector3d { return x.row(hinge.vertices[k]); };
  const Vector3d x0 = at(0), e = at(1) - x0;
  return {e, e.cross(at(2) - x0), (at(3) - x0).cross(e)};
}

double angle_between(const FoldNormals& f) {
  return std::atan2(f.n_left.cross(f.n_right).dot(f.e) / f.e.norm(), f.n_left.dot(f.n_right));
}

}  // namespace

Hinges find_hinges(const Triangles& triangles) {
  struct Side {
    int triangle, corner;
  };
  Hinges result;
  result.of_triangle.assign(triangles.rows(), {-1, -1, -1});
  std::unordered_map<std::uint64_t, Side> open;
  open.reserve(2 * triangles.rows());
  const auto key = [](std::uint32_t a, std::uint32_t b) { return (std::uint64_t(a) << 32) | b; };
  for (int t = 0; t < triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i) {
      const int a = triangles(t, (i + 1) % 3), b = triangles(t, (i + 2) % 3);
      const auto twin = open.find(key(b, a));
      if (twin == open.end()) {
        if (!open.emplace(key(a, b), Side{t, i}).second)
          throw Error(Fault::simulation, "mesh", "An edge of the mesh has more than two triangles, or two with opposite sides up.");
        continue;
      }
      const auto [other, corner] = twin->second;
      result.of_triangle[other][corner] = result.of_triangle[t][i] = static_cast<int>(result.hinges.size());
      result.hinges.push_back({{b, a, triangles(other, corner), triangles(t, i)}, {other, t}});
      open.erase(twin);
    }
  return result;
}

double fold_angle(const Points3& x, const Hinge& hinge) { return angle_between(fold_normals(x, hinge)); }

Fold fold(const Points3& x, const Hinge& hinge) {
  const FoldNormals f = fold_normals(x, hinge);
  const double length = f.e.norm();
  const Vector3d x0 = x.row(hinge.vertices[0]);
  const Vector3d g2 = -length / f.n_left.squaredNorm() * f.n_left;
  const Vector3d g3 = -length / f.n_right.squaredNorm() * f.n_right;
  // where the heights of the wings meet the edge, as a fraction of it
  const double t2 = (x.row(hinge.vertices[2]).transpose() - x0).dot(f.e) / (length * length);
  const double t3 = (x.row(hinge.vertices[3]).transpose() - x0).dot(f.e) / (length * length);
  Fold result;
  result.theta = angle_between(f);
  result.slope.row(0) = -(1 - t2) * g2 - (1 - t3) * g3;
  result.slope.row(1) = -t2 * g2 - t3 * g3;
  result.slope.row(2) = g2;
  result.slope.row(3) = g3;
  return result;
}

WingHessian fold_hessian_of_wing(const Vector3d& e, const Vector3d& a, bool left) {
  // The wing's part of the slope is -t w by e and w by a, with w = -|e| n/|n|^2, n = +-(e x a), t = a.e/|e|^2.
  // What is skew in its derivative by a twice and e twice cancels against the other wing; the rest are dyads with n.
  const double sign = left ? 1 : -1;
  const Vector3d cross = sign * e.cross(a);
  const double area2 = cross.norm(), length = e.norm(), t = a.dot(e) / (length * length);
  const Vector3d n = cross / area2;
  const Vector3d by_e = sign * a.cross(n), by_a = sign * n.cross(e);  // gradients of |e x a|
  const double c = length / (area2 * area2);
  const Vector3d bend_e = 2 * c * by_e - e / (length * area2);
  const Vector3d q = (a - 2 * t * e) / (length * area2) - t * bend_e;
  const Vector3d p = e / (length * area2) - 2 * t * c * by_a;

  WingHessian h;
  h.ee = 0.5 * (n * q.transpose() + q * n.transpose());
  h.aa = c * (n * by_a.transpose() + by_a * n.transpose());
  h.ea = 0.5 * (n * p.transpose() + bend_e * n.transpose() - sign * c * cross_matrix(a - t * e));
  return h;
}

RestBending rest_bending(const Paper& paper, const Points2& pattern, const Eigen::RowVector3i& corners,
                         const std::array<double, 3>& shared_area, double stiffening) {
  RestBending rest;
  const Vector2d p[3] = {pattern.row(corners[0]), pattern.row(corners[1]), pattern.row(corners[2])};
  const Vector2d u = p[1] - p[0], v = p[2] - p[0];
  rest.area = 0.5 * (u.x() * v.y() - u.y() * v.x());
  rest.rigidity = stiffening * paper.bending_stiffness;
  rest.poisson = paper.poisson;
  const Vector3d frobenius(1, 2, 1);  // weights of Sxx, Sxy, Syy in the product of two tensors
  std::vector<Vector3d> unseen;       // orthonormal tensors that border edges would add
  rest.operator_of_theta.setZero();
  for (int i = 0; i < 3; ++i) {
    const Vector2d edge = p[(i + 2) % 3] - p[(i + 1) % 3];
    const double length = edge.norm();
    const Vector2d n(edge.y() / length, -edge.x() / length);
    Vector3d tensor(n.x() * n.x(), n.x() * n.y(), n.y() * n.y());
    if (shared_area[i] > 0) {
      rest.operator_of_theta.col(i) = length / shared_area[i] * tensor;
      continue;
    }
    for (const Vector3d& u : unseen) tensor -= tensor.cwiseProduct(frobenius).dot(u) * u;
    const double norm = std::sqrt(tensor.cwiseProduct(frobenius).dot(tensor));
    if (norm > 1e-9) unseen.push_back(tensor / norm);
  }
  for (const Vector3d& u : unseen)
    for (int i = 0; i < 3; ++i) {
      const double part = rest.operator_of_theta.col(i).cwiseProduct(frobenius).dot(u);
      rest.operator_of_theta.col(i) -= part * u;
    }
  // K = D A ( nu tr^T tr + (1-nu) S^T diag(1,2,1) S ) in the three angles
  const Eigen::RowVector3d trace = rest.operator_of_theta.row(0) + rest.operator_of_theta.row(2);
  const Eigen::Matrix3d weighted = Vector3d(1, 2, 1).asDiagonal() * rest.operator_of_theta;
  rest.stiffness = rest.rigidity * rest.area *
                   (rest.poisson * trace.transpose() * trace + (1 - rest.poisson) * rest.operator_of_theta.transpose() * weighted);
  return rest;
}

double bending_energy(const RestBending& rest, const Vector3d& theta, const Vector3d& plastic, Vector3d* moment) {
  const Vector3d S = rest.operator_of_theta * theta - plastic;
  const double trace = S[0] + S[2];
  const double scale = rest.rigidity * rest.area;
  if (moment) {
    const Vector3d couple(rest.poisson * trace + (1 - rest.poisson) * S[0], 2 * (1 - rest.poisson) * S[1],
                          rest.poisson * trace + (1 - rest.poisson) * S[2]);
    *moment = scale * rest.operator_of_theta.transpose() * couple;
  }
  const double norm2 = S[0] * S[0] + 2 * S[1] * S[1] + S[2] * S[2];
  return 0.5 * scale * (rest.poisson * trace * trace + (1 - rest.poisson) * norm2);
}

}  // namespace paperbake
