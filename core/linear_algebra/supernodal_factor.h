#pragma once

#include <Eigen/Core>

#include <utility>
#include <vector>

namespace paperbake {

/// The Cholesky factor L of a symmetric sparse matrix of 3x3 blocks, stored by supernodes: runs of
/// neighbouring columns whose rows are the same, as dense panels.
///
/// The dense products are written out here and compiled with the rest, instead of being asked of a
/// BLAS: a BLAS chooses its kernels by the processor that it runs on, each with sums in another
/// order, and a fold that may go either way then goes another way on another machine. They are also
/// faster than OpenBLAS for the small panels of a simulated sheet.
///
/// source  left-looking supernodal factorisation [Ng 1993]; CHOLMOD finds the order of elimination
///         and the supernodes
class SupernodalFactor {
 public:
  /// blocks   number of block rows
  /// coupled  pairs of block rows (i < j, sorted, each once) whose block may be non-zero
  /// throws   Error(ErrorCode::simulation) when memory does not suffice
  SupernodalFactor(int blocks, const std::vector<std::pair<int, int>>& coupled);

  /// The place of each block row in the order of elimination.
  const std::vector<int>& place() const { return place_; }

  /// The matrix in the order of elimination, lower triangle, by block columns: the rows of block
  /// column j are row[start[j]] (= j) ... row[start[j + 1] - 1], and its values are three columns
  /// of 3 (start[j + 1] - start[j]) values, one after the other, from value[9 start[j]] on.
  struct Matrix {
    const std::vector<int>& start;
    const std::vector<int>& row;
    const std::vector<double>& value;
  };
  /// returns  false if the matrix is not positive definite
  bool factorise(const Matrix&);

  /// Replaces the right-hand side, in the order of elimination, by the solution.
  void solve(Eigen::VectorXd& x) const;

 private:
  struct Supernode {
    int first, columns;  // block columns
    int begin, rows;     // in rows_; the first `columns` of them are those of the columns
    int stride;          // of the panel: its rows, and some that stay zero
    std::size_t panel;   // in values_
  };
  void find_supernodes(const int* first_columns, const int* row_starts, const int* rows, int count);
  void assemble(const Supernode&, const Matrix&);
  int subtract(const Supernode& from, const Supernode& of, int done);
  bool factorise_panel(const Supernode&);

  std::vector<int> place_;
  std::vector<Supernode> supernodes_;
  std::vector<int> owner_;  // supernode of each block column
  std::vector<int> rows_;   // block rows of all supernodes
  std::vector<double> values_;
  std::vector<double> inverse_diagonal_;
  std::vector<int> position_;    // of a block row in the panel that is being made
  std::vector<double> product_;  // of two parts of a panel
};

}  // namespace paperbake
