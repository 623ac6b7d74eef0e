#include "core/step1_elastic/energies/bending.h"

#include "core/model/segment2.h"

#include <cmath>

namespace paperbake {
namespace {

Eigen::Matrix3d cross_matrix(const Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

/// The map C -> G C G on (xx, xy, yy), where G scales by g along the unit vector at this angle and
/// by 1/g across it.
Eigen::Matrix3d grain_map(double g, double angle) {
  const Vector2d along(std::cos(angle), std::sin(angle)), across(-along.y(), along.x());
  const Eigen::Matrix2d G = g * along * along.transpose() + 1 / g * across * across.transpose();
  Eigen::Matrix3d map;
  for (int k = 0; k < 3; ++k) {
    Eigen::Matrix2d C = Eigen::Matrix2d::Zero();
    C(k / 2, (k + 1) / 2) = C((k + 1) / 2, k / 2) = 1;
    const Eigen::Matrix2d mapped = G * C * G;
    map.col(k) << mapped(0, 0), mapped(0, 1), mapped(1, 1);
  }
  return map;
}

/// S' = S - Sp, its trace and its q^2.
struct ElasticCurvature {
  Vector3d S;
  double trace, q_squared;
};
ElasticCurvature elastic_curvature(const RestBending& rest, const Vector3d& theta,
                                   const Vector3d& plastic) {
  ElasticCurvature e;
  e.S = rest.operator_of_theta * theta - rest.seen * plastic;
  e.trace = e.S[0] + e.S[2];
  const double norm2 = e.S[0] * e.S[0] + 2 * e.S[1] * e.S[1] + e.S[2] * e.S[2];
  e.q_squared = rest.poisson * e.trace * e.trace + (1 - rest.poisson) * norm2;
  return e;
}

/// Half the derivative of q^2 with respect to Sxx, Sxy, Syy.
Vector3d couple_of(double poisson, const Vector3d& S, double trace) {
  return {poisson * trace + (1 - poisson) * S[0], 2 * (1 - poisson) * S[1],
          poisson * trace + (1 - poisson) * S[2]};
}

}  // namespace

DihedralAngle dihedral_angle_gradient(const Points3& x, const Hinge& hinge) {
  const auto at = [&](int k) -> Vector3d { return x.row(hinge.vertices[k]); };
  const Vector3d x0 = at(0), e = at(1) - x0;
  const Vector3d left = e.cross(at(2) - x0), right = (at(3) - x0).cross(e);
  const double length = e.norm();
  const Vector3d g2 = -length / left.squaredNorm() * left;
  const Vector3d g3 = -length / right.squaredNorm() * right;
  // where the heights of the wings meet the edge, as a fraction of its length
  const double t2 = (at(2) - x0).dot(e) / (length * length);
  const double t3 = (at(3) - x0).dot(e) / (length * length);
  DihedralAngle result;
  result.theta = std::atan2(left.cross(right).dot(e) / length, left.dot(right));
  result.slope.row(0) = -(1 - t2) * g2 - (1 - t3) * g3;
  result.slope.row(1) = -t2 * g2 - t3 * g3;
  result.slope.row(2) = g2;
  result.slope.row(3) = g3;
  return result;
}

DihedralHessian dihedral_hessian_of_wing(const Vector3d& e, const Vector3d& a, bool left) {
  // This wing's part of the gradient is -t w with respect to e and w with respect to a, with w =
  // -|e| n/|n|^2, n = +-(e x a), t = a.e/|e|^2. The skew parts of its derivatives, twice by a and
  // twice by e, cancel against those of the other wing; what is left are dyads with n.
  const double sign = left ? 1 : -1;
  const Vector3d cross = sign * e.cross(a);
  const double area2 = cross.norm(), length = e.norm(), t = a.dot(e) / (length * length);
  const Vector3d n = cross / area2;
  const Vector3d by_e = sign * a.cross(n), by_a = sign * n.cross(e);  // gradients of |e x a|
  const double c = length / (area2 * area2);
  const Vector3d bend_e = 2 * c * by_e - e / (length * area2);
  const Vector3d q = (a - 2 * t * e) / (length * area2) - t * bend_e;
  const Vector3d p = e / (length * area2) - 2 * t * c * by_a;

  DihedralHessian h;
  h.ee = 0.5 * (n * q.transpose() + q * n.transpose());
  h.aa = c * (n * by_a.transpose() + by_a * n.transpose());
  h.ea = 0.5 * (n * p.transpose() + bend_e * n.transpose() - sign * c * cross_matrix(a - t * e));
  return h;
}

RestBending rest_bending(const Paper& paper, const Points2& pattern,
                         const Eigen::RowVector3i& corners,
                         const std::array<double, 3>& shared_area, double stiffening) {
  RestBending rest;
  const Vector2d p[3] = {pattern.row(corners[0]), pattern.row(corners[1]), pattern.row(corners[2])};
  const Vector2d u = p[1] - p[0], v = p[2] - p[0];
  rest.area = 0.5 * cross(u, v);
  rest.rigidity = stiffening * paper.bending_stiffness;
  rest.poisson = paper.poisson;
  rest.hardening = paper.hardening;
  const Vector3d frobenius(1, 2, 1);  // weights of Sxx, Sxy, Syy in the product of two tensors
  std::vector<Vector3d> unseen;       // orthonormal tensors that only border edges would show
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
  rest.seen.setIdentity();
  for (const Vector3d& u : unseen) {
    rest.seen -= u * u.cwiseProduct(frobenius).transpose();
    for (int i = 0; i < 3; ++i) {
      const double part = rest.operator_of_theta.col(i).cwiseProduct(frobenius).dot(u);
      rest.operator_of_theta.col(i) -= part * u;
    }
  }
  rest.kept.setIdentity();
  if (paper.grain_ratio != 1) {
    const double g = std::pow(paper.grain_ratio, 0.125);
    const Eigen::Matrix3d map = grain_map(g, paper.grain_angle);
    rest.operator_of_theta = map * rest.operator_of_theta;
    rest.seen = map * rest.seen;
    rest.kept = grain_map(1 / g, paper.grain_angle);
  }
  // K = D A ( nu tr^T tr + (1-nu) S^T diag(1,2,1) S ) in terms of the three angles
  const Eigen::RowVector3d trace = rest.operator_of_theta.row(0) + rest.operator_of_theta.row(2);
  const Eigen::Matrix3d weighted = Vector3d(1, 2, 1).asDiagonal() * rest.operator_of_theta;
  rest.stiffness = rest.rigidity * rest.area *
                   (rest.poisson * trace.transpose() * trace +
                    (1 - rest.poisson) * rest.operator_of_theta.transpose() * weighted);
  return rest;
}

double bending_energy(const RestBending& rest, const Vector3d& theta, const PlasticState& plastic,
                      Vector3d* moment, Matrix3d* tangent) {
  const auto [S, trace, q_squared] = elastic_curvature(rest, theta, plastic.curvature);
  const double scale = rest.rigidity * rest.area;
  const bool yields = q_squared > plastic.yield * plastic.yield;
  const Vector3d m = scale * rest.operator_of_theta.transpose() * couple_of(rest.poisson, S, trace);
  if (!yields) {
    if (moment) *moment = m;
    if (tangent) *tangent = rest.stiffness;
    return 0.5 * scale * q_squared;
  }
  const double q = std::sqrt(q_squared), q_y = plastic.yield, eta = rest.hardening,
               beyond = q - q_y;
  const double phi = (q_y + eta * beyond) / q;
  if (moment) *moment = phi * m;
  if (tangent)
    *tangent = phi * rest.stiffness + (eta - phi) / (scale * q_squared) * m * m.transpose();
  return scale * (0.5 * q_y * q_y + q_y * beyond + 0.5 * eta * beyond * beyond);
}

Eigen::Matrix2d bending_moment_tensor(const RestBending& rest, const Vector3d& theta,
                                      const PlasticState& plastic) {
  const auto [S, trace, q_squared] = elastic_curvature(rest, theta, plastic.curvature);
  double phi = 1;  // [1] of the elastic moment
  if (const double q = std::sqrt(q_squared); q > plastic.yield)
    phi = (plastic.yield + rest.hardening * (q - plastic.yield)) / q;
  const Vector3d m =
      phi * rest.rigidity * rest.area * rest.seen.transpose() * couple_of(rest.poisson, S, trace);
  Eigen::Matrix2d M;
  M << m[0], 0.5 * m[1], 0.5 * m[1], m[2];
  return M;
}

PlasticGain plastic_gain(const RestBending& rest, const Vector3d& theta,
                         const PlasticState& plastic) {
  const ElasticCurvature e = elastic_curvature(rest, theta, plastic.curvature);
  const double q = std::sqrt(e.q_squared);
  if (!(q > plastic.yield)) return {};
  const double flowed = (1 - rest.hardening) * (q - plastic.yield);  // q - q_el
  return {flowed / q * (rest.kept * e.S), flowed};
}

}  // namespace paperbake
