#include "core/step1_elastic/contact/sheet_contact.h"

#include "core/geometry/measure.h"
#include "core/geometry/proximity.h"
#include "core/geometry/rest_triangle.h"
#include "core/step1_elastic/contact/additive_ccd.h"
#include "core/step1_elastic/contact/barrier.h"
#include "core/step1_elastic/contact/friction.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace paperbake {
namespace {

constexpr double max_dhat = 5e-4;      // [m]
constexpr double pattern_share = 0.3;  // [1] dhat over the distance on the pattern
// [1] dhat over a distance that targets or the initial positions prescribe; a pair whose dhat would
// be less than this fraction of that of the sheets has none
constexpr double gap_share = 0.9, min_share = 0.01;
// [1] of dhat of the sheets: pairs whose dhat is less than this began so close, or have such close
// targets, that their contact chatters; friction would jam them
constexpr double lies_on = 0.5;
// [1] fraction of dhat: pairs closer than this get blocks in the matrix
constexpr double spaced = 1.5;

std::array<Vector3d, 4> corners(const Points3& x, const std::array<int, 4>& v) {
  return {x.row(v[0]).transpose(), x.row(v[1]).transpose(), x.row(v[2]).transpose(),
          x.row(v[3]).transpose()};
}

std::array<Vector3d, 4> moves(const Points3& from, const Points3& to, const std::array<int, 4>& v) {
  std::array<Vector3d, 4> m;
  for (int i = 0; i < 4; ++i) m[i] = (to.row(v[i]) - from.row(v[i])).transpose();
  return m;
}

/// Vertices around which no triangle deviates by 60 degrees or more from the mean normal: nothing
/// but neighbours can be near there.
std::vector<char> flat_stars(const Points3& x, const Triangles& triangles) {
  Points3 normal(triangles.rows(), 3), mean = Points3::Zero(x.rows(), 3);
  for (int t = 0; t < triangles.rows(); ++t) {
    const Vector3d a = x.row(triangles(t, 0)), b = x.row(triangles(t, 1)),
                   c = x.row(triangles(t, 2));
    normal.row(t) = triangle_normal(a, b, c);
    for (int i = 0; i < 3; ++i) mean.row(triangles(t, i)) += normal.row(t);
  }
  std::vector<char> flat(x.rows(), 1);
  for (int t = 0; t < triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i) {
      const int v = triangles(t, i);
      const double along = mean.row(v).dot(normal.row(t));
      if (!(along > 0) || along * along < 0.25 * mean.row(v).squaredNorm()) flat[v] = 0;
    }
  return flat;
}

/// True if a plane keeps two triangles apart all along the step, and by `gap` at its end. The
/// coordinate of a point along a fixed axis is linear in time, so both ends are enough.
bool separated(const Points3& from, const Points3& to, const int* a, const int* b, double gap) {
  const auto at = [&](const Points3& x, int v) -> Vector3d { return x.row(v); };
  const auto by = [&](const Vector3d& axis) {
    const auto low = [&](const Points3& x, const int* t) {
      return std::min({at(x, t[0]).dot(axis), at(x, t[1]).dot(axis), at(x, t[2]).dot(axis)});
    };
    const auto high = [&](const Points3& x, const int* t) {
      return std::max({at(x, t[0]).dot(axis), at(x, t[1]).dot(axis), at(x, t[2]).dot(axis)});
    };
    if (low(to, b) - high(to, a) >= gap) return low(from, b) > high(from, a);
    if (low(to, a) - high(to, b) >= gap) return low(from, a) > high(from, b);
    return false;
  };
  const Vector3d a0 = at(to, a[0]), a1 = at(to, a[1]), a2 = at(to, a[2]), b0 = at(to, b[0]),
                 b1 = at(to, b[1]), b2 = at(to, b[2]);
  return by((b0 + b1 + b2 - a0 - a1 - a2).normalized()) || by(triangle_normal(a0, a1, a2)) ||
         by(triangle_normal(b0, b1, b2));
}

}  // namespace

/// One sheet and itself.
static SheetPartition alone(const Points2& pattern, const Triangles& triangles, double friction,
                            int number) {
  double area = 0;
  for (int t = 0; t < triangles.rows(); ++t) area += rest_triangle(pattern, triangles.row(t)).area;
  return {std::vector<int>(pattern.rows(), 0),
          Eigen::MatrixXd::Constant(1, 1, std::min(max_dhat, 0.01 * std::sqrt(area))),
          {},
          {friction},
          {number},
          {0}};
}

