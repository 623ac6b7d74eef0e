#include "core/linear_algebra/supernodal_factor.h"

#include "core/model/error.h"

#include <algorithm>
#include <cholmod.h>
#include <cmath>
#include <cstring>
#include <memory>

namespace paperbake {
namespace {

// four values in one register, or in two where registers are narrower
using Four = double __attribute__((vector_size(32)));
using FourInMemory = double __attribute__((vector_size(32), aligned(8), may_alias));
constexpr int lanes = 4;
constexpr int tall = 3;  // [registers] height of a tile: 9 sums, 3 factors and one more fit into 16

Four load(const double* p) { return *reinterpret_cast<const FourInMemory*>(p); }
void store(double* p, Four v) { *reinterpret_cast<FourInMemory*>(p) = v; }

/// A panel, or a part of one: columns of values with this distance.
struct Panel {
  const double* at;
  std::ptrdiff_t stride;
};

/// c = +-(c0 + a b^T) for `height` x 4 rows of a and 3 rows of b; both have `inner` columns.
enum class Sum { fresh, subtracted };
template <int height, Sum sum>
void multiply_tile(Panel a, Panel b, int inner, double* c, std::ptrdiff_t stride) {
  Four total[3][height] = {};
  for (int k = 0; k < inner; ++k) {
    const double *x = a.at + k * a.stride, *y = b.at + k * b.stride;
    for (int r = 0; r < height; ++r) {
      const Four rows = load(x + lanes * r);
      for (int j = 0; j < 3; ++j) total[j][r] += rows * y[j];
    }
  }
  for (int j = 0; j < 3; ++j)
    for (int r = 0; r < height; ++r) {
      double* to = c + j * stride + lanes * r;
      store(to, sum == Sum::fresh ? total[j][r] : load(to) - total[j][r]);
    }
}

/// The same for any number of rows of a. Rows up to the next multiple of 4 are computed too.
template <Sum sum>
void multiply_strip(Panel a, int rows, Panel b, int inner, double* c, std::ptrdiff_t stride) {
  int i = 0;
  const auto part = [&] { return Panel{a.at + i, a.stride}; };
  for (; rows - i > lanes * (tall - 1); i += lanes * tall)
    multiply_tile<tall, sum>(part(), b, inner, c + i, stride);
  if (rows - i > lanes)
    multiply_tile<2, sum>(part(), b, inner, c + i, stride);
  else if (rows - i > 0)
    multiply_tile<1, sum>(part(), b, inner, c + i, stride);
}

/// Rows of zeros after those of a panel, so that whole registers may be read and written.
int padded(int rows) { return (rows + 2 * lanes - 1) / lanes * lanes; }

struct FinishCommon {
  void operator()(cholmod_common* c) const { cholmod_finish(c); }
};

struct FreeFactor {
  cholmod_common* common;
  void operator()(cholmod_factor* factor) const { cholmod_free_factor(&factor, common); }
};

cholmod_factor* analyse(int blocks, const std::vector<std::pair<int, int>>& pairs,
                        cholmod_common* c) {
  cholmod_triplet* t =
      cholmod_allocate_triplet(blocks, blocks, pairs.size(), 1, CHOLMOD_PATTERN, c);
  if (!t) return nullptr;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    static_cast<int*>(t->i)[k] = pairs[k].first;
    static_cast<int*>(t->j)[k] = pairs[k].second;
  }
  t->nnz = pairs.size();
  cholmod_sparse* graph = cholmod_triplet_to_sparse(t, pairs.size(), c);
  cholmod_free_triplet(&t, c);
  c->nmethods = 1;
  c->method[0].ordering = CHOLMOD_AMD;
  c->postorder = 1;
  c->supernodal = CHOLMOD_SUPERNODAL;
  // [block columns] how far supernodes are joined although zeros come into them: a third of
  // CHOLMOD's numbers, which count columns
  c->nrelax[0] = 2;
  c->nrelax[1] = 5;
  c->nrelax[2] = 16;
  cholmod_factor* symbolic = graph ? cholmod_analyze(graph, c) : nullptr;
  cholmod_free_sparse(&graph, c);
  return symbolic;
}

}  // namespace

