#include "formats/maps/fold_peak.h"

#include "formats/maps/fold_width.h"

namespace paperbake {
namespace {

constexpr int max_texels = 512;  // on a side of the grid
constexpr int band_rows = 32;

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

FoldPeak::FoldPeak(const std::vector<std::vector<Vector2d>>& loops, const FoldScale& scale,
                   int size)
    : scale_(scale),
      rows_{std::min(size, max_texels), 0, std::min(size, max_texels)},
      loops_(loops),
      bulge_(rows_.count() + TexelRow<3>::longest, 0.0f),
      hollow_(rows_.count() + TexelRow<3>::longest, 0.0f) {
  for (auto& loop : loops_)
    for (Vector2d& p : loop) p = to_texels(p, scale.side, rows_.size);
  for (int first = 0; first < rows_.size; first += band_rows) {
    const MapRows band{rows_.size, first, std::min(first + band_rows, rows_.size)};
    bands_.push_back({band, wanted_texels(loops_, area_coverage(loops_, band), band)});
  }
}

void FoldPeak::record(const MapFields& fields) {
  for (const Band& band : bands_) {
    // triangles come in any order, for which the processor would wait at every span
    constexpr int line = 16;  // numbers
    for (int k = 0; k < band.rows.count(); k += line) {
      __builtin_prefetch(&bulge_[rows_.index(k, band.rows.first)], 1);
      __builtin_prefetch(&hollow_[rows_.index(k, band.rows.first)], 1);
    }
    const auto take = [&](const TexelRow<3>& row) {
      const auto& f = row.fields;
      const int index = rows_.index(0, band.rows.first) + row.index;
      float *bulge = bulge_.data() + index, *hollow = hollow_.data() + index;
      // without a branch, so that the compiler computes several texels at once; what lies beyond
      // the last texel stays as it is
      for (int i = 0, padded = row.padded(); i < padded; ++i) {
        const float k1 = larger_principal(f[0][i], f[1][i], f[2][i]), k2 = f[0][i] + f[2][i] - k1,
                    up = i < row.texels ? std::max(k1, k2) : 0.0f,
                    down = i < row.texels ? -std::min(k1, k2) : 0.0f;
        bulge[i] = std::max(bulge[i], up);
        hollow[i] = std::max(hollow[i], down);
      }
    };
    for_each_sharp_texel(fields, scale_, band.rows,
                         [&](int i, int row, const SharpFold& fold, float covered) {
                           const int k = rows_.index(i, row);
                           const float turn = static_cast<float>(fold.angle) * covered;
                           if (!band.wanted[band.rows.index(i, row)]) return;
                           bulge_[k] = std::max(bulge_[k], turn);
                           hollow_[k] = std::max(hollow_[k], -turn);
                         });
    for_each_texel_row<of_fold, 3>(fields, scale_.side, loops_, band.rows, band.wanted, take);
  }
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
