#include "core/step1_elastic/energies/elastic_energy.h"

#include "core/geometry/prescribed_creases.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace paperbake {
namespace {

using Matrix18 = Eigen::Matrix<double, 18, 18>;

// [1] of the curvature at which the paper yields: an expected crease becomes a hinge here. At this
// share the plate carries the yield moment of the hinge, so that the moment does not jump.
constexpr double birth_share = 0.6;

/// Where vertex k of the hinge opposite corner i sits among the six vertices of a triangle's
/// stencil. The edge opposite corner i runs from corner i+1 to i+2. So does the hinge if the
/// triangle is its left one; if it is the right one, the hinge runs backwards.
std::array<int, 4> hinge_in_stencil(int i, bool left) {
  const int a = (i + 1) % 3, b = (i + 2) % 3;
  return left ? std::array<int, 4>{a, b, i, 3 + i} : std::array<int, 4>{b, a, 3 + i, i};
}

}  // namespace

ElasticEnergy::ElasticEnergy(const Paper& paper, const Points2& pattern, const Triangles& triangles,
                             const std::vector<double>& stiffening,
                             const std::vector<PrescribedCrease>& creases)
    : paper_(paper),
      pattern_(pattern),
      stiffening_(stiffening),
      triangles_(triangles),
      hinges_(find_hinges(triangles)),
      stencils_(triangles.rows()),
      law_(crease_law(paper)) {
  for (int t = 0; t < triangles.rows(); ++t)
    rest_.push_back(rest_triangle(pattern, triangles.row(t)));
  if (!creases.empty()) crease_of_hinge_.assign(hinges_.hinges.size(), -1);
  for (std::size_t h = 0; h < crease_of_hinge_.size(); ++h) {
    const Hinge& hinge = hinges_.hinges[h];
    const Vector2d a = pattern.row(hinge.vertices[0]), b = pattern.row(hinge.vertices[1]);
    const PrescribedCrease* crease = crease_under(creases, a, b);
    if (!crease) continue;
    const double length = (b - a).norm();
    crease_of_hinge_[h] = static_cast<int>(creases_.size());
    creases_.push_back({static_cast<int>(h), *crease,
                        CreaseEdge{a, b, crease->angle, crease->folded}, length, 0,
                        area_beside(hinge) / length});
  }
  for (int t = 0; t < triangles.rows(); ++t) {
    bend_.push_back(rest_of_bending(t));
    for (int i = 0; i < 3; ++i) {
      stencils_[t].vertices[i] = triangles(t, i);
      const int h = hinges_.of_triangle[t][i];
      stencils_[t].vertices[3 + i] =
          h < 0 ? -1 : hinges_.hinges[h].vertices[hinges_.hinges[h].triangles[0] == t ? 3 : 2];
    }
  }
}

Matrix3d ElasticEnergy::corners(const Points3& x, int t) const {
  Matrix3d c;
  for (int i = 0; i < 3; ++i) c.row(i) = x.row(triangles_(t, i));
  return c;
}

PlasticState ElasticEnergy::past(int t) const {
  if (memory.hardening.size() == 0) return {};
  const double eta = paper_.hardening, focus = ridges.focus.size() ? ridges.focus[t] : 1;
  const double first_yield = 2 * paper_.yield_strain / (paper_.thickness * focus);
  return {memory.curvature.row(t), first_yield + eta / (1 - eta) * memory.hardening[t]};
}

Vector3d ElasticEnergy::angles_of(int t, const std::vector<double>& theta) const {
  Vector3d angles;
  for (int i = 0; i < 3; ++i)
    angles[i] = hinges_.of_triangle[t][i] < 0 ? 0 : theta[hinges_.of_triangle[t][i]];
  return angles;
}

RestBending ElasticEnergy::rest_of_bending(int t) const {
  std::array<double, 3> shared_area{0, 0, 0};
  for (int i = 0; i < 3; ++i) {
    const int h = hinges_.of_triangle[t][i];
    if (h >= 0 && !is_folded(h)) shared_area[i] = area_beside(hinges_.hinges[h]);
  }
  return rest_bending(paper_, pattern_, triangles_.row(t), shared_area,
                      stiffening_.empty() ? 1 : stiffening_[t]);
}

bool ElasticEnergy::is_folded(int hinge) const {
  const int crease = creases_.empty() ? -1 : crease_of_hinge_[hinge];
  return crease >= 0 && creases_[crease].edge.folded;
}

std::vector<bool> ElasticEnergy::folded_hinges() const {
  if (creases_.empty()) return {};
  std::vector<bool> folded(hinges_.hinges.size(), false);
  for (const CreaseHinge& crease : creases_) folded[crease.hinge] = crease.edge.folded;
  return folded;
}

