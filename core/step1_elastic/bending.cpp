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

Matrix9 fold_hessian_of_wing(const Vector3d& x0, const Vector3d& x1, const Vector3d& wing, bool left) {
  // The wing's part of the slope is (-(1-t), -t, 1) (x) w with w = -|e| n/|n|^2, n = +-(e x a), a = wing - x0,
  // t = a.e/|e|^2. Differentiate w and t by the three points.
  const Vector3d e = x1 - x0, a = wing - x0;
  const Vector3d n = left ? Vector3d(e.cross(a)) : Vector3d(a.cross(e));
  const double length = e.norm(), n2 = n.squaredNorm();
  const Vector3d w = -length / n2 * n;
  const double t = a.dot(e) / (length * length);

  const double sign = left ? 1 : -1;
  const Eigen::Matrix3d dn_e = -sign * cross_matrix(a), dn_a = sign * cross_matrix(e);
  const Eigen::Matrix3d dw_n = -length / n2 * (Eigen::Matrix3d::Identity() - 2 / n2 * n * n.transpose());
  const Eigen::Matrix3d dw_e = dw_n * dn_e - (1 / (length * n2)) * n * e.transpose(), dw_a = dw_n * dn_a;
  const Vector3d dt_e = (a - 2 * t * e) / (length * length), dt_a = e / (length * length);

  // e = x1 - x0, a = wing - x0
  const Eigen::Matrix3d dw[3] = {-dw_e - dw_a, dw_e, dw_a};
  const Vector3d dt[3] = {-dt_e - dt_a, dt_e, dt_a};
  const double weight[3] = {t - 1, -t, 1}, weight_t[3] = {1, -1, 0};
  Matrix9 h;
  for (int p = 0; p < 3; ++p)
    for (int q = 0; q < 3; ++q) h.block<3, 3>(3 * p, 3 * q) = weight[p] * dw[q] + weight_t[p] * w * dt[q].transpose();
  return 0.5 * (h + h.transpose());
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
