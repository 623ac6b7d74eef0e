#include "formats/crease_map.h"

#include "core/error.h"
#include "formats/whole_file.h"

#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfFramesPerSecond.h>
#include <ImfHeader.h>
#include <ImfIntAttribute.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStdIO.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace paperbake {
namespace {

constexpr int memory_size = 256;  // texels on a side in which fold.peak is kept between maps
constexpr int padding = 4;        // [texel]
constexpr int block = 16;         // [texel] side of the squares that share one list of near apices

// Digits below what a render can show are noise to the compressor: rounding halves the time and quarters the file.
constexpr float angle_step = 1.0f / 16384;  // [rad] 0.0035 degrees
constexpr int zip_level = 2;                // level 4 takes a fifth longer to save a fifth of the size

float rounded(float value, float step) { return std::nearbyint(value / step) * step + 0.0f; }  // + 0: no negative zero

/// A point in texels: (i, j) is the centre of texel i of row j, row 0 at the top.
Vector2d to_texels(const Vector2d& pattern, double side, int size) {
  return {pattern.x() / side * size - 0.5, size - 0.5 - pattern.y() / side * size};
}

/// Where a row of texel centres cuts an edge, and the tensor there.
struct Cut {
  double x;
  Vector3d tensor;
};

struct Corner {
  Vector2d at;      // [texel]
  Vector3d tensor;  // [1/m]
};

bool row_cuts(const Vector2d& p, const Vector2d& q, int row) { return (p.y() <= row) != (q.y() <= row); }

/// The two triangles of an edge must find the very same cut, so it is always computed from its upper end.
Cut cut_edge(const Corner& p, const Corner& q, int row) {
  const bool p_first = p.at.y() < q.at.y();
  const Corner &a = p_first ? p : q, &b = p_first ? q : p;
  const double t = (row - a.at.y()) / (b.at.y() - a.at.y());
  return {a.at.x() + t * (b.at.x() - a.at.x()), a.tensor + t * (b.tensor - a.tensor)};
}

int first_at_or_after(double x, int size) { return static_cast<int>(std::ceil(std::clamp(x, 0.0, double(size)))); }

/// Calls texel(i, row, tensor) for every texel centre in the triangle. Spans are half open in both directions, so that
/// triangles with a common edge leave no gap between them and share no texel.
template <class Texel>
void rasterise(const Corner (&corner)[3], int size, const Texel& texel) {
  const auto [top, bottom] = std::minmax({corner[0].at.y(), corner[1].at.y(), corner[2].at.y()});
  for (int row = first_at_or_after(top, size); row < first_at_or_after(bottom, size); ++row) {
    Cut cut[2];
    int cuts = 0;
    for (int k = 0; k < 3; ++k) {
      const Corner &p = corner[k], &q = corner[(k + 1) % 3];
      if (row_cuts(p.at, q.at, row) && cuts < 2) cut[cuts++] = cut_edge(p, q, row);
    }
    if (cuts < 2) continue;
    if (cut[1].x < cut[0].x) std::swap(cut[0], cut[1]);
    const int end = first_at_or_after(cut[1].x, size);
    const Vector3d slope = (cut[1].tensor - cut[0].tensor) / std::max(cut[1].x - cut[0].x, 1e-300);
    for (int i = first_at_or_after(cut[0].x, size); i < end; ++i)
      texel(i, row, cut[0].tensor + (i - cut[0].x) * slope);
  }
}

/// Eigenvalue of larger magnitude of (Sxx, Sxy, Syy).
double larger_principal(const Vector3d& S) {
  const double mean = 0.5 * (S[0] + S[2]), half_difference = 0.5 * (S[0] - S[2]);
  const double radius = std::sqrt(half_difference * half_difference + S[1] * S[1]);
  return mean >= 0 ? mean + radius : mean - radius;
}

/// The x at which a row of texel centres cuts outline and holes, sorted: paper lies between the 1st and 2nd, 3rd and 4th...
std::vector<double> cuts_of_row(const std::vector<std::vector<Vector2d>>& loops, int row) {
  std::vector<double> cuts;
  for (const auto& loop : loops)
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Vector2d &p = loop[k], &q = loop[(k + 1) % loop.size()];
      if (row_cuts(p, q, row)) cuts.push_back(cut_edge({p, Vector3d::Zero()}, {q, Vector3d::Zero()}, row).x);
    }
  std::sort(cuts.begin(), cuts.end());
  return cuts;
}

/// A power of two, so that the last bits of a rounded number are zeros: 1/16 to 1/8 texel. [m]
float distance_step(double texel_size) { return static_cast<float>(std::exp2(std::floor(std::log2(texel_size / 8)))); }

/// The apices that can be the nearest one to a texel of the block around `centre` with half diagonal `reach`. [texel]
std::vector<Vector2d> near_apices(const std::vector<Vector2d>& apices, const Vector2d& centre, double reach) {
  double nearest = std::numeric_limits<double>::max();
  for (const Vector2d& a : apices) nearest = std::min(nearest, (a - centre).norm());
  std::vector<Vector2d> near;
  for (const Vector2d& a : apices)
    if ((a - centre).norm() <= nearest + 2 * reach) near.push_back(a);
  return near;
}

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

