#pragma once

#include <Eigen/SparseCore>

#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// A positive definite matrix factored once, to be solved for three columns (x, y, z) again and
/// again: the same matrix for each. The factor is kept in 32-bit floats and the columns go through
/// it together, which is what makes it fast; so the right hand side should be a residual, and what
/// it leaves of one is some 1e-4.
class ColumnCholesky {
 public:
  /// lower  lower triangle of the matrix. throws Error(Fault::simulation) when it is not positive
  ///        definite
  explicit ColumnCholesky(const Eigen::SparseMatrix<double>& lower);
  /// b  |n|x3. returns |n|x3
  Points3 solve(const Points3& b) const;

 private:
  std::vector<int> place_;        // of row i in the order of elimination
  std::vector<int> start_, row_;  // columns of the factor below its diagonal
  std::vector<float> value_, inverse_diagonal_;
};

}  // namespace paperbake
