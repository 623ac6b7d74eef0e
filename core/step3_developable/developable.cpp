#include "core/step3_developable/developable.h"

#include "core/model/segment2.h"

#include <Eigen/SparseCholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace paperbake {
namespace {

struct Edge {
  int i, j;
  double length;  // [m] on the pattern
  double area;    // [m2] a third of the area of its triangles
};

/// The edges of a sheet and the areas that its edges and vertices represent.
struct Weighted {
  std::vector<Edge> edges;
  std::vector<double> area;  // [m2] a third of the area of the triangles around each vertex
};

Weighted weigh(const Sheet& sheet) {
  Weighted result;
  result.area.assign(sheet.pattern.rows(), 0.0);
  std::map<std::pair<int, int>, double> shares;
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    const auto at = [&](int k) -> Vector2d { return sheet.pattern.row(sheet.triangles(t, k)); };
    const Vector2d u = at(1) - at(0), v = at(2) - at(0);
    const double third = std::abs(cross(u, v)) / 6;
    for (int k = 0; k < 3; ++k) {
      const int a = sheet.triangles(t, k), b = sheet.triangles(t, (k + 1) % 3);
      shares[{std::min(a, b), std::max(a, b)}] += third;
      result.area[a] += third;
    }
  }
  for (const auto& [ends, area] : shares)
    result.edges.push_back({ends.first, ends.second,
                            (sheet.pattern.row(ends.first) - sheet.pattern.row(ends.second)).norm(),
                            area});
  return result;
}

double stretch(const Edge& e, const Points3& x) {
  return (x.row(e.i) - x.row(e.j)).norm() / e.length - 1;
}

double worst(const std::vector<Edge>& edges, const Points3& x) {
  double most = 0;
  for (const Edge& e : edges) most = std::max(most, std::abs(stretch(e, x)));
  return most;
}

/// The part of a stretch that exceeds what is left alone, with its sign.
double excess(double stretch, double left_alone) {
  return stretch - std::clamp(stretch, -left_alone, left_alone);
}

double misfit(const std::vector<Edge>& edges, const Points3& x, double left_alone) {
  double sum = 0;
  for (const Edge& e : edges) sum += e.area * std::pow(excess(stretch(e, x), left_alone), 2);
  return sum;
}

/// The normal equations of one iteration over the free vertices: the lower triangle of the matrix,
/// whose entries are looked up only once.
class Iteration {
 public:
  Iteration(const Weighted& sheet, std::vector<int> place, int free, double left_alone)
      : sheet_(sheet),
        place_(std::move(place)),
        left_alone_(left_alone),
        right_(3 * free),
        matrix_(3 * free, 3 * free) {
    double mean = 0;
    for (const double a : sheet.area) mean += a / sheet.area.size();
    stay_.assign(free, 0.0);
    for (std::size_t v = 0; v < place_.size(); ++v)
      if (place_[v] >= 0) stay_[place_[v]] = sheet.area[v] / mean;

    std::vector<Eigen::Triplet<double>> entries;
    for (int k = 0; k < free; ++k)
      for (int c = 0; c < 3; ++c)
        for (int r = c; r < 3; ++r) entries.emplace_back(3 * k + r, 3 * k + c, 0);
    for (const Edge& e : sheet.edges)
      if (const auto [low, high] = std::minmax(place_[e.i], place_[e.j]); low >= 0)
        for (int c = 0; c < 3; ++c)
          for (int r = 0; r < 3; ++r) entries.emplace_back(3 * high + r, 3 * low + c, 0);
    matrix_.setFromTriplets(entries.begin(), entries.end());
    solver_.analyzePattern(matrix_);
    for (const Edge& e : sheet.edges) {
      std::array<double*, 3> columns{};
      if (const auto [low, high] = std::minmax(place_[e.i], place_[e.j]); low >= 0)
        for (int c = 0; c < 3; ++c) columns[c] = &matrix_.coeffRef(3 * high, 3 * low + c);
      between_.push_back(columns);
    }
  }