CreaseMap::CreaseMap(const Pattern& pattern, int size, double fold_width)
    : side_(longer_side(pattern)),
      diagonal_(extent(pattern).norm()),
      fold_width_(fold_width),
      fine_(make_grid(pattern, size)),
      coarse_(make_grid(pattern, std::min(size, memory_size))),
      peak_(coarse_.inside.size(), 0.0f) {}

void CreaseMap::record(const Sheet& sheet, const Points3& vertex_curvature) {
  assert(vertex_curvature.rows() == sheet.pattern.rows());
  if (!vertex_curvature.allFinite())
    throw Error(Fault::simulation, "crease map", "The curvature of the sheet is not a finite number.");
  last_.pattern = sheet.pattern;
  last_.triangles = sheet.triangles;
  last_.singular = sheet.singular;
  curvature_ = vertex_curvature;

  const Texels angle = fold_angle(coarse_);
  for (std::size_t t = 0; t < angle.size(); ++t)
    if (std::abs(angle[t]) > std::abs(peak_[t])) peak_[t] = angle[t];
}

void CreaseMap::write(const std::filesystem::path& path, const MapInfo& info) const {
  Texels angle = fold_angle(fine_), peak = fold_peak(angle), distance = apex_distance();
  for (Texels* channel : {&angle, &peak, &distance})
    for (const Copy& copy : fine_.padding) (*channel)[copy.to] = (*channel)[copy.from];
  // encoded in memory: the library's own file classes write the end of a file in destructors, which hide a full disk
  write_whole_file(path, encode(angle, peak, distance, info));
}

CreaseMap::Grid CreaseMap::make_grid(const Pattern& pattern, int size) {
  assert(size >= 1);
  std::vector<std::vector<Vector2d>> loops = pattern.holes;
  loops.push_back(pattern.outline);
  const double side = longer_side(pattern);
  for (auto& loop : loops)
    for (Vector2d& p : loop) p = to_texels(p, side, size);

  Grid grid{size, std::vector<char>(std::size_t(size) * size, 0), {}};
  for (int row = 0; row < size; ++row) {
    const std::vector<double> cuts = cuts_of_row(loops, row);
    for (std::size_t k = 0; k + 1 < cuts.size(); k += 2)
      for (int i = first_at_or_after(cuts[k], size); i < first_at_or_after(cuts[k + 1], size); ++i)
        grid.inside[std::size_t(row) * size + i] = 1;
  }
  std::vector<char> outside(grid.inside.size());
  std::transform(grid.inside.begin(), grid.inside.end(), outside.begin(), [](char in) { return char(!in); });
  grid.padding = copies_from_nearest(grid.inside, outside, size);
  return grid;
}

/// For every wanted texel that has covered ones within `padding`: the nearest of them.
std::vector<CreaseMap::Copy> CreaseMap::copies_from_nearest(const std::vector<char>& covered, const std::vector<char>& wanted,
                                                             int size) {
  const auto is_covered = [&](int i, int j) { return i < 0 || j < 0 || i >= size || j >= size || covered[j * size + i]; };
  std::vector<Copy> best(covered.size(), {-1, -1});
  std::vector<int> distance(covered.size(), padding * padding + 1);  // squared
  // the nearest covered texel always has an uncovered one beside it
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) {
      if (!covered[j * size + i] ||
          (is_covered(i - 1, j) && is_covered(i + 1, j) && is_covered(i, j - 1) && is_covered(i, j + 1)))
        continue;
      for (int y = std::max(0, j - padding); y <= std::min(size - 1, j + padding); ++y)
        for (int x = std::max(0, i - padding); x <= std::min(size - 1, i + padding); ++x) {
          const int t = y * size + x, d = (x - i) * (x - i) + (y - j) * (y - j);
          if (!wanted[t] || d >= distance[t]) continue;
          distance[t] = d;
          best[t] = {t, j * size + i};
        }
    }
  best.erase(std::remove_if(best.begin(), best.end(), [](const Copy& c) { return c.to < 0; }), best.end());
  return best;
}

