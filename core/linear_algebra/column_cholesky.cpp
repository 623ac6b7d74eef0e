#include "core/linear_algebra/column_cholesky.h"

#include "core/model/error.h"

#include <Eigen/SparseCholesky>

#include <optional>

namespace paperbake {
namespace {

using Factor = Eigen::SparseMatrix<double>;
using Values = Eigen::Array4f;     // three columns and one that is idle: one register
constexpr int widest = 8;          // [columns] of a panel: their sums fit into the registers
constexpr double max_zeros = 0.3;  // [1] part of a panel that may be zero

int rows_below(const Factor& factor, int column) {
  return factor.outerIndexPtr()[column + 1] - factor.outerIndexPtr()[column] - 1;
}
/// The column whose elimination needs this one first; -1: none.
int parent(const Factor& factor, int column) {
  return rows_below(factor, column) > 0 ? factor.innerIndexPtr()[factor.outerIndexPtr()[column] + 1]
                                        : -1;
}

/// The places of the columns in an order in which each comes right after those below it in the
/// elimination tree: the same factor, with columns that have the same rows side by side.
std::vector<int> postorder(const Factor& factor) {
  const int n = static_cast<int>(factor.cols());
  std::vector<int> size(n, 1), start(n, 0), place(n);  // of the subtree that ends in each column
  for (int j = 0; j < n; ++j)
    if (const int p = parent(factor, j); p >= 0) size[p] += size[j];
  int roots = 0;
  std::vector<int> used(n, 0);  // by the children that were placed
  for (int j = n - 1; j >= 0; --j) {
    const int p = parent(factor, j);
    int& taken = p >= 0 ? used[p] : roots;
    start[j] = (p >= 0 ? start[p] : 0) + taken;
    taken += size[j];
    place[j] = start[j] + size[j] - 1;
  }
  return place;
}

/// The factor with its columns at these places. The rows of a column are its ancestors in the
/// elimination tree, whose order a postorder keeps: they stay sorted.
Factor reordered(const Factor& factor, const std::vector<int>& place) {
  const int n = static_cast<int>(factor.cols());
  std::vector<int> column(n);  // at each place
  for (int j = 0; j < n; ++j) column[place[j]] = j;
  Factor result(n, n);
  result.reserve(factor.nonZeros());
  for (int k = 0; k < n; ++k) {
    result.startVec(k);
    for (Factor::InnerIterator it(factor, column[k]); it; ++it)
      result.insertBackByOuterInner(k, place[it.row()]) = it.value();
  }
  result.finalize();
  return result;
}

/// What is known of the columns of a panel leaves the rows below them.
template <int columns>
void substitute(const float* value, const int* row, int rows, const Values* known, Values* x) {
  Values of_column[columns];
  for (int k = 0; k < columns; ++k) of_column[k] = known[k];
  for (int i = 0; i < rows; ++i, value += columns) {
    Values sum = x[row[i]];
    for (int k = 0; k < columns; ++k) sum -= value[k] * of_column[k];
    x[row[i]] = sum;
  }
}
/// The rows below a panel leave its columns.
template <int columns>
void gather(const float* value, const int* row, int rows, const Values* x, Values* own) {
  Values sum[columns];
  for (int k = 0; k < columns; ++k) sum[k] = own[k];
  for (int i = 0; i < rows; ++i, value += columns) {
    const Values known = x[row[i]];
    for (int k = 0; k < columns; ++k) sum[k] -= value[k] * known;
  }
  for (int k = 0; k < columns; ++k) own[k] = sum[k];
}

using Substitute = void (*)(const float*, const int*, int, const Values*, Values*);
constexpr Substitute substitute_of[widest] = {substitute<1>, substitute<2>, substitute<3>,
                                              substitute<4>, substitute<5>, substitute<6>,
                                              substitute<7>, substitute<8>};
using Gather = void (*)(const float*, const int*, int, const Values*, Values*);
constexpr Gather gather_of[widest] = {gather<1>, gather<2>, gather<3>, gather<4>,
                                      gather<5>, gather<6>, gather<7>, gather<8>};

}  // namespace

ColumnCholesky::ColumnCholesky(const Eigen::SparseMatrix<double>& lower) {
  std::optional<Eigen::SimplicialLLT<Eigen::SparseMatrix<double>>> solver(lower);
  if (solver->info() != Eigen::Success)
    throw Error(ErrorCode::simulation, "render mesh", "Its matrix is not positive definite.");
  const int n = static_cast<int>(lower.rows());
  const Factor& unordered = solver->matrixL().nestedExpression();
  const std::vector<int> place = postorder(unordered);
  place_.resize(n);
  for (int i = 0; i < n; ++i) place_[i] = place[solver->permutationP().indices()[i]];
  const Factor factor = reordered(unordered, place);
  solver.reset();  // it holds the factor, too
  make_panels(factor);
}

void ColumnCholesky::make_panels(const Factor& factor) {
  const int n = static_cast<int>(factor.cols());
  for (int j = 0; j < n; ++j)
    inverse_diagonal_.push_back(static_cast<float>(1 / factor.coeff(j, j)));
  for (int first = 0; first < n;) {
    int columns = 1;
    double zeros = 0;
    while (columns < widest && parent(factor, first + columns - 1) == first + columns) {
      const int below = rows_below(factor, first + columns);
      const double more =
          zeros + columns * double(below + 1 - rows_below(factor, first + columns - 1));
      if (more > max_zeros * (columns + 1) * (below + 0.5 * (columns + 1))) break;
      zeros = more;
      ++columns;
    }
    add_panel(factor, first, columns);
    first += columns;
  }
}

/// The rows of the last column are those of all, below the panel.
void ColumnCholesky::add_panel(const Factor& factor, int first, int columns) {
  const int begin = static_cast<int>(row_.size());
  for (Factor::InnerIterator it(factor, first + columns - 1); it; ++it)
    if (it.row() >= first + columns) row_.push_back(static_cast<int>(it.row()));
  const int end = static_cast<int>(row_.size());
  const std::size_t values = value_.size();
  panels_.push_back({first, columns, begin, end, values});
  value_.resize(values + std::size_t(columns) * (columns + end - begin), 0.0f);
  for (int k = 0; k < columns; ++k) {
    int at = begin;
    for (Factor::InnerIterator it(factor, first + k); it; ++it) {
      const int row = static_cast<int>(it.row());
      if (row >= first + columns)
        while (row_[at] < row) ++at;
      const int place = row < first + columns ? row - first : columns + at - begin;
      value_[values + std::size_t(columns) * place + k] = static_cast<float>(it.value());
    }
  }
}

Points3 ColumnCholesky::solve(const Points3& b) const {
  const int n = static_cast<int>(place_.size());
  std::vector<Values, Eigen::aligned_allocator<Values>> x(n);
  for (int i = 0; i < n; ++i) x[place_[i]] << b.row(i).transpose().cast<float>().array(), 0.0f;
  for (const Panel& panel : panels_) {
    const float* value = value_.data() + panel.values;
    Values* own = x.data() + panel.first;
    for (int k = 0; k < panel.columns; ++k, value += panel.columns) {
      for (int j = 0; j < k; ++j) own[k] -= value[j] * own[j];
      own[k] *= inverse_diagonal_[panel.first + k];
    }
    substitute_of[panel.columns - 1](value, row_.data() + panel.begin, panel.end - panel.begin, own,
                                     x.data());
  }
  for (std::size_t p = panels_.size(); p-- > 0;) {
    const Panel& panel = panels_[p];
    const float* value = value_.data() + panel.values;
    Values* own = x.data() + panel.first;
    gather_of[panel.columns - 1](value + panel.columns * panel.columns, row_.data() + panel.begin,
                                 panel.end - panel.begin, x.data(), own);
    for (int k = panel.columns - 1; k >= 0; --k) {
      for (int i = k + 1; i < panel.columns; ++i) own[k] -= value[panel.columns * i + k] * own[i];
      own[k] *= inverse_diagonal_[panel.first + k];
    }
  }
  Points3 solution(n, 3);
  for (int i = 0; i < n; ++i)
    solution.row(i) = x[place_[i]].head<3>().cast<double>().matrix().transpose();
  return solution;
}

}  // namespace paperbake
