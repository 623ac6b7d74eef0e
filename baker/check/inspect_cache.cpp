#include "baker/check/inspect.h"
#include "core/geometry/measure.h"
#include "formats/cache/alembic_reader.h"
#include "formats/files/json.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <limits>

namespace paperbake {
namespace {

/// Of one sheet of a cache, over its frames.
struct CacheSpread {
  // least, most
  std::array<Eigen::Index, 2> vertices{std::numeric_limits<Eigen::Index>::max(), 0},
      triangles = vertices;
  // [m]
  Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  // [m/s]
  double fastest = 0;
};

CacheSpread spread_of(const AlembicReader& cache, std::size_t sheet) {
  CacheSpread s;
  const auto widen = [](std::array<Eigen::Index, 2>& range, Eigen::Index n) {
    range = {std::min(range[0], n), std::max(range[1], n)};
  };
  for (std::size_t i = 0; i < cache.sheets()[sheet].frames; ++i) {
    const CacheFrame frame = cache.frame(sheet, i);
    widen(s.vertices, frame.x.rows());
    widen(s.triangles, frame.triangles.rows());
    if (frame.x.rows() == 0) continue;
    s.low = s.low.cwiseMin(frame.x.colwise().minCoeff().transpose());
    s.high = s.high.cwiseMax(frame.x.colwise().maxCoeff().transpose());
    s.fastest = std::max(s.fastest, max_row_norm(frame.velocity));
  }
  return s;
}

}  // namespace

std::string inspect_cache(const std::filesystem::path& path, bool json) {
  const AlembicReader cache(path);
  const CacheInfo& info = cache.info();
  const auto bytes = std::filesystem::file_size(path);
  std::string text = fmt::format("{}: {:.2f} MB, {} sheets at {} fps\n", path.filename().string(),
                                 1e-6 * bytes, cache.sheets().size(), info.fps);
  Json metadata = Json::object(), sheets = Json::array();
  for (const auto& [key, value] : info.metadata) {
    metadata[key] = value;
    text += fmt::format("  {} = {}\n", key, value);
  }
  for (std::size_t s = 0; s < cache.sheets().size(); ++s) {
    const AlembicReader::Sheet& sheet = cache.sheets()[s];
    const CacheSpread spread = spread_of(cache, s);
    const int last = info.first_frame + info.frame_step * (static_cast<int>(sheet.frames) - 1);
    std::vector<std::string> channels;
    for (const auto& [has, name] :
         {std::pair(sheet.velocity, "velocities"), std::pair(sheet.normal, "normals"),
          std::pair(sheet.uv, "uv"), std::pair(sheet.crease, "crease strength")})
      if (has) channels.push_back(name);
    Json j{{"name", sheet.name},
           {"frames", sheet.frames},
           {"first_frame", info.first_frame},
           {"last_frame", last},
           {"constant_topology", sheet.constant_topology},
           {"vertices", spread.vertices},
           {"triangles", spread.triangles},
           {"channels", channels}};
    text += fmt::format("sheet \"{}\": frames {}-{}{}, ", sheet.name, info.first_frame, last,
                        info.frame_step > 1 ? fmt::format(" by {}", info.frame_step) : "");
    text +=
        sheet.constant_topology
            ? fmt::format("one mesh of {} vertices, {} triangles", spread.vertices[1],
                          spread.triangles[1])
            : fmt::format("changing meshes of {}-{} vertices, {}-{} triangles", spread.vertices[0],
                          spread.vertices[1], spread.triangles[0], spread.triangles[1]);
    text += fmt::format("; {}\n", fmt::join(channels, ", "));
    if (spread.vertices[1] > 0) {
      const Vector3d size = 1e3 * (spread.high - spread.low);
      text += fmt::format("  moves within {:.1f} x {:.1f} x {:.1f} mm, at {:.3g} m/s at most\n",
                          size.x(), size.y(), size.z(), spread.fastest);
      j["low_m"] = {spread.low.x(), spread.low.y(), spread.low.z()};
      j["high_m"] = {spread.high.x(), spread.high.y(), spread.high.z()};
      j["fastest_m_per_s"] = spread.fastest;
    }
    sheets.push_back(std::move(j));
  }
  if (!json) return text;
  const Json all{{"file", path.filename().string()},
                 {"bytes", bytes},
                 {"fps", info.fps},
                 {"metadata", metadata},
                 {"sheets", sheets}};
  return json_lines(all) + "\n";
}

}  // namespace paperbake
