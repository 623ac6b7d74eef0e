#include "formats/maps/map_file.h"

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
#include <ImfThreading.h>
#include <ImfTiledOutputFile.h>

#include <algorithm>
#include <cstddef>
#include <future>

namespace paperbake {
namespace {

constexpr int zip_level = 1;    // level 2 takes 10 % longer and makes the file 1 % smaller
constexpr int strip_rows = 64;  // a multiple of the 16 rows of a ZIP block
constexpr int tile = 64;        // [texel]

struct Layer {
  const char* name;
  Imf::PixelType type;
  std::size_t offset;
};
constexpr Layer layers[] = {
    {"R", Imf::HALF, offsetof(MapTexel, r)},
    {"G", Imf::HALF, offsetof(MapTexel, g)},
    {"B", Imf::HALF, offsetof(MapTexel, b)},
    {"A", Imf::HALF, offsetof(MapTexel, a)},
    {"fold.angle", Imf::FLOAT, offsetof(MapTexel, dihedral_angle)},
    {"fold.plastic", Imf::FLOAT, offsetof(MapTexel, fold_plastic)},
    {"fold.peak", Imf::FLOAT, offsetof(MapTexel, fold_peak)},
    {"age.crease", Imf::FLOAT, offsetof(MapTexel, age_crease)},
    {"age.apex", Imf::FLOAT, offsetof(MapTexel, age_apex)},
    {"apex.dist", Imf::FLOAT, offsetof(MapTexel, apex_dist)},
    {"apex.cone", Imf::FLOAT, offsetof(MapTexel, apex_cone)},
    {"apex.id", Imf::UINT, offsetof(MapTexel, apex_id)},
    {"dir.x", Imf::FLOAT, offsetof(MapTexel, dir_x)},
    {"dir.y", Imf::FLOAT, offsetof(MapTexel, dir_y)},
    {"strain.min", Imf::FLOAT, offsetof(MapTexel, strain_min)},
    {"strain.max", Imf::FLOAT, offsetof(MapTexel, strain_max)},
};

Imf::Header header_of(int size, const MapInfo& info, const MapScale& scale) {
  Imf::Header header(size, size);
  header.compression() = Imf::ZIP_COMPRESSION;
  header.zipCompressionLevel() = zip_level;
  Imf::addFramesPerSecond(header, Imf::guessExactFps(info.fps));
  header.insert("frame", Imf::IntAttribute(info.frame));
  header.insert("seed", Imf::IntAttribute(static_cast<int>(info.seed)));
  header.insert("preset", Imf::StringAttribute(info.preset));
  header.insert("texelSize", Imf::FloatAttribute(static_cast<float>(scale.texel)));
  header.insert("foldWidth", Imf::FloatAttribute(static_cast<float>(scale.fold_width)));
  header.insert("creaseWidth", Imf::FloatAttribute(static_cast<float>(scale.crease_width)));
  for (const Layer& layer : layers) header.channels().insert(layer.name, Imf::Channel(layer.type));
  return header;
}

/// Describes to OpenEXR the texels of an image whose first row in memory is `first_row`.
Imf::FrameBuffer frame_buffer(const MapTexel* texels, int size, int first_row) {
  Imf::FrameBuffer buffer;
  const std::ptrdiff_t row = sizeof(MapTexel) * std::ptrdiff_t(size);
  for (const Layer& layer : layers) {
    // OpenEXR only reads it
    char* base =
        const_cast<char*>(reinterpret_cast<const char*>(texels)) + layer.offset - first_row * row;
    buffer.insert(layer.name, Imf::Slice(layer.type, base, sizeof(MapTexel), row));
  }
  return buffer;
}

/// Draws some rows, each strip of them on a thread of its own.
void draw_rows(const DrawRows& draw, const MapRows& rows, MapTexel* texels) {
  std::vector<std::future<void>> others;
  for (int first = rows.first; first < rows.last; first += strip_rows) {
    const MapRows strip{rows.size, first, std::min(first + strip_rows, rows.last)};
    MapTexel* target = texels + std::size_t(first - rows.first) * rows.size;
    if (strip.last == rows.last)
      draw(strip, target);
    else
      others.push_back(
          std::async(std::launch::async, [&draw, strip, target] { draw(strip, target); }));
  }
  for (auto& other : others) other.get();
}

/// Draws a map from the top in batches of as many strips as there are threads, and calls
/// take(rows, texels) for each. keep: `texels` receives the whole map, else only the current batch.
template <class Take>
void draw_in_batches(int size, int threads, const DrawRows& draw, std::vector<MapTexel>& texels,
                     bool keep, const Take& take) {
  const int batch = strip_rows * std::max(1, threads);
  texels.resize(std::size_t(size) * (keep ? size : std::min(batch, size)));
  for (int first = 0; first < size; first += batch) {
    const MapRows rows{size, first, std::min(first + batch, size)};
    MapTexel* target = texels.data() + (keep ? std::size_t(first) * size : 0);
    draw_rows(draw, rows, target);
    take(rows, target);
  }
}

/// The texels that texel i of the next level covers along one axis, and the part of each.
struct Footprint {
  int first, count, nearest;
  double share[3];
};
Footprint footprint(int i, int size, int next) {
  const double from = double(i) * size / next, to = double(i + 1) * size / next;
  Footprint f{static_cast<int>(from),
              0,
              std::min(size - 1, static_cast<int>(0.5 * (from + to))),
              {0, 0, 0}};
  for (int k = f.first; k < std::min(size, static_cast<int>(std::ceil(to - 1e-9))) && f.count < 3;
       ++k)
    f.share[f.count++] = std::min(to, k + 1.0) - std::max(from, double(k));
  return f;
}

constexpr float MapTexel::*averaged[] = {&MapTexel::dihedral_angle, &MapTexel::fold_plastic,
                                         &MapTexel::fold_peak,      &MapTexel::apex_dist,
                                         &MapTexel::strain_min,     &MapTexel::strain_max};

MapTexel mean_of(const std::vector<MapTexel>& texels, int size, const Footprint& column,
                 const Footprint& row) {
  MapTexel mean = texels[std::size_t(row.nearest) * size + column.nearest];
  const bool centre_covered = mean.a > 0;
  double all = 0, covered = 0, creased = 0, r = 0, g = 0, b = 0, age = 0, cos2 = 0, sin2 = 0,
         sum[std::size(averaged)] = {}, best = 0;
  for (int y = 0; y < row.count; ++y)
    for (int x = 0; x < column.count; ++x) {
      const MapTexel& t = texels[std::size_t(row.first + y) * size + column.first + x];
      const double area = row.share[y] * column.share[x], weight = area * t.a;
      all += area;
      if (weight <= 0) continue;
      covered += weight;
      r += weight * t.r;
      g += weight * t.g;
      b += weight * t.b;
      for (std::size_t k = 0; k < std::size(averaged); ++k) sum[k] += weight * t.*averaged[k];
      cos2 += weight * (t.dir_x * t.dir_x - t.dir_y * t.dir_y);
      sin2 += weight * 2 * t.dir_x * t.dir_y;
      if (t.age_crease >= 0) {
        creased += weight;
        age += weight * t.age_crease;
      }
      if (!centre_covered && weight > best) {
        best = weight;
        mean.apex_id = t.apex_id;
        mean.apex_cone = t.apex_cone;
        mean.age_apex = t.age_apex;
      }
    }
  if (covered <= 0) return mean;
  mean.a = static_cast<float>(covered / all);
  mean.r = static_cast<float>(r / covered);
  mean.g = static_cast<float>(g / covered);
  mean.b = static_cast<float>(b / covered);
  for (std::size_t k = 0; k < std::size(averaged); ++k)
    mean.*averaged[k] = static_cast<float>(sum[k] / covered);
  mean.age_crease = creased > 0 ? static_cast<float>(age / creased) : -1.0f;
  const double length = std::hypot(cos2, sin2), c = length > 0 ? cos2 / length : 0;
  const bool directed = length > 1e-3 * covered;
  mean.dir_x = directed ? static_cast<float>(std::sqrt(0.5 * (1 + c))) : 0.0f;
  mean.dir_y = directed ? static_cast<float>(std::copysign(std::sqrt(0.5 * (1 - c)), sin2)) : 0.0f;
  return mean;
}

/// Indices of a texel beside the pattern and of the texel of the pattern that it copies.
struct Padding {
  std::size_t texel, source;
};
std::vector<Padding> paddings(const std::vector<MapTexel>& level, int size, int first, int last) {
  constexpr int around[8][2] = {{1, 0}, {-1, 0}, {0, 1},  {0, -1},
                                {1, 1}, {-1, 1}, {1, -1}, {-1, -1}};
  std::vector<Padding> found;
  for (int j = first; j < last; ++j)
    for (int i = 0; i < size; ++i) {
      const std::size_t texel = std::size_t(j) * size + i;
      if (level[texel].a > 0) continue;
      for (const auto& [x, y] : around) {
        if (i + x < 0 || j + y < 0 || i + x >= size || j + y >= size) continue;
        const std::size_t source = std::size_t(j + y) * size + i + x;
        if (!(level[source].a > 0)) continue;
        found.push_back({texel, source});
        break;
      }
    }
  return found;
}

/// Divides the rows of a level among threads and calls rows(part, first, last) on each.
template <class Rows>
void for_row_ranges(int size, int threads, const Rows& rows) {
  std::vector<std::future<void>> others;
  for (int part = 1; part < threads; ++part)
    others.push_back(std::async(std::launch::async, [&rows, part, size, threads] {
      rows(part, size * part / threads, size * (part + 1) / threads);
    }));
  rows(0, 0, size / threads);
  for (auto& other : others) other.get();
}

}  // namespace

std::vector<MapTexel> next_level(const std::vector<MapTexel>& texels, int size, int threads) {
  const int next = std::max(1, size / 2);
  // small levels take less time than starting a thread
  threads = std::clamp(next / strip_rows, 1, threads);
  std::vector<Footprint> columns;
  for (int i = 0; i < next; ++i) columns.push_back(footprint(i, size, next));
  std::vector<MapTexel> level(std::size_t(next) * next);
  for_row_ranges(next, threads, [&](int, int first, int last) {
    for (int j = first; j < last; ++j)
      for (int i = 0; i < next; ++i)
        level[std::size_t(j) * next + i] = mean_of(texels, size, columns[i], columns[j]);
  });
  // texels beside the pattern copy it, so that a lookup at its border reads paper on every level
  std::vector<std::vector<Padding>> padding(threads);
  for_row_ranges(next, threads, [&](int part, int first, int last) {
    padding[part] = paddings(level, next, first, last);
  });
  for (const auto& part : padding)
    for (const Padding& p : part) {
      level[p.texel] = level[p.source];
      level[p.texel].a = 0.0f;
    }
  return level;
}

std::string encode_map(int size, MapLayout layout, const MapInfo& info, const MapScale& scale,
                       int threads, const DrawRows& draw) {
  const int helpers = threads > 1 ? threads : 0;
  if (Imf::globalThreadCount() != helpers) Imf::setGlobalThreadCount(helpers);
  Imf::Header header = header_of(size, info, scale);
  // encoded in memory: OpenEXR's file classes write the end of a file in destructors, which cannot
  // report a full disk
  Imf::StdOSStream stream;
  std::vector<MapTexel> texels;
  if (layout == MapLayout::scanline) {
    Imf::OutputFile file(stream, header, helpers);
    draw_in_batches(size, threads, draw, texels, false,
                    [&](const MapRows& rows, const MapTexel* drawn) {
                      file.setFrameBuffer(frame_buffer(drawn, size, rows.first));
                      file.writePixels(rows.last - rows.first);
                    });
  } else {
    header.setTileDescription(
        Imf::TileDescription(tile, tile, Imf::MIPMAP_LEVELS, Imf::ROUND_DOWN));
    Imf::TiledOutputFile file(stream, header, helpers);
    draw_in_batches(size, threads, draw, texels, true, [](const MapRows&, const MapTexel*) {});
    for (int level = 0, side = size; level < file.numLevels(); ++level) {
      file.setFrameBuffer(frame_buffer(texels.data(), side, 0));
      file.writeTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
      if (side > 1) texels = next_level(texels, side, threads);
      side = std::max(1, side / 2);
    }
  }
  return stream.str();
}

}  // namespace paperbake
