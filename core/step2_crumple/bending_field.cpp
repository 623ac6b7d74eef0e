#include "core/step2_crumple/bending_field.h"

#include <algorithm>
#include <cmath>

namespace paperbake {

SampleGrid::SampleGrid(const Pattern& pattern) {
  const Vector2d size = extent(pattern);
  step = std::max(size.minCoeff() / 24, std::sqrt(size.prod() / 1500));
  columns_ = std::max(1, static_cast<int>(std::lround(size.x() / step)));
  rows_ = std::max(1, static_cast<int>(std::lround(size.y() / step)));
  number_.assign(columns_ * rows_, -1);
  for (int r = 0; r < rows_; ++r)
    for (int c = 0; c < columns_; ++c) {
      const Vector2d p(step * (c + 0.5), step * (r + 0.5));
      if (!contains(pattern, p)) continue;
      number_[r * columns_ + c] = count();
      sample_points.push_back(p);
    }
  neighbours.resize(sample_points.size());
  for (int r = 0; r < rows_; ++r)
    for (int c = 0; c < columns_; ++c) {
      const int here = number_[r * columns_ + c];
      const auto join = [&](int there) {
        if (here < 0 || there < 0) return;
        neighbours[here].push_back(there);
        neighbours[there].push_back(here);
      };
      if (c + 1 < columns_) join(number_[r * columns_ + c + 1]);
      if (r + 1 < rows_) join(number_[(r + 1) * columns_ + c]);
    }
}

int SampleGrid::nearest(const Vector2d& p) const {
  const int c = std::clamp(static_cast<int>(std::floor(p.x() / step)), 0, columns_ - 1);
  const int r = std::clamp(static_cast<int>(std::floor(p.y() / step)), 0, rows_ - 1);
  return number_[r * columns_ + c];
}

}  // namespace paperbake
