#include "formats/maps/map_raster.h"

#include <limits>

namespace paperbake {
namespace {

/// Adds the part of an edge within one row to an accumulation buffer, whose running sum along the
/// row is the covered area: the area to the right of the edge, with the sign of `height`.
/// source  the accumulation buffers of font rasterisers
void add_row_of_edge(double* change, double from, double to, double height) {
  const double left = std::min(from, to), right = std::max(from, to);
  const double first = std::floor(left), last = std::ceil(right);
  const int i = static_cast<int>(first), n = static_cast<int>(last);
  if (n <= i + 1) {  // all within one texel
    const double right_share = 0.5 * (from + to) - first;
    change[i] += height * (1 - right_share);
    change[i + 1] += height * right_share;
    return;
  }
  const double slope = 1 / (right - left);  // part of the height per texel
  const double in_first = first + 1 - left, in_last = right - (last - 1);
  double before = 0;  // part of the area of the texel to the left
  for (int k = i; k < n; ++k) {
    double share;  // part of texel k that lies to the right of the edge
    if (k == i)
      share = 0.5 * slope * in_first * in_first;
    else if (k == n - 1)
      share = 1 - 0.5 * slope * in_last * in_last;
    else
      share = slope * (in_first + (k - i - 0.5));
    change[k] += height * (share - before);
    before = share;
  }
  change[n] += height * (1 - before);
}

}  // namespace

Vector2d to_texels(const Vector2d& pattern, double side, int size) {
  return {pattern.x() / side * size - 0.5, size - 0.5 - pattern.y() / side * size};
}

std::vector<float> area_coverage(const std::vector<std::vector<Vector2d>>& loops,
                                 const MapRows& rows) {
  const int stride = rows.size + 2;
  std::vector<double> change(std::size_t(rows.last - rows.first) * stride, 0.0);
  for (const auto& loop : loops)
    for (std::size_t k = 0; k < loop.size(); ++k) {
      // shifted so that texel i is the interval i <= x < i + 1
      const Vector2d p = loop[k] + Vector2d(0.5, 0.5),
                     q = loop[(k + 1) % loop.size()] + Vector2d(0.5, 0.5);
      if (p.y() == q.y()) continue;
      const Vector2d &upper = p.y() < q.y() ? p : q, &lower = p.y() < q.y() ? q : p;
      const double sign = p.y() < q.y() ? 1 : -1,
                   slope = (lower.x() - upper.x()) / (lower.y() - upper.y());
      const int begin = std::clamp(static_cast<int>(std::floor(upper.y())), rows.first, rows.last);
      const int end = std::clamp(static_cast<int>(std::ceil(lower.y())), rows.first, rows.last);
      for (int row = begin; row < end; ++row) {
        const double y0 = std::max(upper.y(), double(row)), y1 = std::min(lower.y(), row + 1.0);
        if (y1 <= y0) continue;
        const auto x = [&](double y) {
          return std::clamp(upper.x() + slope * (y - upper.y()), 0.0, double(rows.size));
        };
        add_row_of_edge(&change[std::size_t(row - rows.first) * stride], x(y0), x(y1),
                        sign * (y1 - y0));
      }
    }

  std::vector<float> coverage(rows.count());
  for (int row = rows.first; row < rows.last; ++row) {
    double sum = 0;
    for (int i = 0; i < rows.size; ++i) {
      sum += change[std::size_t(row - rows.first) * stride + i];
      // rounding errors must not give a rim of texels outside the polygons any coverage
      coverage[rows.index(i, row)] = sum < 1e-6 ? 0.0f : static_cast<float>(std::min(sum, 1.0));
    }
  }
  return coverage;
}

std::vector<int> near_points(const std::vector<Vector2d>& points, const Vector2d& centre,
                             double reach) {
  double nearest = std::numeric_limits<double>::max();
  for (const Vector2d& p : points) nearest = std::min(nearest, (p - centre).norm());
  std::vector<int> near;
  for (std::size_t k = 0; k < points.size(); ++k)
    if ((points[k] - centre).norm() <= nearest + 2 * reach) near.push_back(static_cast<int>(k));
  return near;
}

}  // namespace paperbake
