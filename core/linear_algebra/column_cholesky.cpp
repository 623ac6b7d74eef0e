#include "core/linear_algebra/column_cholesky.h"

#include "core/model/error.h"

#include <Eigen/OrderingMethods>

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Values = Eigen::Array4f;     // three columns and one that is idle: one register
constexpr int widest = 8;          // [columns] of a panel: their sums fit into the registers
constexpr double max_zeros = 0.3;  // [1] part of a panel that may be zero

/// The lower triangle of the matrix with its rows and columns at these places, sorted.
Sparse reordered(const Sparse& lower, const std::vector<int>& place) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(lower.nonZeros());
  for (int j = 0; j < lower.cols(); ++j)
    for (Sparse::InnerIterator it(lower, j); it; ++it) {
      const auto [first, second] = std::minmax(place[j], place[it.row()]);
      entries.emplace_back(second, first, it.value());
    }
  Sparse result(lower.rows(), lower.cols());
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

/// The order of elimination in which the factor stays sparse: the place of each row.
std::vector<int> sparse_order(const Sparse& lower) {
  const Sparse all = lower.selfadjointView<Eigen::Lower>();
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(all, order);
  std::vector<int> place(lower.rows());
  for (int k = 0; k < lower.rows(); ++k) place[order.indices()[k]] = k;
  return place;
}

/// Of each column of the factor, the next one that needs it; -1: none. source [Liu 1990]
std::vector<int> elimination_tree(const Sparse& lower) {
  const int n = static_cast<int>(lower.cols());
  std::vector<std::vector<int>> of_row(n);  // columns before the diagonal
  for (int j = 0; j < n; ++j)
    for (Sparse::InnerIterator it(lower, j); it; ++it)
      if (it.row() > j) of_row[it.row()].push_back(j);
  std::vector<int> parent(n, -1), ancestor(n, -1);
  for (int i = 0; i < n; ++i)
    for (int j : of_row[i])
      while (j != i) {
        const int next = ancestor[j];
        ancestor[j] = i;
        if (next < 0) parent[j] = i;
        if (next < 0 || next == i) break;
        j = next;
      }
  return parent;
}

/// The places of the columns in an order in which each comes right after those below it in the
/// elimination tree: the same factor, with columns that have the same rows side by side.
std::vector<int> postorder(const std::vector<int>& parent) {
  const int n = static_cast<int>(parent.size());
  std::vector<int> size(n, 1), start(n, 0), place(n);  // of the subtree that ends in each column
  for (int j = 0; j < n; ++j)
    if (const int p = parent[j]; p >= 0) size[p] += size[j];
  int roots = 0;
  std::vector<int> used(n, 0);  // by the children that were placed
  for (int j = n - 1; j >= 0; --j) {
    const int p = parent[j];
    int& taken = p >= 0 ? used[p] : roots;
    start[j] = (p >= 0 ? start[p] : 0) + taken;
    taken += size[j];
    place[j] = start[j] + size[j] - 1;
  }
  return place;
}

/// The rows of each column of the factor below the diagonal, sorted: those of the matrix, and those
/// of the columns whose parent it is.
std::vector<std::vector<int>> factor_rows(const Sparse& lower) {
  const int n = static_cast<int>(lower.cols());
  std::vector<std::vector<int>> rows(n), children(n);
  std::vector<int> seen(n, -1);
  for (int j = 0; j < n; ++j) {
    const auto add = [&](int row) {
      if (row <= j || seen[row] == j) return;
      seen[row] = j;
      rows[j].push_back(row);
    };
    for (Sparse::InnerIterator it(lower, j); it; ++it) add(static_cast<int>(it.row()));
    for (const int child : children[j])
      for (const int row : rows[child]) add(row);
    std::sort(rows[j].begin(), rows[j].end());
    if (!rows[j].empty()) children[rows[j].front()].push_back(j);
  }
  return rows;
}

// a row of a panel while the factor is computed
using Row = Eigen::Array<double, widest, 1>;
using Rows = std::vector<Row, Eigen::aligned_allocator<Row>>;

/// Subtracts from rows of a panel the products of the rows of an earlier one, of `width` columns,
/// with those of its rows that are columns of the panel.
/// at      the place in the panel of each row of the earlier one
/// across  of each column of the earlier one, its values in the columns of the panel
void subtract_products(const Row* earlier, int width, const std::vector<int>& at, const Row* across,
                       Row* panel) {
  for (std::size_t i = 0; i < at.size(); ++i) {
    Row sum = panel[at[i]];
    for (int k = 0; k < width; ++k) sum -= earlier[i].coeff(k) * across[k];
    panel[at[i]] = sum;
  }
}