SheetContact::SheetContact(const Points2& pattern, const Triangles& triangles, double friction,
                           int number)
    : SheetContact(pattern, triangles, alone(pattern, triangles, friction, number)) {
  separation_bound_.emplace(pattern, triangles);
}

SheetContact::SheetContact(const Points2& pattern, const Triangles& triangles,
                           SheetPartition sheets)
    : pattern_(pattern),
      triangles_(triangles),
      sheets_(std::move(sheets)),
      dhat_(sheets_.dhat.maxCoeff()),
      candidate_margin_(0.5 * dhat_),
      constraint_of_(pattern.rows(), -1) {}

SweptBoxPairs& SheetContact::near() {
  if (!near_) near_.emplace(triangles_);
  return *near_;
}

void SheetContact::set_constraints(const Points3& start, const PositionConstraints& hard) {
  for (const PositionConstraint& c : hard_) constraint_of_[c.vertex] = -1;
  hard_ = hard;
  for (std::size_t k = 0; k < hard_.size(); ++k)
    constraint_of_[hard_[k].vertex] = static_cast<int>(k);
  start_ = start;
}

double SheetContact::dhat_of(const std::array<int, 4>& v, Features features) const {
  std::array<Vector3d, 4> p;
  bool all_held = true;
  for (int i = 0; i < 4; ++i) {
    p[i] << pattern_(v[i], 0), pattern_(v[i], 1), 0;
    all_held &= constraint_of_[v[i]] >= 0;
  }
  if (all_held) return 0;
  const auto [a, b] = sheets_of(v, features);
  if (a == b) {
    double dhat =
        std::min(sheets_.dhat(a, a), pattern_share * closest_points(p, features).distance());
    if (panels_.rows() > 0)
      dhat = std::min(
          dhat, std::max(least_between_panels_,
                         gap_share * closest_points(corners(panels_, v), features).distance()));
    return dhat_near_constraints(v, features, dhat);
  }
  double dhat = sheets_.dhat(a, b);
  if (sheets_.initial_positions.rows() > 0) {
    const double initial =
        gap_share * closest_points(corners(sheets_.initial_positions, v), features).distance();
    if (initial < min_share * dhat) return 0;
    dhat = std::min(dhat, initial);
  }
  return dhat_near_constraints(v, features, dhat);
}

double SheetContact::dhat_near_constraints(const std::array<int, 4>& v, Features features,
                                           double dhat) const {
  const int cut = second_of(features);  // corners before it belong to the first feature
  int first[2] = {-1, -1}, last[2] = {-1, -1};
  for (int i = 0; i < 4; ++i)
    if (constraint_of_[v[i]] >= 0) {
      if (first[i >= cut] < 0) first[i >= cut] = v[i];
      last[i >= cut] = v[i];
    }
  if (first[0] < 0 || first[1] < 0) return dhat;
  // the constrained part of either feature is a point or an edge: where it is a whole triangle, all
  // four corners are constrained, which all_held has dealt with
  std::array<int, 4> part{first[0], last[0], first[1], last[1]};
  std::array<Vector3d, 4> target;
  for (int i = 0; i < 4; ++i) target[i] = hard_[constraint_of_[part[i]]].target;
  const double apart =
      std::min(edge_to_edge(target).distance(), edge_to_edge(corners(start_, part)).distance());
  const double shrunk = std::min(dhat, gap_share * apart);
  return shrunk < min_share * dhat ? 0 : shrunk;
}

template <class Visit>
void SheetContact::for_each_pair(int a, int b, Visit visit) {
  const auto has = [&](int t, int v) {
    return triangles_(t, 0) == v || triangles_(t, 1) == v || triangles_(t, 2) == v;
  };
  for (const auto& [s, t] : {std::pair{a, b}, std::pair{b, a}})
    for (int i = 0; i < 3; ++i)
      if ((near().owned()[s].corners >> i & 1) && !has(t, triangles_(s, i)))
        visit(std::array<int, 4>{triangles_(s, i), triangles_(t, 0), triangles_(t, 1),
                                 triangles_(t, 2)},
              Features::vertex_and_triangle);
  for (int i = 0; i < 3; ++i) {
    if (!(near().owned()[a].edges >> i & 1)) continue;
    const int p = triangles_(a, (i + 1) % 3), q = triangles_(a, (i + 2) % 3);
    for (int j = 0; j < 3; ++j) {
      if (!(near().owned()[b].edges >> j & 1)) continue;
      const int r = triangles_(b, (j + 1) % 3), s = triangles_(b, (j + 2) % 3);
      if (p != r && p != s && q != r && q != s)
        visit(std::array<int, 4>{p, q, r, s}, Features::two_edges);
    }
  }
}

