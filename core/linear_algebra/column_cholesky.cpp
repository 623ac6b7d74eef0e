#include "core/linear_algebra/column_cholesky.h"

#include "core/model/error.h"

#include <Eigen/SparseCholesky>

namespace paperbake {

ColumnCholesky::ColumnCholesky(const Eigen::SparseMatrix<double>& lower) {
  const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> solver(lower);
  if (solver.info() != Eigen::Success)
    throw Error(ErrorCode::simulation, "render mesh", "Its matrix is not positive definite.");
  const int n = static_cast<int>(lower.rows());
  place_.assign(solver.permutationP().indices().data(), solver.permutationP().indices().data() + n);
  const Eigen::SparseMatrix<double> factor = solver.matrixL();
  start_.reserve(n + 1);
  row_.reserve(factor.nonZeros() - n);
  value_.reserve(factor.nonZeros() - n);
  for (int j = 0; j < n; ++j) {
    start_.push_back(static_cast<int>(row_.size()));
    for (Eigen::SparseMatrix<double>::InnerIterator it(factor, j); it; ++it) {
      if (it.row() == j) {
        inverse_diagonal_.push_back(static_cast<float>(1 / it.value()));
      } else {
        row_.push_back(static_cast<int>(it.row()));
        value_.push_back(static_cast<float>(it.value()));
      }
    }
  }
  start_.push_back(static_cast<int>(row_.size()));
}

Points3 ColumnCholesky::solve(const Points3& b) const {
  const int n = static_cast<int>(place_.size());
  using Four = Eigen::Array4f;  // three columns and one that is idle: one register
  std::vector<Four, Eigen::aligned_allocator<Four>> x(n);
  for (int i = 0; i < n; ++i) x[place_[i]] << b.row(i).transpose().cast<float>().array(), 0.0f;
  for (int j = 0; j < n; ++j) {
    const Four known = x[j] *= inverse_diagonal_[j];
    for (int k = start_[j]; k < start_[j + 1]; ++k) x[row_[k]] -= value_[k] * known;
  }
  for (int j = n - 1; j >= 0; --j) {
    // two chains of additions, so that neither has to wait for the other
    Four sum[2] = {x[j], Four::Zero()};
    int k = start_[j];
    for (; k + 1 < start_[j + 1]; k += 2) {
      sum[0] -= value_[k] * x[row_[k]];
      sum[1] -= value_[k + 1] * x[row_[k + 1]];
    }
    if (k < start_[j + 1]) sum[0] -= value_[k] * x[row_[k]];
    x[j] = (sum[0] + sum[1]) * inverse_diagonal_[j];
  }
  Points3 solution(n, 3);
  for (int i = 0; i < n; ++i)
    solution.row(i) = x[place_[i]].head<3>().cast<double>().matrix().transpose();
  return solution;
}

}  // namespace paperbake
