#include "core/linear_algebra/block_cholesky.h"

#include "core/model/error.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <mutex>

namespace paperbake {
namespace {

/// Keeps the linear algebra on the caller's thread: sums must not depend on the number of threads,
/// and in loops as small as these threads only wait for each other. This concerns OpenBLAS, where
/// it is the BLAS behind CHOLMOD, and the OpenMP loops in the supernodal part of CHOLMOD. OpenMP
/// keeps the setting per thread, so this is to be called wherever a factor is made.
void stay_on_this_thread() {
  thread_local bool stays = false;
  if (stays) return;
  stays = true;
  using Setter = void (*)(int);
  if (auto set = reinterpret_cast<Setter>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"))) set(1);
  if (auto set = reinterpret_cast<Setter>(dlsym(RTLD_DEFAULT, "omp_set_max_active_levels"))) set(0);
}

/// A single-threaded build of OpenBLAS does not lock its buffers, and factorisations that run side
/// by side corrupt each other: with such a build they take turns.
std::unique_lock<std::mutex> turn_at_blas() {
  static std::mutex mutex;
  static const bool one_at_a_time = [] {
    using Getter = int (*)();
    const auto threads = reinterpret_cast<Getter>(dlsym(RTLD_DEFAULT, "openblas_get_parallel"));
    return threads && threads() == 0;
  }();
  return one_at_a_time ? std::unique_lock(mutex) : std::unique_lock<std::mutex>();
}

cholmod_common* start_cholmod() {
  auto* c = new cholmod_common;
  cholmod_start(c);
  c->print = 0;
  c->error_handler = nullptr;
  c->final_ll = 1;
  c->quick_return_if_not_posdef = 1;
  return c;
}

/// Minimum-degree order of the block graph: the place of each block row.
std::vector<int> elimination_order(int blocks, const std::vector<std::pair<int, int>>& pairs,
                                   cholmod_common* c) {
  cholmod_triplet* t =
      cholmod_allocate_triplet(blocks, blocks, pairs.size(), 1, CHOLMOD_PATTERN, c);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    static_cast<int*>(t->i)[k] = pairs[k].first;
    static_cast<int*>(t->j)[k] = pairs[k].second;
  }
  t->nnz = pairs.size();
  cholmod_sparse* graph = cholmod_triplet_to_sparse(t, pairs.size(), c);
  cholmod_free_triplet(&t, c);
  std::vector<int> order(blocks), place(blocks);
  c->nmethods = 1;
  c->method[0].ordering = CHOLMOD_AMD;
  c->postorder = 1;
  cholmod_factor* symbolic = cholmod_analyze(graph, c);
  if (!symbolic)
    throw Error(ErrorCode::simulation, "elastic step",
                "The matrix order could not be found: out of memory.");
  std::copy_n(static_cast<int*>(symbolic->Perm), blocks, order.begin());
  cholmod_free_factor(&symbolic, c);
  cholmod_free_sparse(&graph, c);
  for (int k = 0; k < blocks; ++k) place[order[k]] = k;
  return place;
}

}  // namespace

BlockCholesky::BlockCholesky(int blocks, std::vector<std::pair<int, int>> coupled)
    : common_(start_cholmod()),
      matrix_(nullptr, Free{common_.get()}),
      factor_(nullptr, Free{common_.get()}),
      rhs_(nullptr, Free{common_.get()}),
      x_(nullptr, Free{common_.get()}),
      y_(nullptr, Free{common_.get()}),
      e_(nullptr, Free{common_.get()}),
      solution_(3 * blocks) {
  cholmod_common* c = common_.get();
  for (int i = 0; i < blocks; ++i) coupled.emplace_back(i, i);
  for (auto& [i, j] : coupled)
    if (i > j) std::swap(i, j);
  std::sort(coupled.begin(), coupled.end());
  coupled.erase(std::unique(coupled.begin(), coupled.end()), coupled.end());
  place_ = elimination_order(blocks, coupled, c);

  // the same pairs in elimination order, by columns
  for (auto& [i, j] : coupled) {
    const int p = place_[i], q = place_[j];
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

  matrix_.reset(
      cholmod_allocate_sparse(3 * blocks, 3 * blocks, 9 * rows_.size(), 1, 1, -1, CHOLMOD_REAL, c));
  int* start = static_cast<int*>(matrix_->p);
  int* row = static_cast<int*>(matrix_->i);
  for (int j = 0, k = 0; j < blocks; ++j)
    for (int column = 0; column < 3; ++column) {
      start[3 * j + column] = k;
      for (int b = column_start_[j]; b < column_start_[j + 1]; ++b)
        for (int r = 0; r < 3; ++r) row[k++] = 3 * rows_[b] + r;
      start[3 * j + column + 1] = k;
    }
  values_ = static_cast<double*>(matrix_->x);
  set_zero();

  c->nmethods = 1;
  c->method[0].ordering = CHOLMOD_NATURAL;
  c->postorder = 0;
  c->supernodal = CHOLMOD_SUPERNODAL;  // 3x3 blocks make supernodes pay even with 100 triangles
  factor_.reset(cholmod_analyze(matrix_.get(), c));
  rhs_.reset(cholmod_allocate_dense(3 * blocks, 1, 3 * blocks, CHOLMOD_REAL, c));
  if (!factor_ || !rhs_)
    throw Error(ErrorCode::simulation, "elastic step",
                "The matrix could not be laid out: out of memory.");
}

BlockCholesky::Slot BlockCholesky::slot(int i, int j) const {
  if (i < 0 || j < 0) return {};
  const int p = place_[i], q = place_[j];
  const int column = std::min(p, q), row = std::max(p, q);
  const auto first = rows_.begin() + column_start_[column],
             last = rows_.begin() + column_start_[column + 1];
  const int height = 3 * static_cast<int>(last - first);
  const auto found = std::lower_bound(first, last, row);
  if (found == last || *found != row) return {};
  const int index = static_cast<int>(found - first);
  return {9 * column_start_[column] + 3 * index, p >= q ? height : -height};
}

void BlockCholesky::set_zero() { std::memset(values_, 0, sizeof(double) * 9 * rows_.size()); }

void BlockCholesky::shift_diagonal(double value) {
  const int blocks = static_cast<int>(place_.size());
  for (int j = 0; j < blocks; ++j) {
    const int height = 3 * (column_start_[j + 1] - column_start_[j]);
    // the diagonal block is the first of its column
    double* block = values_ + 9 * column_start_[j];
    for (int c = 0; c < 3; ++c) block[c * height + c] += value;
  }
}

bool BlockCholesky::factorise() {
  stay_on_this_thread();
  const auto turn = turn_at_blas();
  cholmod_factorize(matrix_.get(), factor_.get(), common_.get());
  if (common_->status == CHOLMOD_OUT_OF_MEMORY)
    throw Error(ErrorCode::simulation, "elastic step",
                "The matrix could not be factorised: out of memory.", "Use fewer triangles.");
  return common_->status == CHOLMOD_OK && factor_->minor == factor_->n;
}

const Eigen::VectorXd& BlockCholesky::solve(const Eigen::VectorXd& b) {
  stay_on_this_thread();
  const auto turn = turn_at_blas();
  const int blocks = static_cast<int>(place_.size());
  double* rhs = static_cast<double*>(rhs_->x);
  for (int i = 0; i < blocks; ++i)
    Eigen::Map<Eigen::Vector3d>(rhs + 3 * place_[i]) = b.segment<3>(3 * i);
  cholmod_dense *x = x_.release(), *y = y_.release(), *e = e_.release();
  cholmod_solve2(CHOLMOD_A, factor_.get(), rhs_.get(), nullptr, &x, nullptr, &y, &e, common_.get());
  x_.reset(x);
  y_.reset(y);
  e_.reset(e);
  const double* solution = static_cast<const double*>(x->x);
  for (int i = 0; i < blocks; ++i)
    solution_.segment<3>(3 * i) = Eigen::Map<const Eigen::Vector3d>(solution + 3 * place_[i]);
  return solution_;
}

Eigen::MatrixXd BlockCholesky::dense() const {
  const int blocks = static_cast<int>(place_.size());
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