bool SheetContact::pair_collides(const Points3& from, const Points3& to,
                                 const std::array<int, 4>& v, Features features) const {
  const auto begin = corners(from, v), end = corners(to, v), move = moves(from, to, v);
  const double d0 = closest_points(begin, features).distance(),
               d1 = closest_points(end, features).distance();
  const bool free = d0 + d1 > relative_move(move, features);
  if (d1 >= dhat_ && free) return false;
  const double dhat = dhat_of(v, features);
  if (dhat == 0 || d0 <= no_distance) return false;
  return d1 < dhat || (!free && paperbake::collision_free_step(begin, move, features) < 1);
}

bool SheetContact::any_pair_collides(int a, int b, const Points3& from, const Points3& to) {
  bool met = false;
  for_each_pair(a, b, [&](const std::array<int, 4>& v, Features features) {
    met = met || pair_collides(from, to, v, features);
  });
  return met;
}

bool SheetContact::is_collision_free(const Points3& from, const Points3& to,
                                     const PositionConstraints& hard) {
  if (separation_bound_ && separation_bound_->holds_along_step(from, to, pattern_share))
    return true;
  set_constraints(from, hard);
  const std::vector<char> flat_from = flat_stars(from, triangles_),
                          flat_to = flat_stars(to, triangles_);
  for (const auto& [a, b] : near().find(from, to - from, 0.5 * dhat_)) {
    bool neighbours = false, flat = false;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        if (const int v = triangles_(a, i); v == triangles_(b, j)) {
          neighbours = true;
          flat |= flat_from[v] && flat_to[v];
        }
    if (neighbours ? flat : separated(from, to, &triangles_(a, 0), &triangles_(b, 0), dhat_))
      continue;
    if (any_pair_collides(a, b, from, to)) return false;
  }
  return true;
}

bool SheetContact::is_collision_free_between_sheets(const Points3& from, const Points3& to,
                                                    const PositionConstraints& hard) {
  set_constraints(from, hard);
  for (const auto& [a, b] : near().find(from, to - from, 0.5 * dhat_)) {
    if (sheets_.of_vertex[triangles_(a, 0)] == sheets_.of_vertex[triangles_(b, 0)]) continue;
    if (!separated(from, to, &triangles_(a, 0), &triangles_(b, 0), dhat_) &&
        any_pair_collides(a, b, from, to))
      return false;
  }
  return true;
}

void SheetContact::find_initially_intersecting(const Points3& x) {
  entangled_.clear();
  for (const auto& [a, b] : near().find(x, Points3::Zero(x.rows(), 3), 0))
    if (pierce_each_other(x, triangles_, a, b)) entangled_.emplace_back(a, b);
}

bool SheetContact::initially_intersecting(const std::array<int, 4>& v, Features features) const {
  const auto belongs = [&](int t, int first, int last) {
    return std::all_of(v.begin() + first, v.begin() + last,
                       [&](int w) { return (triangles_.row(t).array() == w).any(); });
  };
  const int cut = second_of(features);
  return std::any_of(entangled_.begin(), entangled_.end(), [&](const std::pair<int, int>& two) {
    return (belongs(two.first, 0, cut) && belongs(two.second, cut, 4)) ||
           (belongs(two.second, 0, cut) && belongs(two.first, cut, 4));
  });
}

void SheetContact::begin(const Points3& x, const PositionConstraints& hard,
                         const FrictionHistory& history) {
  set_constraints(x, hard);
  find_initially_intersecting(x);
  build_candidates(x, Points3::Zero(x.rows(), 3));
  begin_friction(history);
}

TouchingFeatures SheetContact::name_of(const ContactPair& pair, bool& swapped) const {
  const auto [a, b] = sheets_of(pair.vertices, pair.features);
  TouchingFeatures name{{sheets_.number[a], sheets_.number[b]}, pair.vertices};
  std::array<int, 4>& v = name.vertices;
  const int cut = second_of(pair.features);
  for (int i = 0; i < 4; ++i) v[i] -= sheets_.first[i < cut ? a : b];
  std::sort(v.begin(), v.begin() + cut);
  std::sort(v.begin() + cut, v.end());
  swapped = pair.features == Features::two_edges &&
            std::tie(name.body[1], v[2], v[3]) < std::tie(name.body[0], v[0], v[1]);
  if (swapped) name = {{name.body[1], name.body[0]}, {v[2], v[3], v[0], v[1]}};
  return name;
}

