#include "formats/fold_peak.h"

#include <utility>

namespace paperbake {
namespace {

constexpr int most_texels = 512;  // on a side

/// Two neighbours along one axis of a grid and how much the second counts, at the place of texel i of a finer grid.
struct Between {
  int first, second;
  float weight;
};
Between between(int i, int fine, int coarse) {
  const double at = std::clamp((i + 0.5) * coarse / fine - 0.5, 0.0, coarse - 1.0);
  const int first = static_cast<int>(at);
  return {first, std::min(first + 1, coarse - 1), static_cast<float>(at - first)};
}

}  // namespace

FoldPeak::FoldPeak(const std::vector<std::vector<Vector2d>>& loops, double side, int size)
    : side_(side), rows_{std::min(size, most_texels), 0, std::min(size, most_texels)}, loops_(loops), peak_(rows_.count(), 0.0f) {
  for (auto& loop : loops_)
    for (Vector2d& p : loop) p = to_texels(p, side, rows_.size);
  wanted_ = wanted_texels(loops_, area_coverage(loops_, rows_), rows_);
}

void FoldPeak::record(const MapFields& fields, double fold_width) {
  for_each_texel(fields, side_, loops_, rows_, wanted_, [&](int index, const Fields& f) {
    const float angle = static_cast<float>(larger_principal(f[0], f[1], f[2]) * fold_width);
    if (std::abs(angle) > std::abs(peak_[index])) peak_[index] = angle;
  });
}

std::vector<float> FoldPeak::row(int row, int size) const {
  const int coarse = rows_.size;
  const Between y = between(row, size, coarse);
  // first down the columns of the memory, then along the row
  std::vector<float> sum(coarse), magnitude(coarse), peaks(size);
  for (int i = 0; i < coarse; ++i) {
    const float a = peak_[y.first * coarse + i], b = peak_[y.second * coarse + i];
    sum[i] = a + y.weight * (b - a);
    magnitude[i] = std::abs(a) + y.weight * (std::abs(b) - std::abs(a));
  }
  for (int i = 0; i < size; ++i) {
    const Between x = between(i, size, coarse);
    const float signed_sum = sum[x.first] + x.weight * (sum[x.second] - sum[x.first]);
    peaks[i] = std::copysign(magnitude[x.first] + x.weight * (magnitude[x.second] - magnitude[x.first]), signed_sum);
  }
  return peaks;
}

}  // namespace paperbake
