#pragma once

#include <Eigen/SparseCore>

#include "core/model/sheet.h"

#include <cstddef>
#include <vector>

namespace paperbake {

/// Cholesky factor of a positive definite matrix that is to be solved many times, for three columns
/// (x, y, z) at once. It is fast because the factor is kept in 32-bit floats and the three columns
/// go through it together. So the right-hand side should be a residual; the error is about 1e-4 of
/// it.
///
/// Neighbouring columns of the factor whose rows are nearly the same are kept as one dense panel of
/// up to eight: a value that they all change is then read and written once. The factor is computed
/// in 64 bits, panel by panel as well, each from those before it [Ng 1993]; the products are
/// written out here, so that no library chooses their order by the processor.
class ColumnCholesky {
 public:
  /// lower   lower triangle of the matrix
  /// throws  Error(ErrorCode::simulation) if the matrix is not positive definite
  explicit ColumnCholesky(const Eigen::SparseMatrix<double>& lower);
  /// The factor of another matrix, which has no entries but where this one has some: in the same
  /// order, with the same panels.
  /// lower, throws  as above
  ColumnCholesky of_matrix_alike(const Eigen::SparseMatrix<double>& lower) const;
  /// b        |n|x3
  /// returns  |n|x3
  Points3 solve(const Points3& b) const;

 private:
  struct Panel {
    int first, columns;
    int begin, end;      // in row_: the rows below these columns
    std::size_t values;  // in value_: row by row, of the columns themselves first
  };
  ColumnCholesky() = default;
  void make_panels(const std::vector<std::vector<int>>& rows_below);
  void factorise(const Eigen::SparseMatrix<double>& lower);

  std::vector<int> place_;  // of row i in the elimination order
  std::vector<Panel> panels_;
  std::vector<int> row_;
  std::vector<float> value_, inverse_diagonal_;
};

}  // namespace paperbake