CreaseMap::Texels CreaseMap::fold_angle(const Grid& grid) const {
  Texels angle(grid.inside.size(), 0.0f);
  std::vector<char> covered(grid.inside.size(), 0);
  for (Eigen::Index t = 0; t < last_.triangles.rows(); ++t) {
    Corner corner[3];
    for (int k = 0; k < 3; ++k) {
      const int v = last_.triangles(t, k);
      corner[k] = {to_texels(last_.pattern.row(v), side_, grid.size), curvature_.row(v)};
    }
    rasterise(corner, grid.size, [&](int i, int row, const Vector3d& tensor) {
      const std::size_t texel = std::size_t(row) * grid.size + i;
      if (!grid.inside[texel]) return;
      covered[texel] = 1;
      angle[texel] = rounded(static_cast<float>(larger_principal(tensor) * fold_width_), angle_step);
    });
  }

  // a mesh may cut the corners of a round outline: spread inwards-out, `padding` texels at a time, until nothing changes
  if (covered == grid.inside) return angle;
  while (true) {
    std::vector<char> wanted(covered.size());
    for (std::size_t t = 0; t < wanted.size(); ++t) wanted[t] = grid.inside[t] && !covered[t];
    const std::vector<Copy> copies = copies_from_nearest(covered, wanted, grid.size);
    if (copies.empty()) return angle;
    for (const Copy& copy : copies) angle[copy.to] = angle[copy.from], covered[copy.to] = 1;
  }
}

CreaseMap::Texels CreaseMap::fold_peak(Texels angle) const {
  Texels memory = peak_;
  for (const Copy& copy : coarse_.padding) memory[copy.to] = memory[copy.from];
  const int size = fine_.size, coarse = coarse_.size;
  std::vector<Between> columns;
  for (int i = 0; i < size; ++i) columns.push_back(between(i, size, coarse));

  Texels peak = std::move(angle);
  for (int j = 0; j < size; ++j) {
    const Between row = between(j, size, coarse);
    for (int i = 0; i < size; ++i) {
      const std::size_t t = std::size_t(j) * size + i;
      if (!fine_.inside[t]) continue;
      float sum = 0, magnitude = 0;
      for (const auto& [y, wy] : {std::pair(row.first, 1 - row.weight), std::pair(row.second, row.weight)})
        for (const auto& [x, wx] : {std::pair(columns[i].first, 1 - columns[i].weight), std::pair(columns[i].second, columns[i].weight)}) {
          sum += wx * wy * memory[y * coarse + x];
          magnitude += wx * wy * std::abs(memory[y * coarse + x]);
        }
      // the magnitude is continuous where the sign flips: a plain mean would draw a line of zero there
      if (magnitude > std::abs(peak[t])) peak[t] = rounded(std::copysign(magnitude, sum), angle_step);
    }
  }
  return peak;
}

CreaseMap::Texels CreaseMap::apex_distance() const {
  Texels distance(fine_.inside.size(), static_cast<float>(diagonal_));
  std::vector<Vector2d> apices;
  for (const SingularPoint& s : last_.singular) apices.push_back(to_texels(s.pattern, side_, fine_.size));
  if (apices.empty()) return distance;

  const int size = fine_.size;
  const double texel_size = side_ / size;
  const float step = distance_step(texel_size);
  for (int top = 0; top < size; top += block)
    for (int left = 0; left < size; left += block) {
      const Vector2d middle(left + 0.5 * (block - 1), top + 0.5 * (block - 1));
      const std::vector<Vector2d> near = near_apices(apices, middle, block * std::sqrt(0.5));
      for (int j = top; j < std::min(top + block, size); ++j)
        for (int i = left; i < std::min(left + block, size); ++i) {
          if (!fine_.inside[std::size_t(j) * size + i]) continue;
          double squared = std::numeric_limits<double>::max();
          for (const Vector2d& a : near) squared = std::min(squared, (a - Vector2d(i, j)).squaredNorm());
          distance[std::size_t(j) * size + i] = rounded(static_cast<float>(std::sqrt(squared) * texel_size), step);
        }
    }
  return distance;
}

std::string CreaseMap::encode(const Texels& angle, const Texels& peak, const Texels& distance, const MapInfo& info) const {
  Imf::Header header(fine_.size, fine_.size);
  header.compression() = Imf::ZIP_COMPRESSION;
  header.zipCompressionLevel() = zip_level;
  Imf::addFramesPerSecond(header, Imf::guessExactFps(info.fps));
  header.insert("frame", Imf::IntAttribute(info.frame));
  header.insert("seed", Imf::IntAttribute(static_cast<int>(info.seed)));
  header.insert("preset", Imf::StringAttribute(info.preset));
  header.insert("texelSize", Imf::FloatAttribute(static_cast<float>(side_ / fine_.size)));
  header.insert("foldWidth", Imf::FloatAttribute(static_cast<float>(fold_width_)));

  Imf::FrameBuffer frame_buffer;
  const auto add = [&](const char* name, const Texels& texels) {
    header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    char* base = reinterpret_cast<char*>(const_cast<float*>(texels.data()));  // the library only reads it
    frame_buffer.insert(name, Imf::Slice(Imf::FLOAT, base, sizeof(float), sizeof(float) * fine_.size));
  };
  add("fold.angle", angle);
  add("fold.peak", peak);
  add("apex.dist", distance);

  Imf::StdOSStream stream;
  {
    Imf::OutputFile file(stream, header);
    file.setFrameBuffer(frame_buffer);
    file.writePixels(fine_.size);
  }
  return stream.str();
}

}  // namespace paperbake
