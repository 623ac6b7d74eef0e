#include "core/step1_elastic/energies/membrane.h"

#include <cmath>

namespace paperbake {
namespace {

/// Positive semi-definite part of a symmetric 2x2 matrix.
Eigen::Matrix2d tensile_part(const Eigen::Matrix2d& s) {
  const double mean = 0.5 * (s(0, 0) + s(1, 1));
  const double radius = std::hypot(0.5 * (s(0, 0) - s(1, 1)), s(0, 1));
  const double low = mean - radius, high = mean + radius;
  if (low >= 0) return s;
  if (high <= 0) return Eigen::Matrix2d::Zero();
  return (s - low * Eigen::Matrix2d::Identity()) * (high / (high - low));
}

/// [N/m] lambda of plane stress, and mu, times the thickness.
double lame_modulus(const Paper& paper) {
  return paper.membrane_stiffness * paper.poisson / (1 - paper.poisson * paper.poisson);
}
double shear_modulus(const Paper& paper) {
  return paper.membrane_stiffness / (2 * (1 + paper.poisson));
}

}  // namespace

double membrane_energy(const Paper& paper, const RestTriangle& rest, const Matrix3d& x,
                       Matrix3d* gradient, const MembraneHessian* hessian) {
  const double mu = shear_modulus(paper), lambda = lame_modulus(paper);
  const Eigen::Matrix<double, 3, 2> F = x.transpose() * rest.g;
  const Eigen::Matrix2d G = 0.5 * (F.transpose() * F - Eigen::Matrix2d::Identity());
  const Eigen::Matrix2d S = lambda * G.trace() * Eigen::Matrix2d::Identity() + 2 * mu * G;
  const double energy = rest.area * (0.5 * lambda * G.trace() * G.trace() + mu * G.squaredNorm());
  if (gradient) gradient->noalias() += rest.area * rest.g * S * F.transpose();
  if (!hessian) return energy;

  const Eigen::Matrix2d& felt = hessian->stress ? *hessian->stress : S;
  const Eigen::Matrix2d stress = hessian->form == HessianForm::exact ? felt : tensile_part(felt);
  const Eigen::Matrix3d geometric = rest.area * rest.g * stress * rest.g.transpose();
  const Eigen::Matrix3d metric = rest.area * mu * rest.g * rest.g.transpose();
  const Eigen::Matrix3d FFt = F * F.transpose();
  const Eigen::Matrix3d Fg = F * rest.g.transpose();  // column i: F g_i
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) {
      Eigen::Matrix3d block = metric(i, j) * FFt +
                              (rest.area * lambda) * Fg.col(i) * Fg.col(j).transpose() +
                              (rest.area * mu) * Fg.col(j) * Fg.col(i).transpose();
      block.diagonal().array() += geometric(i, j);
      hessian->sum.block<3, 3>(3 * i, 3 * j) += block;
      if (i != j) hessian->sum.block<3, 3>(3 * j, 3 * i) += block.transpose();
    }
  return energy;
}

Eigen::Matrix2d membrane_stress(const Paper& paper, const RestTriangle& rest, const Matrix3d& x,
                                const Matrix3d& move) {
  const Eigen::Matrix<double, 3, 2> F = x.transpose() * rest.g, change = move.transpose() * rest.g;
  const Eigen::Matrix2d first_order = F.transpose() * change;
  const Eigen::Matrix2d G = 0.5 * (F.transpose() * F - Eigen::Matrix2d::Identity() + first_order +
                                   first_order.transpose());
  return lame_modulus(paper) * G.trace() * Eigen::Matrix2d::Identity() +
         2 * shear_modulus(paper) * G;
}

}  // namespace paperbake