/// Makes the factor of a panel from what the panels before it have left of its matrix.
/// returns  false if that is not positive definite
bool factorise_panel(Row* panel, int columns, int rows) {
  double inverse[widest];
  Row lower[widest];  // of each column, what is below the diagonal
  std::fill_n(lower, widest, Row::Zero());
  for (int i = 0; i < columns; ++i) {
    Row& row = panel[i];
    for (int k = 0; k < i; ++k) {
      row[k] *= inverse[k];
      for (int c = k + 1; c < i; ++c) row[c] -= row[k] * lower[k][c];
      row[i] -= row[k] * row[k];
      lower[k][i] = row[k];
    }
    if (!(row[i] > 0) || !std::isfinite(row[i])) return false;
    row[i] = std::sqrt(row[i]);
    inverse[i] = 1 / row[i];
    for (int c = i + 1; c < widest; ++c) row[c] = 0;
  }
  for (int i = columns; i < rows; ++i) {
    Row row = panel[i];
    for (int k = 0; k < columns; ++k) {
      row[k] *= inverse[k];
      row -= row[k] * lower[k];
    }
    panel[i] = row;
  }
  return true;
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
  place_ = sparse_order(lower);
  const std::vector<int> place = postorder(elimination_tree(reordered(lower, place_)));
  for (int& p : place_) p = place[p];
  const Sparse matrix = reordered(lower, place_);
  make_panels(factor_rows(matrix));
  factorise(matrix);
}

ColumnCholesky ColumnCholesky::of_matrix_alike(const Eigen::SparseMatrix<double>& lower) const {
  ColumnCholesky other;
  other.place_ = place_;
  other.panels_ = panels_;
  other.row_ = row_;
  other.value_.resize(value_.size());
  other.inverse_diagonal_.resize(inverse_diagonal_.size());
  other.factorise(reordered(lower, place_));
  return other;
}

/// rows_below  the rows of each column of the factor below the diagonal
void ColumnCholesky::make_panels(const std::vector<std::vector<int>>& rows_below) {
  const int n = static_cast<int>(rows_below.size());
  std::size_t values = 0;
  for (int first = 0; first < n;) {
    int last = first;
    double zeros = 0;
    while (last - first + 1 < widest && !rows_below[last].empty() &&
           rows_below[last].front() == last + 1) {
      const int columns = last - first + 1;
      const double below = static_cast<double>(rows_below[last + 1].size()),
                   more = zeros + columns * (below + 1 - double(rows_below[last].size()));
      if (more > max_zeros * (columns + 1) * (below + 0.5 * (columns + 1))) break;
      zeros = more;
      ++last;
    }
    // the rows of the last column are those of all, below the panel
    const int columns = last - first + 1, begin = static_cast<int>(row_.size());
    row_.insert(row_.end(), rows_below[last].begin(), rows_below[last].end());
    const int end = static_cast<int>(row_.size());
    panels_.push_back({first, columns, begin, end, values});
    values += std::size_t(columns) * (columns + end - begin);
    first = last + 1;
  }
  value_.resize(values);
  inverse_diagonal_.resize(n);
}

void ColumnCholesky::factorise(const Eigen::SparseMatrix<double>& lower) {
  const int n = static_cast<int>(lower.cols()), count = static_cast<int>(panels_.size());
  std::vector<int> owner(n), position(n), at;  // panel of a column; place of a row in a panel
  std::vector<std::size_t> start(count + 1, 0);
  for (int p = 0; p < count; ++p) {
    std::fill_n(owner.begin() + panels_[p].first, panels_[p].columns, p);
    start[p + 1] = start[p] + panels_[p].columns + panels_[p].end - panels_[p].begin;
  }
  Rows factor(start.back(), Row::Zero());
  // earlier panels whose next rows belong to each one, as linked lists; their first row not done
  std::vector<int> head(count, -1), next(count, -1), done(count);
  const auto wait = [&](int p) {
    if (done[p] == panels_[p].end) return;
    const int by = owner[row_[done[p]]];
    next[p] = head[by];
    head[by] = p;
  };
  for (int p = 0; p < count; ++p) {
    const Panel& panel = panels_[p];
    Row* rows = factor.data() + start[p];
    for (int k = 0; k < panel.columns; ++k) position[panel.first + k] = k;
    for (int i = panel.begin; i < panel.end; ++i)
      position[row_[i]] = panel.columns + i - panel.begin;
    for (int k = 0; k < panel.columns; ++k)
      for (Sparse::InnerIterator it(lower, panel.first + k); it; ++it)
        rows[position[it.row()]][k] = it.value();
    for (int q = head[p], after; q >= 0; q = after) {
      after = next[q];
      const Panel& earlier = panels_[q];
      const Row* from = factor.data() + start[q] + earlier.columns + (done[q] - earlier.begin);
      at.clear();
      for (int i = done[q]; i < earlier.end; ++i) at.push_back(position[row_[i]]);
      Row across[widest];
      std::fill_n(across, widest, Row::Zero());
      for (std::size_t i = 0; i < at.size() && at[i] < panel.columns; ++i, ++done[q])
        for (int k = 0; k < earlier.columns; ++k) across[k][at[i]] = from[i][k];
      subtract_products(from, earlier.columns, at, across, rows);
      wait(q);
    }
    if (!factorise_panel(rows, panel.columns, static_cast<int>(start[p + 1] - start[p])))
      throw Error(ErrorCode::simulation, "render mesh", "Its matrix is not positive definite.");
    done[p] = panel.begin;
    wait(p);
    for (int k = 0; k < panel.columns; ++k)
      inverse_diagonal_[panel.first + k] = static_cast<float>(1 / rows[k][k]);
    float* value = value_.data() + panel.values;
    for (std::size_t i = 0; i < start[p + 1] - start[p]; ++i)
      for (int k = 0; k < panel.columns; ++k) *value++ = static_cast<float>(rows[i][k]);
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
