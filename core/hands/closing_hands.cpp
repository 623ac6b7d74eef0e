#include "core/hands/closing_hands.h"

#include <algorithm>
#include <tuple>

namespace paperbake {
namespace {

constexpr double reach = 0.2;    // [1] of the longer side: 1.5 edges of a first mesh
constexpr double nearer = 0.05;  // [1] of their distance on the pattern, that handles come nearer
constexpr double apart = 0.2;    // [1] of the distance of two handles, from other points

double distance(const Handle& a, const Handle& b) { return (a.pattern - b.pattern).norm(); }

/// Whether the straight line between two handles lies on the paper.
bool see_each_other(const Pattern& pattern, const Handle& a, const Handle& b) {
  constexpr double rounding = 1e-9;  // [1]
  return paper_distance(pattern, a.pattern, b.pattern) <= (1 + rounding) * distance(a, b);
}

/// Whether two handles are keyed nearer to each other than they are on the pattern.
bool come_nearer(const Handle& a, const Handle& b) {
  if (a.mode != HandleMode::absolute || b.mode != HandleMode::absolute) return false;
  const double near = (1 - nearer) * distance(a, b);
  const int rows = static_cast<int>(std::max(a.keyed.rows(), b.keyed.rows()));
  for (int row = 0; row < rows; ++row)
    if ((keyed_position(a, row) - keyed_position(b, row)).norm() < near) return true;
  return false;
}

}  // namespace

std::vector<Vector2d> points_in_closing_hands(const Shot& shot) {
  const std::vector<Handle>& all = shot.handles;
  const std::size_t n = all.size();
  const double far = reach * longer_side(shot.pattern);
  std::vector<std::vector<char>> closes(n, std::vector<char>(n, 0));
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t h = 0; h < n; ++h)
    for (std::size_t k = 0; k < h; ++k)
      if (const double length = distance(all[h], all[k]); 0 < length && length < far)
        closes[h][k] = closes[k][h] =
            come_nearer(all[h], all[k]) && see_each_other(shot.pattern, all[h], all[k]);
  for (std::size_t h = 0; h < n; ++h)
    for (std::size_t k = 0; k < h; ++k)
      for (std::size_t m = 0; closes[h][k] && m < n; ++m)
        if (closes[h][m] && closes[k][m]) {
          pairs.emplace_back(distance(all[h], all[k]), k, h);
          break;
        }
  std::sort(pairs.begin(), pairs.end());

  std::vector<Vector2d> points;
  for (const auto& [length, h, k] : pairs) {
    const Vector2d middle = 0.5 * (all[h].pattern + all[k].pattern);
    const auto is_near = [&, clear = apart * length](const Vector2d& p) {
      return (p - middle).norm() < clear;
    };
    if (std::none_of(points.begin(), points.end(), is_near) &&
        std::none_of(all.begin(), all.end(), [&](const Handle& a) { return is_near(a.pattern); }))
      points.push_back(middle);
  }
  return points;
}

}  // namespace paperbake