std::vector<double> ElasticEnergy::pressed_hinges() const {
  std::vector<double> pressed(hinges_.hinges.size(), 0.0);
  for (const CreaseHinge& crease : creases_) pressed[crease.hinge] = crease.goal;
  return pressed;
}

CreaseResponse ElasticEnergy::response_of(const CreaseHinge& crease, double theta) const {
  return crease.edge.pressed ? press_crease(law_, crease.edge.rest_angle, crease.goal, theta)
                             : turn_crease(law_, crease.edge.rest_angle, theta);
}

double ElasticEnergy::add_creases(int t, const Vector3d& angles, Vector3d* moment,
                                  Matrix3d* tangent) const {
  if (creases_.empty()) return 0;
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    const int h = hinges_.of_triangle[t][i], c = h < 0 ? -1 : crease_of_hinge_[h];
    if (c < 0 || !creases_[c].edge.folded) continue;
    const double half = 0.5 * creases_[c].length;
    const CreaseResponse response = response_of(creases_[c], angles[i]);
    sum += half * response.energy;
    if (moment) (*moment)[i] += half * response.moment;
    if (tangent) (*tangent)(i, i) += half * response.tangent;
  }
  return sum;
}

std::vector<int> ElasticEnergy::load_creases(const Sheet& sheet) {
  std::set<int> changed, folded;
  for (CreaseHinge& hinge : creases_) {
    const bool was_folded = hinge.edge.folded;
    hinge.edge = crease_edge(sheet, hinge.crease, hinge.edge.a, hinge.edge.b);
    hinge.goal = hinge.edge.pressed.value_or(0);
    if (hinge.edge.folded == was_folded) continue;
    for (const int t : hinges_.hinges[hinge.hinge].triangles) {
      changed.insert(t);
      if (!was_folded) folded.insert(t);
    }
  }
  for (const int t : changed) bend_[t] = rest_of_bending(t);
  return {folded.begin(), folded.end()};
}

void ElasticEnergy::press(const Points3& x, double share) {
  if (share == 1) return;
  for (CreaseHinge& crease : creases_)
    if (crease.edge.pressed) {
      const double now = dihedral_angle(x, hinges_.hinges[crease.hinge]);
      crease.goal = now + share * (*crease.edge.pressed - now);
    }
}

std::vector<CreaseEdge> ElasticEnergy::creases_left(const std::vector<double>& theta) const {
  const double first_yield = yield_curvature(paper_);
  std::vector<CreaseEdge> left;
  for (const CreaseHinge& hinge : creases_) {
    CreaseEdge edge = hinge.edge;
    edge.folded |= std::abs(theta[hinge.hinge]) > birth_share * first_yield * hinge.width;
    if (edge.folded) edge.rest_angle = turn_crease(law_, edge.rest_angle, theta[hinge.hinge]).rest;
    left.push_back(edge);
  }
  return left;
}

PlasticMemory ElasticEnergy::gained(const std::vector<double>& theta) const {
  PlasticMemory sum(static_cast<int>(triangles_.rows()));
  for (int t = 0; t < triangles_.rows(); ++t) {
    const PlasticGain gain = plastic_gain(bend_[t], angles_of(t, theta), past(t));
    sum.curvature.row(t) = gain.curvature;
    sum.hardening[t] = gain.hardening;
    if (gain.hardening > 0 && ridges.share.size()) sum.ridge[t] = ridges.share[t];
  }
  return sum;
}

double ElasticEnergy::energy(const Points3& x) const {
  const Parts p = parts(x);
  return p.membrane + p.bending;
}

ElasticEnergy::Parts ElasticEnergy::parts(const Points3& x,
                                          const std::vector<double>& theta) const {
  Parts sum{0, 0};
  for (int t = 0; t < triangles_.rows(); ++t) {
    sum.membrane += membrane_energy(paper_, rest_[t], corners(x, t));
    const Vector3d angles = angles_of(t, theta);
    sum.bending += bending_energy(bend_[t], angles, past(t)) + add_creases(t, angles);
  }
  return sum;
}