SupernodalFactor::SupernodalFactor(int blocks, const std::vector<std::pair<int, int>>& coupled)
    : place_(blocks), owner_(blocks), inverse_diagonal_(3 * blocks), position_(blocks) {
  cholmod_common common;
  cholmod_start(&common);
  const std::unique_ptr<cholmod_common, FinishCommon> finish(&common);
  common.print = 0;
  const std::unique_ptr<cholmod_factor, FreeFactor> symbolic(analyse(blocks, coupled, &common),
                                                             {&common});
  if (!symbolic)
    throw Error(ErrorCode::simulation, "elastic step",
                "The matrix could not be laid out: out of memory.", "Use fewer triangles.");
  const int* order = static_cast<const int*>(symbolic->Perm);
  for (int k = 0; k < blocks; ++k) place_[order[k]] = k;
  find_supernodes(static_cast<const int*>(symbolic->super), static_cast<const int*>(symbolic->pi),
                  static_cast<const int*>(symbolic->s), static_cast<int>(symbolic->nsuper));
}

void SupernodalFactor::find_supernodes(const int* first_columns, const int* row_starts,
                                       const int* rows, int count) {
  rows_.assign(rows, rows + row_starts[count]);
  std::size_t values = 0, product = 0;
  for (int k = 0; k < count; ++k) {
    Supernode node{first_columns[k],
                   first_columns[k + 1] - first_columns[k],
                   row_starts[k],
                   row_starts[k + 1] - row_starts[k],
                   0,
                   values};
    node.stride = padded(3 * node.rows);
    values += std::size_t(node.stride) * 3 * node.columns;
    product = std::max(product, std::size_t(node.stride) * 3 * (node.rows - node.columns));
    for (int j = 0; j < node.columns; ++j) owner_[node.first + j] = k;
    supernodes_.push_back(node);
  }
  values_.resize(values + lanes * tall);
  product_.resize(product + lanes * tall);
}

/// Writes the columns of the matrix into the panel.
void SupernodalFactor::assemble(const Supernode& node, const Matrix& matrix) {
  double* panel = values_.data() + node.panel;
  std::memset(panel, 0, sizeof(double) * node.stride * 3 * node.columns);
  for (int j = 0; j < node.columns; ++j) {
    const int begin = matrix.start[node.first + j], end = matrix.start[node.first + j + 1];
    for (int c = 0; c < 3; ++c) {
      const double* from = matrix.value.data() + 9 * std::size_t(begin) + 3 * c * (end - begin);
      double* to = panel + std::ptrdiff_t(node.stride) * (3 * j + c);
      for (int b = begin; b < end; ++b, from += 3)
        std::memcpy(to + 3 * position_[matrix.row[b]], from, 3 * sizeof(double));
    }
  }
}

/// Subtracts from a panel what the columns of an earlier one contribute to it.
/// done     rows of `of` that belong to panels before this one
/// returns  rows of `of` that belong to panels up to this one
int SupernodalFactor::subtract(const Supernode& from, const Supernode& of, int done) {
  const int* rows = rows_.data() + of.begin;
  int last = done;
  while (last < of.rows && rows[last] < from.first + from.columns) ++last;
  const int height = of.rows - done, width = last - done, stride = padded(3 * height);
  const double* top = values_.data() + of.panel + 3 * done;
  for (int j = 0; j < width; ++j)  // the part above the diagonal is not needed
    multiply_strip<Sum::fresh>({top + 3 * j, of.stride}, 3 * (height - j), {top + 3 * j, of.stride},
                               3 * of.columns,
                               product_.data() + 3 * j * (stride + std::ptrdiff_t(1)), stride);
  for (int j = 0; j < width; ++j)
    for (int c = 0; c < 3; ++c) {
      const double* product = product_.data() + std::ptrdiff_t(stride) * (3 * j + c);
      double* to = values_.data() + from.panel +
                   std::ptrdiff_t(from.stride) * (3 * position_[rows[done + j]] + c);
      for (int i = j; i < height; ++i) {
        double* at = to + 3 * position_[rows[done + i]];
        for (int r = 0; r < 3; ++r) at[r] -= product[3 * i + r];
      }
    }
  return last;
}

