#include "formats/maps/map_file.h"

#include "core/model/error.h"
#include "formats/files/zlib_stream.h"

#include <ImfFramesPerSecond.h>
#include <openexr.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <future>
#include <utility>

namespace paperbake {
namespace {

constexpr int block_rows = 16;  // that are compressed together
constexpr int strip_rows = 16;  // a multiple of block_rows: half a megabyte of texels
constexpr int tile = 64;        // [texel]

/// The layers in the order of the file, which is that of their names.
struct Layer {
  const char* name;
  exr_pixel_type_t type;  // in the file
  std::size_t offset;
};
constexpr Layer layers[] = {
    {"A", EXR_PIXEL_HALF, offsetof(MapTexel, a)},
    {"B", EXR_PIXEL_HALF, offsetof(MapTexel, b)},
    {"G", EXR_PIXEL_HALF, offsetof(MapTexel, g)},
    {"R", EXR_PIXEL_HALF, offsetof(MapTexel, r)},
    {"age.apex", EXR_PIXEL_HALF, offsetof(MapTexel, age_apex)},
    {"age.crease", EXR_PIXEL_HALF, offsetof(MapTexel, age_crease)},
    {"apex.cone", EXR_PIXEL_HALF, offsetof(MapTexel, apex_cone)},
    {"apex.dist", EXR_PIXEL_HALF, offsetof(MapTexel, apex_dist)},
    {"apex.id", EXR_PIXEL_UINT, offsetof(MapTexel, apex_id)},
    {"dir.x", EXR_PIXEL_HALF, offsetof(MapTexel, dir_x)},
    {"dir.y", EXR_PIXEL_HALF, offsetof(MapTexel, dir_y)},
    {"fold.angle", EXR_PIXEL_HALF, offsetof(MapTexel, fold_angle)},
    {"fold.peak", EXR_PIXEL_HALF, offsetof(MapTexel, fold_peak)},
    {"fold.plastic", EXR_PIXEL_HALF, offsetof(MapTexel, fold_plastic)},
    {"strain.max", EXR_PIXEL_HALF, offsetof(MapTexel, strain_max)},
    {"strain.min", EXR_PIXEL_HALF, offsetof(MapTexel, strain_min)},
};

constexpr std::size_t bytes_of(const Layer& layer) {
  return layer.type == EXR_PIXEL_HALF ? sizeof(half) : sizeof(float);
}
constexpr std::size_t bytes_of_texel() {
  std::size_t sum = 0;
  for (const Layer& layer : layers) sum += bytes_of(layer);
  return sum;
}

/// Some texels of an image in memory.
struct Window {
  const MapTexel* first;
  std::ptrdiff_t row;  // [texels] from one row to the next
  int width, height;
};

/// Packs chunks with ZIP compression, the texels as OpenEXR orders them: row by row, each layer by
/// layer; of these bytes the even ones before the odd ones; each as its difference to the one
/// before; as a zlib stream.
class ChunkPacker {
 public:
  std::string operator()(const Window&);

