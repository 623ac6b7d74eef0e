#pragma once

#include <Eigen/SparseCore>

#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// Cholesky factor of a positive definite matrix that is to be solved many times, for three columns
/// (x, y, z) at once. It is fast because the factor is kept in 32-bit floats and the three columns
/// go through it together. So the right-hand side should be a residual; the error is about 1e-4 of
/// it.
class ColumnCholesky {
 public:
  /// lower   lower triangle of the matrix
  /// throws  Error(ErrorCode::simulation) if the matrix is not positive definite
  explicit ColumnCholesky(const Eigen::SparseMatrix<double>& lower);
  /// b        |n|x3
  /// returns  |n|x3
  Points3 solve(const Points3& b) const;

 private:
  std::vector<int> place_;        // of row i in the elimination order
  std::vector<int> start_, row_;  // columns of the factor below its diagonal
  std::vector<float> value_, inverse_diagonal_;
};

}  // namespace paperbake