/// Three columns after the other: less what those before contribute, then the 3x3 block on the
/// diagonal, then the rows below it.
bool SupernodalFactor::factorise_panel(const Supernode& node) {
  double* panel = values_.data() + node.panel;
  const std::ptrdiff_t stride = node.stride;
  for (int j = 0; j < 3 * node.columns; j += 3) {
    double *a = panel + j * stride, *b = a + stride, *c = b + stride;
    multiply_strip<Sum::subtracted>({panel + j, stride}, 3 * node.rows - j, {panel + j, stride}, j,
                                    a + j, stride);
    double* inverse = inverse_diagonal_.data() + 3 * node.first + j;
    const auto pivot = [&](double square, double& root, double& inverse_of_root) {
      if (!(square > 0) || !std::isfinite(square)) return false;
      root = std::sqrt(square);
      inverse_of_root = 1 / root;
      return true;
    };
    double root;
    if (!pivot(a[j], root, inverse[0])) return false;
    const double ba = a[j + 1] * inverse[0], ca = a[j + 2] * inverse[0];
    if (!pivot(b[j + 1] - ba * ba, root, inverse[1])) return false;
    const double cb = (b[j + 2] - ca * ba) * inverse[1];
    if (!pivot(c[j + 2] - ca * ca - cb * cb, root, inverse[2])) return false;
    for (int i = j; i < node.stride; i += lanes) {
      const Four x = load(a + i) * inverse[0], y = (load(b + i) - x * ba) * inverse[1],
                 z = (load(c + i) - x * ca - y * cb) * inverse[2];
      store(a + i, x);
      store(b + i, y);
      store(c + i, z);
    }
  }
  return true;
}

bool SupernodalFactor::factorise(const Matrix& matrix) {
  const int count = static_cast<int>(supernodes_.size());
  // supernodes whose next rows belong to each one, as linked lists; rows of each that are done
  std::vector<int> head(count, -1), next(count, -1), done(count, 0);
  const auto wait = [&](int k) {
    if (done[k] == supernodes_[k].rows) return;
    const int owner = owner_[rows_[supernodes_[k].begin + done[k]]];
    next[k] = head[owner];
    head[owner] = k;
  };
  for (int k = 0; k < count; ++k) {
    const Supernode& node = supernodes_[k];
    for (int i = 0; i < node.rows; ++i) position_[rows_[node.begin + i]] = i;
    assemble(node, matrix);
    for (int of = head[k], after; of >= 0; of = after) {
      after = next[of];
      done[of] = subtract(node, supernodes_[of], done[of]);
      wait(of);
    }
    if (!factorise_panel(node)) return false;
    done[k] = node.columns;
    wait(k);
  }
  return true;
}

void SupernodalFactor::solve(Eigen::VectorXd& x) const {
  std::vector<double> below;
  const auto column = [&](const Supernode& node, int j) {
    return values_.data() + node.panel + std::ptrdiff_t(node.stride) * j;
  };
  for (const Supernode& node : supernodes_) {
    const int width = 3 * node.columns, height = 3 * node.rows;
    double* own = x.data() + 3 * node.first;
    below.assign(height, 0.0);
    for (int j = 0; j < width; ++j) {
      const double* values = column(node, j);
      const double known = own[j] *= inverse_diagonal_[3 * node.first + j];
      for (int i = j + 1; i < width; ++i) own[i] -= values[i] * known;
      for (int i = width; i < height; ++i) below[i] += values[i] * known;
    }
    for (int i = node.columns; i < node.rows; ++i)
      for (int r = 0; r < 3; ++r) x[3 * rows_[node.begin + i] + r] -= below[3 * i + r];
  }
  for (std::size_t k = supernodes_.size(); k-- > 0;) {
    const Supernode& node = supernodes_[k];
    const int width = 3 * node.columns;
    below.assign(node.stride, 0.0);  // all rows of the panel
    for (int i = 0; i < node.rows; ++i)
      for (int r = 0; r < 3; ++r) below[3 * i + r] = x[3 * rows_[node.begin + i] + r];
    for (int j = width - 1; j >= 0; --j) {
      const double* values = column(node, j);
      // what lies above the diagonal is multiplied by zeros
      Four sum = {};
      const double own = below[j];
      below[j] = 0;
      for (int i = j / lanes * lanes; i < node.stride; i += lanes) {
        Four factor = load(below.data() + i);
        for (int lane = 0; i < j && lane < j - i && lane < lanes; ++lane) factor[lane] = 0;
        sum += load(values + i) * factor;
      }
      below[j] =
          (own - ((sum[0] + sum[1]) + (sum[2] + sum[3]))) * inverse_diagonal_[3 * node.first + j];
      x[3 * node.first + j] = below[j];
    }
  }
}

}  // namespace paperbake
