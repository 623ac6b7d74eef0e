#pragma once

#include "core/step1_elastic/energies/elastic_energy.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

namespace paperbake::validation {

/// What holds the paper besides its own energy.
struct Grips {
  std::vector<int> outer;       // vertices that may not go below the cone
  std::vector<int> on_spheres;  // vertices that keep their distance from the tip
  // |V| vertex at the same place with which a vertex moves, or the vertex itself; empty: no twins
  std::vector<int> twin = {};
};

/// Energy of the paper and of what holds it, and its minimisation.
class GrippedCone {
 public:
  /// eps      slope of the cone below which `outer` may not go
  /// factors  |T| factors on the bending stiffness
  GrippedCone(const Paper& paper, Sheet& sheet, Grips grips, double eps,
              const std::vector<double>& factors)
      : sheet_(sheet),
        grips_(std::move(grips)),
        eps_(eps),
        energy_(paper, sheet.pattern, sheet.triangles, factors),
        block_of_(sheet.x.rows()) {
    for (int v = 0; v < sheet.x.rows(); ++v)
      block_of_[v] = grips_.twin.empty() || grips_.twin[v] == v ? blocks_++ : -1;
    for (int v = 0; v < sheet.x.rows(); ++v)
      if (block_of_[v] < 0) block_of_[v] = block_of_[grips_.twin[v]];
    std::vector<std::pair<int, int>> coupled = energy_.coupled_vertices();
    for (auto& [a, b] : coupled) {
      a = block_of_[a];
      b = block_of_[b];
    }
    matrix_ = std::make_unique<BlockCholesky>(blocks_, coupled);
    energy_.bind(*matrix_, block_of_);
  }

  double energy(const Points3& x) const {
    double sum = energy_.energy(x);
    for (const int v : grips_.outer) sum += 0.5 * obstacle * std::pow(depth(x, v), 2);
    for (const int v : grips_.on_spheres)
      sum += 0.5 * spoke * std::pow(x.row(v).norm() - sheet_.pattern.row(v).norm(), 2);
    return sum;
  }

  /// Newton's method with the exact second derivative, or the projected one where that is not
  /// positive definite.
  /// returns  [m] largest displacement in the last step
  double minimise() {
    constexpr int most = 900;
    double move = 1;
    for (int k = 0; k < most && move > 1e-8; ++k) {
      Points3 gradient;
      constexpr double shift = 1e-6;  // [N/m] the sheet can turn freely about the axis
      for (const HessianForm form : {HessianForm::exact, HessianForm::projected}) {
        matrix_->set_zero();
        energy_.hessian(sheet_.x, form, gradient, *matrix_);
        for (const int v : grips_.outer) push_up(v, gradient);
        for (const int v : grips_.on_spheres) push_back(v, gradient);
        matrix_->shift_diagonal(shift);
        if (matrix_->factorise()) break;
      }
      Eigen::VectorXd b = Eigen::VectorXd::Zero(3 * blocks_);
      for (int v = 0; v < sheet_.x.rows(); ++v)
        b.segment<3>(3 * block_of_[v]) -= gradient.row(v).transpose();
      const Eigen::VectorXd& step = matrix_->solve(b);
      double size = std::min(1.0, 0.002 / step.cwiseAbs().maxCoeff());
      const double before = energy(sheet_.x), slope = -b.dot(step);
      Points3 x;
      for (int halving = 0; halving < 30; ++halving, size *= 0.5) {
        x = sheet_.x;
        for (int v = 0; v < x.rows(); ++v)
          x.row(v) += size * step.segment<3>(3 * block_of_[v]).transpose();
        if (energy(x) <= before + 1e-4 * size * slope + 1e-15 * before) break;
      }
      sheet_.x = x;
      move = size * step.cwiseAbs().maxCoeff();
    }
    return move;
  }

  ElasticEnergy::Parts parts() const { return energy_.parts(sheet_.x); }

 private:
  static constexpr double obstacle = 5e4;  // [N/m] stiffness of the ring against a rim vertex
  // [N/m] stiffness of a vertex against leaving its distance from the tip
  static constexpr double spoke = 4e6;

  /// How far a vertex is below the cone. [m]
  double depth(const Points3& x, int v) const {
    return std::max(0.0, eps_ * std::hypot(x(v, 0), x(v, 1)) - x(v, 2));
  }

  void push_up(int v, Points3& gradient) {
    const double d = depth(sheet_.x, v);
    if (d <= 0) return;
    const Vector3d x = sheet_.x.row(v);
    const double rho = std::hypot(x.x(), x.y());
    const Vector3d n(-eps_ * x.x() / rho, -eps_ * x.y() / rho, 1);
    gradient.row(v) -= obstacle * d * n.transpose();
    matrix_->add(matrix_->slot(block_of_[v], block_of_[v]), obstacle * n * n.transpose());
  }

  /// The distance of the tip itself is 0: it is held in all directions.
  void push_back(int v, Points3& gradient) {
    const Vector3d x = sheet_.x.row(v);
    const double r = sheet_.pattern.row(v).norm();
    if (r < 1e-9) {
      gradient.row(v) += spoke * x.transpose();
      matrix_->add(matrix_->slot(block_of_[v], block_of_[v]), spoke * Eigen::Matrix3d::Identity());
      return;
    }
    const Vector3d out = x.normalized();
    gradient.row(v) += spoke * (x.norm() - r) * out.transpose();
    matrix_->add(matrix_->slot(block_of_[v], block_of_[v]), spoke * out * out.transpose());
  }

  Sheet& sheet_;
  Grips grips_;
  double eps_;
  ElasticEnergy energy_;
  std::vector<int> block_of_;  // |V|
  int blocks_ = 0;
  std::unique_ptr<BlockCholesky> matrix_;
};

}  // namespace paperbake::validation