void SheetContact::begin_friction(const FrictionHistory& history) {
  friction_contacts_.clear();
  const std::vector<double>& mu = sheets_.friction;
  if (std::all_of(mu.begin(), mu.end(), [](double one) { return one == 0; })) return;
  for_each_active(start_, 1, [&](std::size_t k, const ClosestPoints& near, double d) {
    const ContactPair& pair = pairs_[k];
    const auto [a, b] = sheets_of(pair.vertices, pair.features);
    if (pair.dhat < lies_on * std::min(sheets_.dhat(a, a), sheets_.dhat(b, b))) return;
    const double force = std::sqrt(mu[a] * mu[b]) * -barrier(d, pair.dhat).slope;
    if (!(force > 0)) return;
    bool swapped = false;
    const TouchingFeatures name = name_of(pair, swapped);
    const Eigen::Matrix<double, 3, 2> to_history = (swapped ? -1 : 1) * tangents_of(near.apart / d);
    friction_contacts_.push_back(
        {pair.vertices, sliding_map(corners(start_, pair.vertices), pair.features, near), force,
         to_history, name, to_history.transpose() * history.shear(name)});
  });
}

void SheetContact::remember(const Points3& y, FrictionHistory& history) const {
  for (const FrictionContact& friction : friction_contacts_)
    history.remember(friction.name, friction.to_history * sheared(trial_shear(friction, y)));
}

/// [m] The shear of a pair with the sheets at y, if it does not slide.
Eigen::Vector2d SheetContact::trial_shear(const FrictionContact& friction, const Points3& y) const {
  Eigen::Vector2d u = friction.shear;
  for (int i = 0; i < 4; ++i)
    u += friction.along[i] *
         (y.row(friction.vertices[i]) - start_.row(friction.vertices[i])).transpose();
  return u;
}

void SheetContact::build_candidates(const Points3& y, const Points3& move) {
  pairs_.clear();
  gap_bound_.clear();
  const Points3 end = y + move, low = y.cwiseMin(end), high = y.cwiseMax(end);
  const double within = dhat_ + 2 * candidate_margin_;
  const auto boxes_apart = [&](const std::array<int, 4>& v, Features features) {
    for (int k = 0; k < 3; ++k) {
      double low_a = low(v[0], k), high_a = high(v[0], k),
             low_b = std::min(low(v[2], k), low(v[3], k)),
             high_b = std::max(high(v[2], k), high(v[3], k));
      if (features == Features::two_edges) {
        low_a = std::min(low_a, low(v[1], k));
        high_a = std::max(high_a, high(v[1], k));
      } else {
        low_b = std::min(low_b, low(v[1], k));
        high_b = std::max(high_b, high(v[1], k));
      }
      if (low_b - high_a > within || low_a - high_b > within) return true;
    }
    return false;
  };
  for (const auto& [a, b] : near().find(y, move, 0.5 * within)) {
    for_each_pair(a, b, [&](const std::array<int, 4>& v, Features features) {
      if (boxes_apart(v, features)) return;
      const double d = closest_points(corners(y, v), features).distance();
      const double least = d - relative_move(moves(y, end, v), features);
      if (least > within || initially_intersecting(v, features)) return;
      const double dhat = dhat_of(v, features);
      if (dhat == 0 || least > dhat + 2 * candidate_margin_ || d <= no_distance) return;
      pairs_.push_back({v, features, dhat});
      gap_bound_.push_back(least - dhat);
    });
  }
  slots_.resize(pairs_.size());
  placed_.assign(pairs_.size(), 0);
  reference_ = y;
  swept_ = true;
}

double SheetContact::drift(const Points3& y) const { return max_row_norm(y - reference_); }

void SheetContact::update_candidates(const Points3& y, const Points3& move) {
  if (drift(y) <= candidate_margin_ && drift(y + move) <= candidate_margin_)
    swept_ = false;
  else
    build_candidates(y, move);
}

void SheetContact::commit_step(const Points3& y) {
  if (swept_) reference_ = y;
  swept_ = false;
}

double SheetContact::collision_free_step(const Points3& y, const Points3& move) const {
  const double fastest = 2 * max_row_norm(move), off = 2 * drift(y);
  const Points3 end = y + move;
  double share = 1;
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const ContactPair& pair = pairs_[k];
    if (is_certainly_free(gap_bound_[k] + pair.dhat - off, fastest)) continue;
    auto move_of = moves(y, end, pair.vertices);
    for (Vector3d& m : move_of) m *= share;
    share *= paperbake::collision_free_step(corners(y, pair.vertices), move_of, pair.features);
  }
  return share;
}

