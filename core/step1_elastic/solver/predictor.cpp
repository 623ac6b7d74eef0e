#include "core/step1_elastic/solver/predictor.h"

#include "core/geometry/rest_triangle.h"

namespace paperbake {

Predictor::Predictor(const Points2& pattern, const Triangles& triangles, std::vector<int> held)
    : held_(std::move(held)) {
  place_.assign(pattern.rows(), 0);
  for (std::size_t k = 0; k < held_.size(); ++k) place_[held_[k]] = -1 - static_cast<int>(k);
  int free = 0;
  for (int& p : place_)
    if (p == 0) p = free++;
  if (held_.empty() || free == 0) return;

  std::vector<Eigen::Triplet<double>> inner, border;
  for (int t = 0; t < triangles.rows(); ++t) {
    const RestTriangle rest = rest_triangle(pattern, triangles.row(t));
    const Matrix3d stiffness = rest.area * rest.g * rest.g.transpose();
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const int p = place_[triangles(t, i)], q = place_[triangles(t, j)];
        if (p >= 0 && q >= 0) inner.emplace_back(p, q, stiffness(i, j));
        if (p >= 0 && q < 0) border.emplace_back(p, -1 - q, stiffness(i, j));
      }
  }
  Eigen::SparseMatrix<double> matrix(free, free);
  matrix.setFromTriplets(inner.begin(), inner.end());
  coupling_.resize(free, static_cast<int>(held_.size()));
  coupling_.setFromTriplets(border.begin(), border.end());
  laplacian_.compute(matrix);
  // a part of the mesh that nothing holds: only what is held moves
  if (laplacian_.info() != Eigen::Success) coupling_.resize(0, 0);
}

void Predictor::spread(const PositionConstraints& hard, Points3& guess) const {
  if (held_.empty()) return;
  Eigen::MatrixXd missing(held_.size(), 3);
  for (std::size_t k = 0; k < held_.size(); ++k)
    missing.row(k) = hard[k].target.transpose() - guess.row(held_[k]);
  for (const PositionConstraint& c : hard) guess.row(c.vertex) = c.target;
  if (coupling_.rows() == 0 || missing.isZero(0)) return;
  const Eigen::MatrixXd move = laplacian_.solve(-coupling_ * missing);
  for (int v = 0; v < guess.rows(); ++v)
    if (place_[v] >= 0) guess.row(v) += move.row(place_[v]);
}

std::vector<Points3> Predictor::guesses(const Points3& x, const std::deque<Points3>& past,
                                        const PositionConstraints& hard) const {
  std::vector<Points3> all{x};
  if (past.size() > 0) all.push_back(2 * x - past[0]);
  if (past.size() > 1) all.push_back(3 * x - 3 * past[0] + past[1]);
  for (Points3& guess : all) spread(hard, guess);
  return all;
}

}  // namespace paperbake
