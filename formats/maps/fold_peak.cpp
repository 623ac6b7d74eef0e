#include "formats/maps/fold_peak.h"

#include "formats/maps/fold_width.h"

namespace paperbake {
namespace {

constexpr int max_texels = 512;  // on a side of the grid

/// For linear interpolation along one axis: the two texels of the grid around texel i of a finer
/// grid, and the weight of the second.
struct GridNeighbours {
  int first, second;
  float weight;
};
GridNeighbours grid_neighbours(int i, int fine, int coarse) {
  const double at = std::clamp((i + 0.5) * coarse / fine - 0.5, 0.0, coarse - 1.0);
  const int first = static_cast<int>(at);
  return {first, std::min(first + 1, coarse - 1), static_cast<float>(at - first)};
}

}  // namespace

FoldPeak::FoldPeak(const std::vector<std::vector<Vector2d>>& loops, double side, int size)
    : side_(side),
      rows_{std::min(size, max_texels), 0, std::min(size, max_texels)},
      loops_(loops),
      bulge_(rows_.count(), 0.0f),
      hollow_(rows_.count(), 0.0f) {
  for (auto& loop : loops_)
    for (Vector2d& p : loop) p = to_texels(p, side, rows_.size);
  wanted_ = wanted_texels(loops_, area_coverage(loops_, rows_), rows_);
}

void FoldPeak::record(const MapFields& fields) {
  for_each_texel_row<of_fold, 3>(
      fields, side_, loops_, rows_, wanted_, [&](const TexelRow<3>& row) {
        const auto& f = row.fields;
        float bulge[row.longest], hollow[row.longest];
        // without a branch, so that the compiler computes several texels at once
        for (int i = 0, texels = row.texels; i < texels; ++i) {
          const float k1 = larger_principal(f[0][i], f[1][i], f[2][i]), k2 = f[0][i] + f[2][i] - k1;
          bulge[i] = std::max(k1, k2);
          hollow[i] = -std::min(k1, k2);
        }
        float *peak = bulge_.data() + row.index, *low = hollow_.data() + row.index;
        for (int i = 0, texels = row.texels; i < texels; ++i) {
          const float up = row.wanted[i] ? bulge[i] : 0, down = row.wanted[i] ? hollow[i] : 0;
          peak[i] = peak[i] < up ? up : peak[i];
          low[i] = low[i] < down ? down : low[i];
        }
      });
}

std::vector<float> FoldPeak::peaks(const MapRows& rows) const {
  const int coarse = rows_.size;
  std::vector<GridNeighbours> columns;
  for (int i = 0; i < rows.size; ++i) columns.push_back(grid_neighbours(i, rows.size, coarse));
  std::vector<float> bulge(coarse), hollow(coarse), peaks(rows.count());
  for (int row = rows.first; row < rows.last; ++row) {
    // bilinear: first down the columns of the grid, then along the row
    const GridNeighbours y = grid_neighbours(row, rows.size, coarse);
    const auto down = [&](const std::vector<float>& grid, int i) {
      const float a = grid[y.first * coarse + i], b = grid[y.second * coarse + i];
      return a + y.weight * (b - a);
    };
    for (int i = 0; i < coarse; ++i) {
      bulge[i] = down(bulge_, i);
      hollow[i] = down(hollow_, i);
    }
    for (int i = 0; i < rows.size; ++i) {
      const GridNeighbours& x = columns[i];
      const auto along = [&](const std::vector<float>& v) {
        return v[x.first] + x.weight * (v[x.second] - v[x.first]);
      };
      const float up = along(bulge), down = along(hollow);
      peaks[rows.index(i, row)] = up >= down ? up : -down;
    }
  }
  return peaks;
}

}  // namespace paperbake
