#pragma once

#include "core/linear_algebra/supernodal_factor.h"

#include <Eigen/Core>

#include <utility>
#include <vector>

namespace paperbake {

/// A symmetric sparse matrix of 3x3 blocks and its Cholesky factor. The fill-reducing order and the
/// supernodes are found once, on the graph of the blocks, and are kept for the life of the object.
class BlockCholesky {
 public:
  /// Where a block is stored. A block above the diagonal is stored transposed, in the place of its
  /// mirror image.
  struct Slot {
    int offset = -1;  // of the first value; -1: nowhere, add() ignores it
    int stride = 0;   // between columns; negative: transposed
  };

  /// blocks   number of block rows
  /// coupled  pairs (i, j) of block rows whose block may be non-zero, in any order; pairs may be
  ///          repeated
  BlockCholesky(int blocks, std::vector<std::pair<int, int>> coupled);

  /// The place of block (i, j); {-1, 0} if i or j is negative or the two are not coupled. Takes
  /// O(log) time: ask once and keep the answer.
  Slot slot(int i, int j) const;

  void set_zero();
  /// values += block, a 3x3 expression. For a block on the diagonal the whole symmetric block is
  /// given.
  template <class Block>
  void add(Slot slot, const Block& block);
  void shift_diagonal(double value);

  /// returns  false if the matrix is not positive definite
  bool factorise();

  /// Solves with the last factor. b: 3 x blocks values, block by block. returns the same shape
  const Eigen::VectorXd& solve(const Eigen::VectorXd& b);

  /// The whole matrix, block by block as in solve(): for tests and small studies.
  Eigen::MatrixXd dense() const;

 private:
  struct Sorted {};
  BlockCholesky(int blocks, std::vector<std::pair<int, int>> coupled, Sorted);
  int place(int i) const { return factor_.place()[i]; }

  SupernodalFactor factor_;
  std::vector<int> column_start_;  // of block columns: where they start in rows_
  std::vector<int> rows_;          // block rows, sorted within a column, row >= column
  std::vector<double> values_;
  Eigen::VectorXd in_order_, solution_;
};

template <class Block>
void BlockCholesky::add(Slot slot, const Block& block) {
  if (slot.offset < 0) return;
  double* v = values_.data() + slot.offset;
  if (slot.stride > 0) {
    for (int c = 0; c < 3; ++c, v += slot.stride)
      for (int r = 0; r < 3; ++r) v[r] += block(r, c);
  } else {
    for (int c = 0; c < 3; ++c, v -= slot.stride)
      for (int r = 0; r < 3; ++r) v[r] += block(c, r);
  }
}

}  // namespace paperbake