void ElasticEnergy::add_configurational_bending(int t, const Vector3d& angles, Points2& force,
                                                Eigen::VectorXd& by_area) const {
  const RestBending& rest = bend_[t];
  // E depends on sum_i theta_i T_i/A_i, where T_i = l_i n_i n_i^T; M is its derivative
  const Eigen::Matrix2d M = bending_moment_tensor(rest, angles, past(t));
  for (int i = 0; i < 3; ++i) {
    const int h = hinges_.of_triangle[t][i];
    if (h < 0 || is_folded(h)) continue;
    const int a = triangles_(t, (i + 1) % 3), b = triangles_(t, (i + 2) % 3);
    const Vector2d e = pattern_.row(b) - pattern_.row(a);
    const double l = e.norm(), shared = area_beside(hinges_.hinges[h]);
    const Vector2d across(e.y(), -e.x());
    const Vector2d couple = M * across;
    const double T = across.dot(couple) / l;  // M : T_i
    // d T/de, turned back from `across` to e
    const Vector2d slope = 2 / l * Vector2d(-couple.y(), couple.x()) - T / (l * l) * e;
    force.row(b) -= angles[i] / shared * slope;
    force.row(a) += angles[i] / shared * slope;
    for (const int side : hinges_.hinges[h].triangles)
      by_area[side] -= angles[i] * T / (shared * shared);
  }
}

LocalEnergies ElasticEnergy::local_energies(const Points3& x) const {
  const int triangles = static_cast<int>(triangles_.rows());
  LocalEnergies local{Eigen::VectorXd(triangles), Eigen::VectorXd(triangles),
                      Points2::Zero(pattern_.rows(), 2)};
  Eigen::VectorXd by_area = Eigen::VectorXd::Zero(triangles);
  const std::vector<double> theta = dihedral_angles(x);
  for (int t = 0; t < triangles; ++t) {
    const Matrix3d c = corners(x, t);
    const RestTriangle& rest = rest_[t];
    const Vector3d angles = angles_of(t, theta);
    local.membrane[t] = membrane_energy(paper_, rest, c);
    local.bending[t] = bending_energy(bend_[t], angles, past(t));
    add_configurational_bending(t, angles, local.configurational_force, by_area);
    by_area[t] += local.bending[t] / rest.area;
    local.bending[t] += add_creases(t, angles);
    const Eigen::Matrix<double, 3, 2> F = c.transpose() * rest.g;
    const Eigen::Matrix2d momentum =
        local.membrane[t] / rest.area * Eigen::Matrix2d::Identity() -
        F.transpose() * F * membrane_stress(paper_, rest, c, Matrix3d::Zero());
    for (int i = 0; i < 3; ++i)
      local.configurational_force.row(triangles_(t, i)) -=
          rest.area * rest.g.row(i) * momentum.transpose();
  }
  for (int t = 0; t < triangles; ++t)
    for (int i = 0; i < 3; ++i)
      local.configurational_force.row(triangles_(t, i)) -=
          by_area[t] * rest_[t].area * rest_[t].g.row(i);
  return local;
}

double ElasticEnergy::gradient(const Points3& x, Points3& gradient) const {
  return evaluate(x, HessianForm::exact, &gradient, nullptr);
}

double ElasticEnergy::hessian(const Points3& x, HessianForm form, Points3& gradient,
                              BlockCholesky& matrix, const MembraneStress* stress) const {
  return evaluate(x, form, &gradient, &matrix, stress);
}

MembraneStress ElasticEnergy::stress(const Points3& x, const Points3& move) const {
  MembraneStress all;
  all.reserve(triangles_.rows());
  for (int t = 0; t < triangles_.rows(); ++t)
    all.push_back(membrane_stress(paper_, rest_[t], corners(x, t), corners(move, t)));
  return all;
}

double ElasticEnergy::evaluate(const Points3& x, HessianForm form, Points3* gradient,
                               BlockCholesky* matrix, const MembraneStress* stress) const {
  gradient->setZero(x.rows(), 3);
  std::vector<DihedralAngle> folds(hinges_.hinges.size());
  for (std::size_t h = 0; h < folds.size(); ++h)
    folds[h] = dihedral_angle_gradient(x, hinges_.hinges[h]);

  // an angle gets the moments of both its triangles
  double sum = 0;
  std::vector<double> moment(folds.size(), 0.0);
  std::vector<Matrix3d> tangent(matrix ? triangles_.rows() : 0);
  for (int t = 0; t < triangles_.rows(); ++t) {
    Vector3d angles, m;
    for (int i = 0; i < 3; ++i)
      angles[i] = hinges_.of_triangle[t][i] < 0 ? 0 : folds[hinges_.of_triangle[t][i]].theta;
    sum += bending_energy(bend_[t], angles, past(t), &m, matrix ? &tangent[t] : nullptr);
    sum += add_creases(t, angles, &m, matrix ? &tangent[t] : nullptr);
    for (int i = 0; i < 3; ++i)
      if (hinges_.of_triangle[t][i] >= 0) moment[hinges_.of_triangle[t][i]] += m[i];
  }
  for (std::size_t h = 0; h < folds.size(); ++h)
    for (int k = 0; k < 4; ++k)
      gradient->row(hinges_.hinges[h].vertices[k]) += moment[h] * folds[h].slope.row(k);

  for (int t = 0; t < triangles_.rows(); ++t) {
    Matrix3d g = Matrix3d::Zero();
    Matrix9 k = Matrix9::Zero();
    const Matrix3d c = corners(x, t);
    const MembraneHessian hessian{k, form, stress ? &(*stress)[t] : nullptr};
    sum += membrane_energy(paper_, rest_[t], c, &g, matrix ? &hessian : nullptr);
    for (int i = 0; i < 3; ++i) gradient->row(triangles_(t, i)) += g.row(i);
    if (!matrix) continue;
    Vector3d edge_moment;
    for (int i = 0; i < 3; ++i)
      edge_moment[i] = hinges_.of_triangle[t][i] < 0 ? 0 : moment[hinges_.of_triangle[t][i]];
    add_element(t, {c, k, tangent[t], edge_moment}, folds, form, *matrix);
  }
  return sum;
}

