#include "formats/maps/map_draw.h"

#include "core/geometry/hinges.h"
#include "formats/maps/fold_width.h"

#include <algorithm>
#include <limits>

namespace paperbake {
namespace {

// Layers are rounded: digits that no render can show are noise to the compressor. The steps are
// those that 16 bits have for the largest angle, and those of 8 bits over what a layer spans. With
// steps of 2^-12 rad, 2^-12 %, 2^-10 and 1/8 texel, a map of a crumple was 1.7 times as large.
constexpr float angle_step = 1.0f / 512;   // [rad] 0.11 degrees, that of HALF from 2 rad on
constexpr float strain_step = 1.0f / 128;  // [%] 0.008 %, a 256th of the 2 % at which paper tears
constexpr float unit_step = 1.0f / 256;    // [1] components of a direction: 0.2 degrees
constexpr float mask_step = 1.0f / 256;    // [1] R, G and B

// [rad] |k1| x longer side over which B rises from 0 to 1, as step 2 finds curved regions
constexpr float curved_range[2] = {0.18f, 0.3f};
// [1] |k2 / k1| over which B falls to 0, since the paper bends in both directions
constexpr float one_way_range[2] = {0.5f, 0.7f};
constexpr float isotropic = 0.02f;  // [1] |k1 - k2| / |k1| below which a bowl has no ruling
// [texel] how far age.crease reaches beyond R: a filtered lookup where R is drawn must not meet -1
constexpr double age_margin = 1.5;
// [texel] side of the blocks that share one list of near apices
constexpr int block = 16;

/// The nearest multiple of `step`; + 0 turns -0 into 0.
float rounded(float value, float step) { return std::nearbyint(value / step) * step + 0.0f; }

/// [m] 1/4 to 1/2 texel; a power of two, so that the last bits of a rounded number are zeros.
float distance_step(double texel_size) {
  return static_cast<float>(std::exp2(std::floor(std::log2(texel_size / 2))));
}

/// max(0, value), from which the compiler makes no branch.
float positive(float value) { return 0.5f * (value + std::abs(value)); }

float within_unit(float value) { return positive(value) - positive(value - 1); }

/// [%] stretch - 1 for a principal Green strain: sqrt(1 + 2 green) - 1, of which small strains lose
/// no digits.
float percent(float green) {
  const float possible = std::max(green, -0.5f);
  return 200 * possible / (std::sqrt(1 + 2 * possible) + 1);
}

/// Sets the layers that depend only on the shape of the sheet at the texels: for all of them side
/// by side, without a branch, so that the compiler computes several at once.
void draw_shape(const MapScene& scene, const TexelRow<12>& row, MapTexel* texels) {
  float angle[row.longest], plastic[row.longest], bent_one_way[row.longest], dir_x[row.longest],
      dir_y[row.longest], strain_min[row.longest], strain_max[row.longest];
  constexpr float tiny = 1e-30f;  // keeps from a division by zero where there is no ruling
  const auto side = static_cast<float>(scene.side);
  const auto& f = row.fields;
  const int padded = row.padded();
  for (int i = 0; i < padded; ++i) {
    angle[i] = rounded(larger_principal(f[3][i], f[4][i], f[5][i]), angle_step);
    plastic[i] = rounded(larger_principal(f[6][i], f[7][i], f[8][i]), angle_step);
  }
  for (int i = 0; i < padded; ++i) {
    const float xx = f[0][i], xy = f[1][i], yy = f[2][i], half_difference = 0.5f * (xx - yy),
                radius = std::sqrt(half_difference * half_difference + xy * xy),
                k1 = larger_principal(xx, xy, yy), k2 = xx + yy - k1, bent = std::abs(k1) * side;
    const float ruled =
        (bent > curved_range[0]) & (std::abs(k1 - k2) > isotropic * std::abs(k1)) ? 1.0f : 0.0f;
    const float ratio = std::abs(k2) / (std::abs(k1) + tiny),
                coherent = (one_way_range[1] - ratio) / (one_way_range[1] - one_way_range[0]);
    bent_one_way[i] =
        ruled *
        rounded(within_unit((bent - curved_range[0]) / (curved_range[1] - curved_range[0])) *
                    within_unit(coherent),
                mask_step);
    // the eigenvector of the larger eigenvalue is at angle phi, that of the smaller one across it;
    // the sheet bends along that of larger magnitude, and the ruling runs across, with x >= 0
    const float sign = -std::copysign(1.0f, xx + yy + 0.0f),
                c = sign * half_difference / (radius + tiny), s = sign * xy / (radius + tiny);
    dir_x[i] = ruled * rounded(std::sqrt(positive(0.5f * (1 + c))), unit_step);
    // + 0 turns -0 into 0
    dir_y[i] =
        ruled * rounded(std::copysign(std::sqrt(positive(0.5f * (1 - c))), s), unit_step) + 0.0f;
  }
  for (int i = 0; i < padded; ++i) {
    const float mean = 0.5f * (f[9][i] + f[11][i]), half_difference = 0.5f * (f[9][i] - f[11][i]),
                radius = std::sqrt(half_difference * half_difference + f[10][i] * f[10][i]);
    strain_min[i] = rounded(percent(mean - radius), strain_step);
    strain_max[i] = rounded(percent(mean + radius), strain_step);
  }
  for (int i = 0; i < row.texels; ++i) {
    if (!row.wanted[i]) continue;
    MapTexel& texel = texels[row.index + i];
    texel.fold_angle = angle[i];
    texel.fold_plastic = plastic[i];
    texel.b = bent_one_way[i];
    texel.dir_x = dir_x[i];
    texel.dir_y = dir_y[i];
    texel.strain_min = strain_min[i];
    texel.strain_max = strain_max[i];
  }
}

/// Draws the creases of this frame into fold.angle and fold.plastic: on one fold width.
void draw_sharp_folds(const MapScene& scene, const MapRows& rows, const std::vector<char>& wanted,
                      MapTexel* texels) {
  for_each_sharp_texel(scene.fields, {scene.side, scene.fold_width}, rows,
                       [&](int i, int row, const SharpFold& fold, float covered) {
                         if (!wanted[rows.index(i, row)]) return;
                         MapTexel& texel = texels[rows.index(i, row)];
                         const auto drawn = [&](double turn) {
                           return rounded(static_cast<float>(turn) * covered, angle_step);
                         };
                         texel.fold_angle = larger_turn<float>(texel.fold_angle, drawn(fold.angle));
                         texel.fold_plastic =
                             larger_turn<float>(texel.fold_plastic, drawn(fold.plastic));
                       });
}

/// Sets fold.peak: interpolated on the grid of FoldPeak, or fold.angle where that is larger now.
void draw_peaks(const MapScene& scene, const MapRows& rows, const std::vector<char>& wanted,
                MapTexel* texels) {
  const std::vector<float> peaks = scene.peak->peaks(rows);
  for (int k = 0; k < rows.count(); ++k) {
    if (!wanted[k]) continue;
    MapTexel& texel = texels[k];
    const float peak = rounded(peaks[k], angle_step), now = texel.fold_angle;
    texel.fold_peak = std::abs(peak) > std::abs(now) ? peak : now;
  }
}

void draw_creases(const MapScene& scene, const MapRows& rows, const std::vector<char>& wanted,
                  MapTexel* texels) {
  const double texel_size = scene.side / rows.size,
               radius = std::max(min_line_radius, 0.5 * scene.crease_width / texel_size);
  for (const DetectedCrease& crease : scene.creases) {
    Vector2d from = to_texels(crease.from, scene.side, rows.size),
             to = to_texels(crease.to, scene.side, rows.size);
    // a crease that ends on the border continues in the padding
    const Vector2d beyond = (map_padding + 1) * (to - from).normalized();
    if (crease.from_border) from -= beyond;
    if (crease.to_border) to += beyond;
    const float age = static_cast<float>((scene.frame - crease.frame_of_birth) / scene.fps);
    for_each_near_segment(
        from, to, radius + 0.5 + age_margin, rows, [&](int i, int row, double distance, double) {
          if (!wanted[rows.index(i, row)]) return;
          MapTexel& texel = texels[rows.index(i, row)];
          const float strength =
              rounded(static_cast<float>(crease.strength * cover(radius, distance)), mask_step);
          if (strength > texel.r) texel.r = strength;
          if (age > texel.age_crease) texel.age_crease = age;
        });
  }
}

/// For the texels of a block, which of the points is nearest, and its squared distance. [texel2]
struct NearestPoints {
  double squared[block][block];  // of a row, of a column
  double nearest[block][block];  // indices; in the type of the distances, to choose both at once

