#include "core/hands/clamps.h"

#include "core/linear_algebra/symmetric_eigen.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace paperbake {
namespace {

constexpr double rigid = 2e-3;       // [1] of the longer side: a clamp keeps its distances to this
constexpr double min_length = 0.05;  // [1] of the longer side, of a clamp
constexpr double min_plate = 0.02;   // [1] of the longer side: what is narrower is a line

}  // namespace

Clamps::Clamps(const Shot& shot, int first_frame)
    : shot_(shot), first_frame_(first_frame), side_(longer_side(shot.pattern)) {
  for (std::size_t h = 0; h < shot.handles.size(); ++h) {
    rows_ = std::max(rows_, static_cast<int>(shot.handles[h].keyed.rows()));
    if (shot.handles[h].mode == HandleMode::absolute) absolute_.push_back(static_cast<int>(h));
  }
  find();
}

int Clamps::parting(int h, int k) const {
  const double apart = (place(h) - place(k)).norm();
  int row = 0;
  while (row < rows_ && (!held(h, row) || !held(k, row) ||
                         std::abs((keyed(h, row) - keyed(k, row)).norm() - apart) <= rigid * side_))
    ++row;
  return row;
}

std::vector<int> Clamps::rows_of_parting() const {
  std::set<int> rows;
  for (const int h : absolute_)
    for (const int k : absolute_)
      if (k < h) rows.insert(parting(h, k));
  rows.erase(rows_);
  return {rows.rbegin(), rows.rend()};
}

/// Whether two handles keep their distance for as long as both hold, which is at least half of the
/// time of either: one that takes over from another is no part of its hand.
bool Clamps::are_rigid(int h, int k) const {
  if (parting(h, k) < rows_) return false;
  int held_h = 0, held_k = 0, together = 0;  // rows
  for (int row = 0; row < rows_; ++row) {
    held_h += held(h, row);
    held_k += held(k, row);
    together += held(h, row) && held(k, row);
  }
  return together > 0 && 2 * together >= std::min(held_h, held_k);
}

/// Each handle with those near it first, as long as all are rigid with each other; then the plates
/// of two handles that are rigid, but in no clamp yet: a handle on a fold belongs to the plates on
/// both its sides, of which it is nearer to one.
void Clamps::find() {
  const std::size_t n = absolute_.size();
  RigidWith rigid_with(n, std::vector<char>(n, 0));
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j)
      rigid_with[i][j] = rigid_with[j][i] = are_rigid(absolute_[i], absolute_[j]);
  std::set<std::vector<int>> found;
  RigidWith together(n, std::vector<char>(n, 0));
  const auto add = [&](const std::vector<std::size_t>& members, bool plates_only) {
    for (const std::size_t i : members)
      for (const std::size_t j : members) together[i][j] = 1;
    std::vector<int> handles;
    for (const std::size_t m : members) handles.push_back(absolute_[m]);
    std::sort(handles.begin(), handles.end());
    const Vector2d size = extent_of(handles);
    const bool is_plate = handles.size() > 2 && size[1] > min_plate * side_;
    if (size[0] > min_length * side_ && (is_plate || !plates_only) && found.insert(handles).second)
      clamps_.push_back({handles, is_plate});
  };
  for (std::size_t seed = 0; seed < n; ++seed) add(rigid_around({seed}, rigid_with), false);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (rigid_with[i][j] && !together[i][j]) add(rigid_around({j, i}, rigid_with), true);
}

/// These handles and all others that are rigid with them and with each other, those near the first
/// one first. Handles are numbered as in `absolute_`.
std::vector<std::size_t> Clamps::rigid_around(std::vector<std::size_t> members,
                                              const RigidWith& rigid_with) const {
  std::vector<std::size_t> order(absolute_.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const Vector2d middle = place(absolute_[members.front()]);
  const auto distance = [&](std::size_t i) { return (place(absolute_[i]) - middle).norm(); };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t i, std::size_t j) { return distance(i) < distance(j); });
  for (const std::size_t i : order)
    if (std::all_of(members.begin(), members.end(),
                    [&](std::size_t m) { return i != m && rigid_with[i][m]; }))
      members.push_back(i);
  return members;
}

/// [m] Root of the summed squares of the distances from the middle, along and across the handles.
Vector2d Clamps::extent_of(const std::vector<int>& handles) const {
  Points2 p(handles.size(), 2);
  for (Eigen::Index k = 0; k < p.rows(); ++k) p.row(k) = place(handles[k]);
  p.rowwise() -= p.colwise().mean().eval();
  const SymmetricEigen<2> axes = symmetric_eigen(Eigen::Matrix2d(p.transpose() * p));
  return axes.values.cwiseMax(0).cwiseSqrt().reverse();
}

std::optional<RigidMotion> Clamps::pose(const Clamp& clamp, int row) const {
  const std::size_t n = clamp.handles.size();
  Points3 flat(n, 3), now(n, 3);
  for (std::size_t k = 0; k < n; ++k) {
    const int h = clamp.handles[k];
    if (!held(h, row)) return std::nullopt;
    flat.row(k) << place(h).x(), place(h).y(), 0;
    now.row(k) = keyed(h, row);
  }
  return nearest_rigid_motion(flat, now);
}

Vector2d Clamps::middle(const Clamp& clamp) const {
  Vector2d sum(0, 0);
  for (const int h : clamp.handles) sum += place(h);
  return sum / clamp.handles.size();
}

}  // namespace paperbake
