#include "core/linear_algebra/block_cholesky.h"

#include <algorithm>
#include <cstdlib>

namespace paperbake {
namespace {

/// All pairs (i, j) with i <= j, those on the diagonal too, sorted, each once.
std::vector<std::pair<int, int>> upper_pairs(int blocks, std::vector<std::pair<int, int>> coupled) {
  for (int i = 0; i < blocks; ++i) coupled.emplace_back(i, i);
  for (auto& [i, j] : coupled)
    if (i > j) std::swap(i, j);
  std::sort(coupled.begin(), coupled.end());
  coupled.erase(std::unique(coupled.begin(), coupled.end()), coupled.end());
  return coupled;
}

}  // namespace

BlockCholesky::BlockCholesky(int blocks, std::vector<std::pair<int, int>> coupled)
    : BlockCholesky(blocks, upper_pairs(blocks, std::move(coupled)), Sorted()) {}

BlockCholesky::BlockCholesky(int blocks, std::vector<std::pair<int, int>> coupled, Sorted)
    : factor_(blocks, coupled), in_order_(3 * blocks), solution_(3 * blocks) {
  // the same pairs in elimination order, by columns
  for (auto& [i, j] : coupled) {
    const int p = place(i), q = place(j);
    i = std::min(p, q);  // column first
    j = std::max(p, q);
  }
  std::sort(coupled.begin(), coupled.end());
  column_start_.assign(blocks + 1, 0);
  for (const auto& [column, row] : coupled) {
    ++column_start_[column + 1];
    rows_.push_back(row);
  }
  for (int j = 0; j < blocks; ++j) column_start_[j + 1] += column_start_[j];
  values_.assign(9 * rows_.size(), 0.0);
}

BlockCholesky::Slot BlockCholesky::slot(int i, int j) const {
  if (i < 0 || j < 0) return {};
  const int p = place(i), q = place(j);
  const int column = std::min(p, q), row = std::max(p, q);
  const auto first = rows_.begin() + column_start_[column],
             last = rows_.begin() + column_start_[column + 1];
  const int height = 3 * static_cast<int>(last - first);
  const auto found = std::lower_bound(first, last, row);
  if (found == last || *found != row) return {};
  const int index = static_cast<int>(found - first);
  return {9 * column_start_[column] + 3 * index, p >= q ? height : -height};
}

void BlockCholesky::set_zero() { std::fill(values_.begin(), values_.end(), 0.0); }

void BlockCholesky::shift_diagonal(double value) {
  const int blocks = static_cast<int>(factor_.place().size());
  for (int j = 0; j < blocks; ++j) {
    const int height = 3 * (column_start_[j + 1] - column_start_[j]);
    // the diagonal block is the first of its column
    double* block = values_.data() + 9 * std::size_t(column_start_[j]);
    for (int c = 0; c < 3; ++c) block[c * height + c] += value;
  }
}

bool BlockCholesky::factorise() { return factor_.factorise({column_start_, rows_, values_}); }

const Eigen::VectorXd& BlockCholesky::solve(const Eigen::VectorXd& b) {
  const int blocks = static_cast<int>(factor_.place().size());
  for (int i = 0; i < blocks; ++i) in_order_.segment<3>(3 * place(i)) = b.segment<3>(3 * i);
  factor_.solve(in_order_);
  for (int i = 0; i < blocks; ++i) solution_.segment<3>(3 * i) = in_order_.segment<3>(3 * place(i));
  return solution_;
}

Eigen::MatrixXd BlockCholesky::dense() const {
  const int blocks = static_cast<int>(factor_.place().size());
  Eigen::MatrixXd m(3 * blocks, 3 * blocks);
  m.setZero();
  for (int i = 0; i < blocks; ++i)
    for (int j = i; j < blocks; ++j) {
      const Slot at = slot(i, j);
      if (at.offset < 0) continue;
      Eigen::Matrix3d block;
      for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r)
          (at.stride > 0 ? block(r, c) : block(c, r)) =
              values_[at.offset + c * std::abs(at.stride) + r];
      m.block<3, 3>(3 * i, 3 * j) = block;
      m.block<3, 3>(3 * j, 3 * i) = block.transpose();
    }
  return m;
}

}  // namespace paperbake