template <class Visit>
void SheetContact::for_each_active(const Points3& y, double dhat_ratio, Visit visit) const {
  const double off = 2 * drift(y);
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const double within = dhat_ratio * pairs_[k].dhat;
    if (gap_bound_[k] + pairs_[k].dhat - off >= within) continue;
    const ClosestPoints near = closest_points(corners(y, pairs_[k].vertices), pairs_[k].features);
    const double d = near.distance();
    if (d < within) visit(k, near, d);
  }
}

double SheetContact::energy(const Points3& y) const {
  double sum = 0;
  for_each_active(y, 1, [&](std::size_t k, const ClosestPoints&, double d) {
    sum += barrier(d, pairs_[k].dhat).value;
  });
  for (const FrictionContact& friction : friction_contacts_)
    sum +=
        friction.force * friction_mollifier(trial_shear(friction, y).norm(), sticking_shear).value;
  return sum;
}

double SheetContact::differentiate(const Points3& y, Points3& gradient, BlockCholesky* matrix) {
  double sum = 0;
  for_each_active(y, 1, [&](std::size_t k, const ClosestPoints& near, double d) {
    const Barrier b = barrier(d, pairs_[k].dhat);
    const std::array<int, 4>& v = pairs_[k].vertices;
    const Vector3d n = near.apart / d;
    sum += b.value;
    for (int i = 0; i < 4; ++i) gradient.row(v[i]) += b.slope * near.weights[i] * n.transpose();
    if (!matrix) return;
    if (!placed_[k]) {
      slots_[k] = slots_of(v);
      placed_[k] = 1;
    }
    const Matrix3d nn = b.second * n * n.transpose();
    for (int p = 0, at = 0; p < 4; ++p)
      for (int q = p; q < 4; ++q, ++at)
        if (const double w = near.weights[p] * near.weights[q]; w != 0)
          matrix->add(slots_[k][at], Matrix3d(w * nn));
  });
  for (FrictionContact& friction : friction_contacts_) {
    const Eigen::Vector2d shear = trial_shear(friction, y);
    const FrictionMollifierInPlane f = friction_mollifier(shear, sticking_shear);
    sum += friction.force * f.value;
    for (int i = 0; i < 4; ++i)
      gradient.row(friction.vertices[i]) +=
          friction.force * f.across * shear.transpose() * friction.along[i];
    if (!matrix) continue;
    if (!friction.placed) {
      friction.slots = slots_of(friction.vertices);
      friction.placed = true;
    }
    for (int p = 0, at = 0; p < 4; ++p) {
      const Eigen::Matrix<double, 3, 2> half =
          friction.force * friction.along[p].transpose().lazyProduct(f.second);
      for (int q = p; q < 4; ++q, ++at)
        matrix->add(friction.slots[at], Matrix3d(half.lazyProduct(friction.along[q])));
    }
  }
  return sum;
}

SheetContact::Slots SheetContact::slots_of(const std::array<int, 4>& v) const {
  Slots slots;
  for (int p = 0, at = 0; p < 4; ++p)
    for (int q = p; q < 4; ++q, ++at) slots[at] = matrix_->slot(block_of_[v[p]], block_of_[v[q]]);
  return slots;
}

std::vector<std::pair<int, int>> SheetContact::coupled_vertices(const Points3& y) const {
  std::vector<std::pair<int, int>> coupled;
  for_each_active(y, spaced, [&](std::size_t k, const ClosestPoints&, double) {
    const std::array<int, 4>& v = pairs_[k].vertices;
    for (int p = 0; p < 4; ++p)
      for (int q = p + 1; q < 4; ++q) coupled.emplace_back(v[p], v[q]);
  });
  return coupled;
}

void SheetContact::bind(const BlockCholesky& matrix, const std::vector<int>& block_of) {
  matrix_ = &matrix;
  block_of_ = block_of;
  placed_.assign(pairs_.size(), 0);
  for (FrictionContact& friction : friction_contacts_) friction.placed = false;
}

std::vector<SheetContact::Touching> SheetContact::touching_by_sheet(const Points3& y) const {
  std::vector<Touching> counts(sheets_.dhat.rows());
  for_each_active(y, 1, [&](std::size_t k, const ClosestPoints&, double) {
    const auto [a, b] = sheets_of(pairs_[k].vertices, pairs_[k].features);
    if (a == b)
      ++counts[a].own;
    else {
      ++counts[a].others;
      ++counts[b].others;
    }
  });
  return counts;
}

int SheetContact::touching(const Points3& y) const {
  int count = 0;
  for_each_active(y, 1, [&](std::size_t, const ClosestPoints&, double) { ++count; });
  return count;
}

}  // namespace paperbake
