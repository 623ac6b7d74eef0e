#include "formats/cache/pc2_cache.h"

#include "core/model/error.h"

#include <cstring>
#include <fmt/format.h>
#include <iterator>

namespace paperbake {
namespace {

/// The header of a .pc2, little-endian.
struct Header {
  char signature[12] = "POINTCACHE2";
  std::int32_t version = 1, points = 0;
  float start = 0, rate = 1;  // frame of the first sample; frames per sample
  std::int32_t samples = 0;
};
static_assert(sizeof(Header) == 32);

std::string rest_obj(const CacheFrame& frame, double longer_side) {
  std::string text = "# the flat pattern, in metres\n";
  auto out = std::back_inserter(text);
  for (Eigen::Index v = 0; v < frame.uv.rows(); ++v)
    fmt::format_to(out, "v {:.9g} {:.9g} 0\n", longer_side * frame.uv(v, 0),
                   longer_side * frame.uv(v, 1));
  for (Eigen::Index v = 0; v < frame.uv.rows(); ++v)
    fmt::format_to(out, "vt {:.9g} {:.9g}\n", frame.uv(v, 0), frame.uv(v, 1));
  for (Eigen::Index t = 0; t < frame.triangles.rows(); ++t) {
    const Eigen::RowVector3i c = frame.triangles.row(t).array() + 1;
    fmt::format_to(out, "f {0}/{0} {1}/{1} {2}/{2}\n", c[0], c[1], c[2]);
  }
  return text;
}

}  // namespace

Pc2Writer::Pc2Writer(const std::filesystem::path& cache, const std::filesystem::path& rest,
                     const CacheInfo& info)
    : path_(cache), cache_(cache), rest_(rest), info_(info) {
  const Header unfinished;
  cache_.write(&unfinished, sizeof unfinished);
}

void Pc2Writer::add_frame(const CacheFrame& frame, double longer_side) {
  if (samples_ == 0) {
    triangles_ = frame.triangles;
    points_ = static_cast<std::int32_t>(frame.x.rows());
    rest_.write(rest_obj(frame, longer_side));
  }
  if (frame.x.rows() != points_ || frame.triangles.rows() != triangles_.rows() ||
      frame.triangles != triangles_)
    throw Error(
        ErrorCode::command, path_.string(),
        "A point cache needs one mesh for the whole shot, but the mesh of this bake changes.",
        "Leave out either --mesh simulation or the format pc2.");
  const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor> x = frame.x.cast<float>();
  try {
    cache_.write(x.data(), sizeof(float) * x.size());
    cache_.flush();
  } catch (const Error&) {
    cache_.truncate(sizeof(Header) + std::uint64_t(samples_) * sizeof(float) * x.size());
    throw;
  }
  ++samples_;
}

std::size_t Pc2Writer::finish() {
  if (samples_ == 0) return 0;
  Header header;
  header.points = points_;
  header.start = static_cast<float>(info_.first_frame);
  header.rate = static_cast<float>(info_.frame_step);
  header.samples = samples_;
  cache_.write_at(0, &header, sizeof header);
  rest_.commit();
  cache_.commit();
  return samples_;
}

}  // namespace paperbake