void ElasticEnergy::add_element(int t, const Element& element,
                                const std::vector<DihedralAngle>& folds, HessianForm form,
                                BlockCholesky& matrix) const {
  const auto& [c, own, tangent, moments] = element;
  // d theta / dx of the three angles of this triangle, over the six vertices of its stencil
  Eigen::Matrix<double, 18, 3> J = Eigen::Matrix<double, 18, 3>::Zero();
  for (int i = 0; i < 3; ++i) {
    const int h = hinges_.of_triangle[t][i];
    if (h < 0) continue;
    const bool left = hinges_.hinges[h].triangles[0] == t;
    const std::array<int, 4> at = hinge_in_stencil(i, left);
    for (int k = 0; k < 4; ++k) J.block<3, 1>(3 * at[k], i) = folds[h].slope.row(k);
    if (form == HessianForm::projected) continue;
    // the Hessian of the dihedral angle: the part of this wing lives on the corners of the triangle
    const int x0 = at[0], x1 = at[1];
    const DihedralHessian w = dihedral_hessian_of_wing((c.row(x1) - c.row(x0)).transpose(),
                                                       (c.row(i) - c.row(x0)).transpose(), left);
    const Matrix3d ee = moments[i] * w.ee, ea = moments[i] * w.ea, aa = moments[i] * w.aa;
    const Matrix3d by_1 = ee + ea.transpose(), by_wing = ea + aa;  // minus the row of x0
    const auto block = [&](int p, int q) { return own.block<3, 3>(3 * p, 3 * q); };
    block(x0, x0) += by_1 + by_wing;
    block(x0, x1) -= by_1;
    block(x0, i) -= by_wing;
    block(x1, x0) -= by_1.transpose();
    block(i, x0) -= by_wing.transpose();
    block(x1, x1) += ee;
    block(x1, i) += ea;
    block(i, x1) += ea.transpose();
    block(i, i) += aa;
  }
  const Eigen::Matrix<double, 18, 3> JK = J.lazyProduct(tangent);
  Matrix18 full = J.lazyProduct(JK.transpose());
  full.topLeftCorner<9, 9>() += own;
  for (int p = 0, k = 0; p < 6; ++p)
    for (int q = p; q < 6; ++q, ++k) {
      matrix.add(stencils_[t].slots[k], full.block<3, 3>(3 * p, 3 * q));
      // two wings may be the same vertex (around a vertex of valence 3): then the mirror image
      // falls on the same block
      if (p != q && stencils_[t].vertices[p] == stencils_[t].vertices[q])
        matrix.add(stencils_[t].slots[k], full.block<3, 3>(3 * q, 3 * p));
    }
}

std::vector<std::pair<int, int>> ElasticEnergy::coupled_vertices() const {
  std::vector<std::pair<int, int>> pairs;
  for (const Stencil& s : stencils_)
    for (int p = 0; p < 6; ++p)
      for (int q = p + 1; q < 6; ++q)
        if (s.vertices[p] >= 0 && s.vertices[q] >= 0)
          pairs.emplace_back(s.vertices[p], s.vertices[q]);
  return pairs;
}

void ElasticEnergy::bind(const BlockCholesky& matrix, const std::vector<int>& block_of) {
  const auto block = [&](int v) { return v < 0 ? -1 : block_of[v]; };
  for (Stencil& s : stencils_)
    for (int p = 0, k = 0; p < 6; ++p)
      for (int q = p; q < 6; ++q, ++k)
        s.slots[k] = matrix.slot(block(s.vertices[p]), block(s.vertices[q]));
}

}  // namespace paperbake
