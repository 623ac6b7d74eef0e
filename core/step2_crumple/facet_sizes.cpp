#include "core/step2_crumple/facet_sizes.h"

#include "core/model/serializer.h"

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

// [1] widths of the longest ridge that the sheet can have. An edge no longer than such a ridge is
// wide could not carry it.
constexpr double initial_length = 6, least_length = 1;
// [1] of its length: an edge longer than that is divided, and has the right length afterwards
constexpr double divided_beyond = 1.4;

}  // namespace

FacetSizes::FacetSizes(const Pattern& pattern, const Paper& paper)
    : cell_(extent(pattern) / columns),
      least_(least_length * ridge_width(paper, std::sqrt(area(pattern)))),
      lengths_(columns * columns, initial_length / least_length * least_) {}

double FacetSizes::at(const Vector2d& p) const {
  const auto index = [&](int axis) {
    return std::clamp(static_cast<int>(p[axis] / cell_[axis]), 0, columns - 1);
  };
  return lengths_[index(1) * columns + index(0)];
}

void FacetSizes::refine(const Vector2d& p, double radius, double factor) {
  for (int row = 0; row < columns; ++row)
    for (int column = 0; column < columns; ++column) {
      const Vector2d centre(cell_.x() * (column + 0.5), cell_.y() * (row + 0.5));
      if ((centre - p).norm() > radius) continue;
      double& length = lengths_[row * columns + column];
      length = std::max(least_, factor * length);
    }
}

Points3 FacetSizes::metric(const Points2& pattern) const {
  Points3 metric(pattern.rows(), 3);
  for (int v = 0; v < pattern.rows(); ++v) {
    const double right = 1 / std::pow(divided_beyond * at(pattern.row(v)), 2);
    metric.row(v) << right, 0, right;
  }
  return metric;
}

void FacetSizes::archive(Serializer& a) {
  a(lengths_);
  a.require(lengths_.size() == std::size_t(columns) * columns &&
            std::all_of(lengths_.begin(), lengths_.end(),
                        [&](double length) { return length >= least_ && length < 1e3; }));
}

}  // namespace paperbake