 private:
  void gather(const Window&);
  std::string in_order() const;
  std::vector<std::uint8_t> halves_;  // the even bytes, then the odd ones
  std::vector<std::uint8_t> before_;  // of the chunk before, and what it was packed as
  std::string packed_;
  std::vector<std::uint8_t> steps_;
  ZlibPacker zlib_;
};

constexpr int in_cache = 128;  // texels of a row that are taken apart at once

/// Takes the bytes of one layer of some texels apart.
template <class Bits>
void split_layer(const char* texel, int count, std::uint8_t* even, std::uint8_t* odd) {
  Bits stored[in_cache];
  for (int i = 0; i < count; ++i, texel += sizeof(MapTexel))
    std::memcpy(&stored[i], texel, sizeof(Bits));
  for (int i = 0; i < count; ++i) {
    const Bits v = stored[i];
    if constexpr (sizeof(Bits) == 2) {
      even[i] = static_cast<std::uint8_t>(v);
      odd[i] = static_cast<std::uint8_t>(v >> 8);
    } else {
      const auto evens = static_cast<std::uint16_t>((v & 0xff) | (v >> 8 & 0xff00)),
                 odds = static_cast<std::uint16_t>((v >> 8 & 0xff) | (v >> 16 & 0xff00));
      std::memcpy(even + 2 * i, &evens, sizeof evens);
      std::memcpy(odd + 2 * i, &odds, sizeof odds);
    }
  }
}

void ChunkPacker::gather(const Window& window) {
  const std::size_t middle = bytes_of_texel() * window.width * window.height / 2;
  halves_.resize(2 * middle);
  for (int j = 0; j < window.height; ++j)
    for (int begin = 0; begin < window.width; begin += in_cache) {
      const char* texels = reinterpret_cast<const char*>(window.first + j * window.row + begin);
      const int count = std::min(in_cache, window.width - begin);
      std::size_t layer_at = bytes_of_texel() / 2 * window.width * j;
      for (const Layer& layer : layers) {
        std::uint8_t* even = halves_.data() + layer_at + bytes_of(layer) / 2 * begin;
        const auto split =
            layer.type == EXR_PIXEL_HALF ? split_layer<std::uint16_t> : split_layer<std::uint32_t>;
        split(texels + layer.offset, count, even, even + middle);
        layer_at += bytes_of(layer) / 2 * window.width;
      }
    }
}

/// The bytes before they were taken apart.
std::string ChunkPacker::in_order() const {
  std::string raw(halves_.size(), '\0');
  for (std::size_t i = 0, middle = raw.size() / 2; i < middle; ++i) {
    raw[2 * i] = static_cast<char>(halves_[i]);
    raw[2 * i + 1] = static_cast<char>(halves_[middle + i]);
  }
  return raw;
}

std::string ChunkPacker::operator()(const Window& window) {
  halves_.swap(before_);
  gather(window);
  if (halves_ == before_) return packed_;  // beside the pattern
  const std::size_t count = halves_.size();
  steps_.resize(count);
  const std::uint8_t* byte = halves_.data();
  std::uint8_t* step = steps_.data();
  step[0] = byte[0];
  for (std::size_t i = 1; i < count; ++i)
    step[i] = static_cast<std::uint8_t>(byte[i] - byte[i - 1] + 128);
  const std::string_view stream = zlib_(reinterpret_cast<const char*>(steps_.data()), count);
  // as the bytes are where a stream would not be shorter
  packed_ = stream.size() < count ? std::string(stream) : in_order();
  return packed_;
}

/// An OpenEXR file in memory: written to a file, the end of it would be written by a function that
/// cannot report a full disk.
class ExrFile {
 public:
  ExrFile(int size, MapLayout layout, const MapInfo& info, const MapScale& scale) {
    exr_context_initializer_t with = EXR_DEFAULT_CONTEXT_INITIALIZER;
    with.user_data = &bytes_;
    with.write_fn = write;
    with.error_handler_fn = [](exr_const_context_t, exr_result_t, const char*) {};
    check(exr_start_write(&file_, "map", EXR_WRITE_FILE_DIRECTLY, &with));
    int part = 0;
    check(exr_add_part(file_, nullptr,
                       layout == MapLayout::scanline ? EXR_STORAGE_SCANLINE : EXR_STORAGE_TILED,
                       &part));
    check(exr_initialize_required_attr_simple(file_, 0, size, size, EXR_COMPRESSION_ZIP));
    if (layout == MapLayout::tiled_mip)
      check(exr_set_tile_descriptor(file_, 0, tile, tile, EXR_TILE_MIPMAP_LEVELS,
                                    EXR_TILE_ROUND_DOWN));
    for (const Layer& layer : layers)
      check(exr_add_channel(file_, 0, layer.name, layer.type, EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1));
    write_attributes(info, scale);
    check(exr_write_header(file_));
  }
  ~ExrFile() {
    if (file_) exr_finish(&file_);
  }
  ExrFile(const ExrFile&) = delete;
  ExrFile& operator=(const ExrFile&) = delete;