  /// Moves x by one iteration; false when the equations cannot be solved.
  bool move(Points3& x, double anchor) {
    matrix_.coeffs().setZero();
    right_.setZero();
    for (std::size_t k = 0; k < stay_.size(); ++k)
      for (int c = 0; c < 3; ++c) *diagonal(k, c) = anchor * stay_[k];
    for (std::size_t k = 0; k < sheet_.edges.size(); ++k) add(sheet_.edges[k], between_[k], x);
    solver_.factorize(matrix_);
    if (solver_.info() != Eigen::Success) return false;
    const Eigen::VectorXd d = solver_.solve(right_);
    for (int v = 0; v < x.rows(); ++v)
      if (place_[v] >= 0) x.row(v) += d.segment<3>(3 * place_[v]).transpose();
    return true;
  }

 private:
  /// Entry (c, c) of the diagonal block of a free vertex; the rest of its column follows it.
  double* diagonal(int k, int c) { return matrix_.valuePtr() + matrix_.outerIndexPtr()[3 * k + c]; }

  void add(const Edge& e, const std::array<double*, 3>& between, const Points3& x) {
    const Vector3d span = (x.row(e.i) - x.row(e.j)).transpose();
    const double length = span.norm(), weight = e.area / (e.length * e.length);
    if (length < 1e-3 * e.length) return;  // a collapsed edge has no direction
    const Vector3d n = span / length;
    const double pull = weight * e.length * excess(length / e.length - 1, left_alone_);
    const Eigen::Matrix3d block = weight * n * n.transpose();
    const int ends[2] = {place_[e.i], place_[e.j]};
    for (int a = 0; a < 2; ++a) {
      if (ends[a] < 0) continue;
      right_.segment<3>(3 * ends[a]) -= (a == 0 ? pull : -pull) * n;
      for (int c = 0; c < 3; ++c)
        for (int r = c; r < 3; ++r) diagonal(ends[a], c)[r - c] += block(r, c);
    }
    for (int c = 0; between[0] && c < 3; ++c)
      for (int r = 0; r < 3; ++r) between[c][r] -= block(r, c);
  }

  const Weighted& sheet_;
  std::vector<int> place_;  // number of each vertex among the free ones; -1: held
  double left_alone_;
  std::vector<double> stay_;
  Eigen::VectorXd right_;
  Eigen::SparseMatrix<double> matrix_;
  // for each edge: the columns of the block between its ends; null when one of them is held
  std::vector<std::array<double*, 3>> between_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

}  // namespace

Restored restore_lengths(Sheet& sheet, const std::vector<int>& held,
                         const DevelopableOptions& options) {
  const Weighted weighted = weigh(sheet);
  Restored result;
  result.before = result.after = worst(weighted.edges, sheet.x);
  if (result.before <= options.left_alone) return result;
  std::vector<int> place(sheet.x.rows(), 0);
  for (const int v : held) place[v] = -1;
  int free = 0;
  for (int& p : place)
    if (p == 0) p = free++;
  if (free == 0) return result;

  Iteration iteration(weighted, place, free, options.left_alone);
  Points3 best = sheet.x;
  const double size =
      (sheet.pattern.colwise().maxCoeff() - sheet.pattern.colwise().minCoeff()).norm();
  const double first = misfit(weighted.edges, best, options.left_alone);
  double least = first;
  for (double anchor = 1e-6; least > 1e-4 * first && result.iterations < options.max_iterations;
       ++result.iterations) {
    Points3 x = best;
    const double now =
        iteration.move(x, anchor) ? misfit(weighted.edges, x, options.left_alone) : least;
    if (now < least && (x - sheet.x).rowwise().norm().maxCoeff() <= options.max_move * size) {
      least = now;
      best = x;
      anchor *= 0.1;
    } else {
      anchor *= 30;
    }
  }
  result.after = worst(weighted.edges, best);
  result.moved = (best - sheet.x).rowwise().norm().maxCoeff();
  sheet.x = best;
  return result;
}

}  // namespace paperbake