  NearestPoints(const std::vector<Vector2d>& points, const std::vector<int>& near, int left,
                int top) {
    for (auto& row : squared) std::fill(std::begin(row), std::end(row), far);
    for (auto& row : nearest) std::fill(std::begin(row), std::end(row), 0.0);
    for (const int k : near) {
      double across[block], down[block];
      for (int i = 0; i < block; ++i) {
        const Vector2d way = points[k] - Vector2d(left + i, top + i);
        across[i] = way.x() * way.x();
        down[i] = way.y() * way.y();
      }
      for (int row = 0; row < block; ++row)
        for (int i = 0; i < block; ++i) {
          const double d = across[i] + down[row];
          const bool nearer = d < squared[row][i];
          squared[row][i] = nearer ? d : squared[row][i];
          nearest[row][i] = nearer ? double(k) : nearest[row][i];
        }
    }
  }

 private:
  static constexpr double far = std::numeric_limits<double>::max();
};

bool any_wanted(const std::vector<char>& wanted, const MapRows& rows, int left, int top) {
  for (int row = top; row < std::min(top + block, rows.last); ++row)
    for (int i = left; i < std::min(left + block, rows.size); ++i)
      if (wanted[rows.index(i, row)]) return true;
  return false;
}

/// What all texels have whose nearest singular point is this one.
struct ApexLayers {
  float cone, age;
};

void draw_apices(const MapScene& scene, const MapRows& rows, const std::vector<char>& wanted,
                 MapTexel* texels) {
  if (scene.apices.empty()) return;
  const double texel_size = scene.side / rows.size,
               radius = std::max(min_line_radius, scene.crease_width / texel_size);
  const float step = distance_step(texel_size);
  std::vector<Vector2d> at;
  std::vector<ApexLayers> of_apex;
  for (const MapApex& apex : scene.apices) {
    at.push_back(to_texels(apex.pattern, scene.side, rows.size));
    of_apex.push_back({rounded(static_cast<float>(apex.turn), angle_step),
                       static_cast<float>((scene.frame - apex.frame_of_birth) / scene.fps)});
  }
  for (int top = rows.first; top < rows.last; top += block)
    for (int left = 0; left < rows.size; left += block) {
      if (!any_wanted(wanted, rows, left, top)) continue;
      const std::vector<int> near = near_points(
          at, Vector2d(left, top) + Vector2d::Constant(0.5 * (block - 1)), block * std::sqrt(0.5));
      const NearestPoints points(at, near, left, top);
      for (int row = top; row < std::min(top + block, rows.last); ++row)
        for (int i = left; i < std::min(left + block, rows.size); ++i) {
          if (!wanted[rows.index(i, row)]) continue;
          const int nearest = static_cast<int>(points.nearest[row - top][i - left]);
          const double distance = std::sqrt(points.squared[row - top][i - left]);
          MapTexel& texel = texels[rows.index(i, row)];
          texel.g = rounded(static_cast<float>(cover(radius, distance)), mask_step);
          texel.apex_dist = rounded(static_cast<float>(distance * texel_size), step);
          texel.apex_id = nearest + 1;
          texel.apex_cone = of_apex[nearest].cone;
          texel.age_apex = of_apex[nearest].age;
        }
    }
}

}  // namespace

std::vector<MapApex> map_apices(const Sheet& sheet) {
  std::vector<MapApex> apices;
  std::vector<int> vertex;
  for (const SingularPoint& point : sheet.singular) {
    apices.push_back({point.pattern, point.frame_of_birth, 0});
    Eigen::Index nearest;
    (sheet.pattern.rowwise() - point.pattern.transpose())
        .rowwise()
        .squaredNorm()
        .minCoeff(&nearest);
    vertex.push_back(static_cast<int>(nearest));
  }
  if (apices.empty()) return apices;
  std::vector<double> turn(sheet.pattern.rows(), 0.0);
  for (const Hinge& hinge : find_hinges(sheet.triangles).hinges)
    for (const int end : {0, 1})
      turn[hinge.vertices[end]] += std::abs(dihedral_angle(sheet.x, hinge));
  for (std::size_t k = 0; k < apices.size(); ++k) apices[k].turn = turn[vertex[k]];
  return apices;
}

void draw_map(const MapScene& scene, const MapRows& rows, MapTexel* texels) {
  const std::vector<float> coverage = area_coverage(scene.loops, rows);
  const std::vector<char> wanted = wanted_texels(scene.loops, coverage, rows);
  MapTexel blank;
  blank.apex_dist = static_cast<float>(scene.diagonal);
  for (int k = 0; k < rows.count(); ++k) {
    texels[k] = blank;
    texels[k].a = coverage[k];
  }
  if (std::find(wanted.begin(), wanted.end(), 1) == wanted.end()) return;
  for_each_texel_row<0, 12>(scene.fields, scene.side, scene.loops, rows, wanted,
                            [&](const TexelRow<12>& row) { draw_shape(scene, row, texels); });
  draw_sharp_folds(scene, rows, wanted, texels);
  draw_peaks(scene, rows, wanted, texels);
  draw_creases(scene, rows, wanted, texels);
  draw_apices(scene, rows, wanted, texels);
}

}  // namespace paperbake