  void add_rows(int first, const std::string& chunk) {
    check(exr_write_scanline_chunk(file_, 0, first, chunk.data(), chunk.size()));
  }
  void add_tile(int x, int y, int level, const std::string& chunk) {
    check(exr_write_tile_chunk(file_, 0, x, y, level, level, chunk.data(), chunk.size()));
  }
  std::string finish() {
    check(exr_finish(&file_));
    file_ = nullptr;
    return std::move(bytes_);
  }

 private:
  void write_attributes(const MapInfo& info, const MapScale& scale) {
    const Imf::Rational fps = Imf::guessExactFps(info.fps);
    const exr_attr_rational_t rate{fps.n, fps.d};
    check(exr_attr_set_rational(file_, 0, "framesPerSecond", &rate));
    check(exr_attr_set_int(file_, 0, "frame", info.frame));
    check(exr_attr_set_int(file_, 0, "seed", static_cast<int>(info.seed)));
    check(exr_attr_set_string(file_, 0, "preset", info.preset.c_str()));
    check(exr_attr_set_float(file_, 0, "texelSize", static_cast<float>(scale.texel)));
    check(exr_attr_set_float(file_, 0, "foldWidth", static_cast<float>(scale.fold_width)));
    check(exr_attr_set_float(file_, 0, "creaseWidth", static_cast<float>(scale.crease_width)));
  }
  static std::int64_t write(exr_const_context_t, void* bytes, const void* from, std::uint64_t count,
                            std::uint64_t at, exr_stream_error_func_ptr_t) {
    std::string& to = *static_cast<std::string*>(bytes);
    const auto* bytes_to_write = static_cast<const char*>(from);
    if (at == to.size()) {
      to.append(bytes_to_write, count);
    } else {
      if (to.size() < at + count) to.resize(at + count);
      std::memcpy(to.data() + at, bytes_to_write, count);
    }
    return static_cast<std::int64_t>(count);
  }
  void check(exr_result_t result) {
    if (result != EXR_ERR_SUCCESS)
      throw Error(
          ErrorCode::folder, "crease map",
          std::string("OpenEXR cannot write it: ") + exr_get_default_error_message(result) + ".");
  }
  exr_context_t file_ = nullptr;
  std::string bytes_;
};

enum class KeepTexels { batch, all };
struct MapSize {
  int size, threads;
  KeepTexels keep;
};

/// Calls job(0) ... job(count - 1), each on a thread of its own.
template <class Job>
void for_each_at_once(int count, const Job& job) {
  std::vector<std::future<void>> others;
  for (int k = 1; k < count; ++k)
    others.push_back(std::async(std::launch::async, [&job, k] { job(k); }));
  if (count > 0) job(0);
  for (auto& other : others) other.get();
}

/// Draws a map from the top in batches of as many strips as there are threads, and calls
/// strip(k, rows, texels) for each, k < threads, at the same time; then batch().
/// texels  receives the whole map, or only the current batch
template <class Strip, class Batch>
void draw_in_batches(const MapSize& map, const DrawRows& draw, std::vector<MapTexel>& texels,
                     const Strip& strip, const Batch& batch) {
  const int threads = std::max(1, map.threads), rows_of_batch = strip_rows * threads;
  const bool keep = map.keep == KeepTexels::all;
  texels.resize(std::size_t(map.size) * (keep ? map.size : std::min(rows_of_batch, map.size)));
  for (int first = 0; first < map.size; first += rows_of_batch) {
    const int last = std::min(first + rows_of_batch, map.size);
    for_each_at_once((last - first + strip_rows - 1) / strip_rows, [&](int k) {
      const int top = first + k * strip_rows;
      const MapRows rows{map.size, top, std::min(top + strip_rows, last)};
      MapTexel* target = texels.data() + std::size_t(keep ? top : k * strip_rows) * map.size;
      draw(rows, target);
      strip(k, rows, target);
    });
    batch();
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

constexpr half MapTexel::*averaged[] = {&MapTexel::fold_angle, &MapTexel::fold_plastic,
                                        &MapTexel::fold_peak,  &MapTexel::apex_dist,
                                        &MapTexel::strain_min, &MapTexel::strain_max};

MapTexel mean_of(const std::vector<MapTexel>& texels, int size, const Footprint& column,
                 const Footprint& row) {
  MapTexel mean = texels[std::size_t(row.nearest) * size + column.nearest];
  const bool centre_covered = mean.a > 0;
  double all = 0, covered = 0, creased = 0, r = 0, g = 0, b = 0, age = 0, cos2 = 0, sin2 = 0,
         sum[std::size(averaged)] = {}, best = 0;
  for (int y = 0; y < row.count; ++y)
    for (int x = 0; x < column.count; ++x) {
      const MapTexel& t = texels[std::size_t(row.first + y) * size + column.first + x];
      const float dir_x = t.dir_x, dir_y = t.dir_y;
      const double area = row.share[y] * column.share[x], weight = area * t.a;
      all += area;
      if (weight <= 0) continue;
      covered += weight;
      r += weight * t.r;
      g += weight * t.g;
      b += weight * t.b;
      for (std::size_t k = 0; k < std::size(averaged); ++k) sum[k] += weight * t.*averaged[k];
      cos2 += weight * (dir_x * dir_x - dir_y * dir_y);
      sin2 += weight * 2 * dir_x * dir_y;
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

namespace {

void write_rows(ExrFile& file, int size, int threads, const DrawRows& draw) {
  struct Block {
    int first;
    std::string chunk;
  };
  std::vector<std::vector<Block>> drawn(std::max(1, threads));
  std::vector<ChunkPacker> packers(drawn.size());
  std::vector<MapTexel> texels;
  draw_in_batches(
      {size, threads, KeepTexels::batch}, draw, texels,
      [&](int k, const MapRows& rows, const MapTexel* strip) {
        for (int first = rows.first; first < rows.last; first += block_rows)
          drawn[k].push_back({first, packers[k]({strip + rows.index(0, first), size, size,
                                                 std::min(block_rows, rows.last - first)})});
      },
      [&] {
        for (std::vector<Block>& blocks : drawn) {
          for (const Block& block : blocks) file.add_rows(block.first, block.chunk);
          blocks.clear();
        }
      });
}

void write_tiles(ExrFile& file, int size, int threads, const DrawRows& draw) {
  std::vector<ChunkPacker> packers(std::max(1, threads));
  std::vector<MapTexel> texels;
  draw_in_batches(
      {size, threads, KeepTexels::all}, draw, texels, [](int, const MapRows&, const MapTexel*) {},
      [] {});
  for (int level = 0, side = size;; ++level, side /= 2) {
    const int count = (side + tile - 1) / tile, batch = std::max(1, threads);
    for (int top = 0; top < count; top += batch) {
      std::vector<std::vector<std::string>> chunks(std::min(batch, count - top));
      for_each_at_once(static_cast<int>(chunks.size()), [&](int k) {
        const int y = tile * (top + k);
        for (int x = 0; x < side; x += tile)
          chunks[k].push_back(packers[k]({texels.data() + std::size_t(y) * side + x, side,
                                          std::min(tile, side - x), std::min(tile, side - y)}));
      });
      for (std::size_t k = 0; k < chunks.size(); ++k)
        for (std::size_t x = 0; x < chunks[k].size(); ++x)
          file.add_tile(static_cast<int>(x), top + static_cast<int>(k), level, chunks[k][x]);
    }
    if (side == 1) return;
    texels = next_level(texels, side, threads);
  }
}

}  // namespace

std::string encode_map(int size, MapLayout layout, const MapInfo& info, const MapScale& scale,
                       int threads, const DrawRows& draw) {
  ExrFile file(size, layout, info, scale);
  if (layout == MapLayout::scanline)
    write_rows(file, size, threads, draw);
  else
    write_tiles(file, size, threads, draw);
  return file.finish();
}

}  // namespace paperbake
