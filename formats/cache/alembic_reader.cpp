#include "formats/cache/alembic_reader.h"

#include "formats/cache/alembic_archive.h"
#include "formats/cache/ogawa_reader.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <optional>

namespace paperbake {
namespace {

using alembic::Pod;
using alembic::PropertyType;

// twice the longest clip of a scene; a limit is needed because equal frames take no space in the
// file, so that a few bytes can claim any number of them
constexpr std::size_t max_frames = 200000;

/// What the header of a property says, and the block of its samples.
struct PropertyHeader {
  std::string name;
  PropertyType type = PropertyType::compound;
  Pod pod = Pod::boolean;
  std::uint32_t extent = 0;
  // number of samples; the first and last change (alembic_archive.cpp: Changes)
  std::size_t count = 0, first = 0, last = 0;
  bool constant = false;
  OgawaBlock block = empty_group;

  /// Index of sample i among the stored samples.
  std::size_t stored_index(std::size_t i) const {
    if (constant || i < first) return 0;
    return std::min(i, last) - first + (first > 0 ? 1 : 0);
  }
};

/// Reads numbers from the front of a string of bytes.
class Parser {
 public:
  Parser(const OgawaReader& file, std::string_view bytes) : file_(file), rest_(bytes) {}
  bool done() const { return rest_.empty(); }
  std::string_view take(std::size_t size) {
    if (size > rest_.size()) file_.refuse("A header is cut short.");
    const std::string_view taken = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return taken;
  }
  template <class Number>
  Number number() {
    Number value;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  std::size_t number(std::uint32_t bytes) {
    std::uint64_t value = 0;
    std::memcpy(&value, take(bytes).data(), bytes);
    return value;
  }

 private:
  const OgawaReader& file_;
  std::string_view rest_;
};

std::vector<PropertyHeader> properties_of(const OgawaReader& file, OgawaBlock compound) {
  std::vector<OgawaBlock> children = file.group(compound);
  if (children.empty()) return {};
  const std::string headers = file.data(children.back());
  children.pop_back();
  Parser parser(file, headers);
  std::vector<PropertyHeader> all;
  while (!parser.done()) {
    const auto info = parser.number<std::uint32_t>();
    const std::uint32_t width = 1u << std::min(info >> 2 & 3, 2u);
    PropertyHeader p;
    p.type = static_cast<PropertyType>(std::min(info & 3, 2u));  // 3 is an array with one element
    p.pod = static_cast<Pod>(info >> 4 & 15);
    p.extent = info >> 12 & 255;
    p.constant = info >> 11 & 1;
    if (p.type != PropertyType::compound) {
      p.count = parser.number(width);
      p.first = 0;
      p.last = p.count ? p.count - 1 : 0;
      if (info >> 9 & 1) {
        p.first = parser.number(width);
        p.last = parser.number(width);
      }
      if (info >> 8 & 1) parser.number(width);
      if (p.last >= std::max<std::size_t>(p.count, 1) || p.first > p.last)
        file.refuse("The samples of a property are out of order.");
    }
    p.name = parser.take(parser.number(width));
    if ((info >> 20 & 255) == 255) parser.take(parser.number(width));
    if (all.size() == children.size()) file.refuse("There are more headers than properties.");
    p.block = children[all.size()];
    all.push_back(std::move(p));
  }
  return all;
}

const PropertyHeader* find(const std::vector<PropertyHeader>& all, std::string_view name) {
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const PropertyHeader& p) { return p.name == name; });
  return found == all.end() ? nullptr : &*found;
}

/// A channel of a mesh: its header and the blocks of its stored samples.
struct Channel {
  PropertyHeader header;
  std::vector<OgawaBlock> samples;
};

struct NamedObject {
  std::string name;
  OgawaBlock block;
};

std::vector<NamedObject> children_of(const OgawaReader& file, OgawaBlock object) {
  constexpr std::size_t hashes = 32;
  const std::vector<OgawaBlock> blocks = file.group(object);
  if (blocks.size() < 2) file.refuse("An object lacks some of its parts.");
  const std::string names = file.data(blocks.back());
  if (names.size() < hashes) file.refuse("The names of an object's children are cut short.");
  Parser parser(file, std::string_view(names).substr(0, names.size() - hashes));
  std::vector<NamedObject> children;
  for (std::size_t k = 1; k + 1 < blocks.size(); ++k) {
    std::string name(parser.take(parser.number<std::uint32_t>()));
    if (parser.number<std::uint8_t>() == 255) parser.take(parser.number<std::uint32_t>());
    children.push_back({std::move(name), blocks[k]});
  }
  return children;
}

OgawaBlock properties_block(const OgawaReader& file, OgawaBlock object) {
  const std::vector<OgawaBlock> blocks = file.group(object);
  return blocks.empty() ? empty_group : blocks.front();
}

}  // namespace

struct AlembicReader::Impl {
  struct Mesh {
    std::optional<Channel> points, indices, counts, velocities, normals, normal_indices, uv,
        uv_indices, colours;
  };

  OgawaReader file;
  CacheInfo info;
  std::vector<Sheet> sheets;
  std::vector<Mesh> meshes;

  explicit Impl(const std::filesystem::path& path) : file(path) {
    const std::vector<OgawaBlock> parts = file.group(file.root());
    if (parts.size() != 6) file.refuse("The archive does not have its six parts.");
    for (const NamedObject& transform : children_of(file, parts[2])) read_sheet(transform);
    read_metadata(file.data(parts[3]));
    read_times(file.data(parts[4]));
  }

  void read_sheet(const NamedObject& transform) {
    const std::vector<NamedObject> shapes = children_of(file, transform.block);
    if (shapes.size() != 1)
      file.refuse("Sheet \"" + transform.name + "\" does not consist of one mesh.");
    const std::vector<PropertyHeader> outer =
        properties_of(file, properties_block(file, shapes.front().block));
    const PropertyHeader* geometry = find(outer, ".geom");
    if (!geometry || geometry->type != PropertyType::compound)
      file.refuse("Sheet \"" + transform.name + "\" is not a mesh.");
    const std::vector<PropertyHeader> members = properties_of(file, geometry->block);
    if (find(members, ".pointIds") || find(members, "nVertices")) return;  // guides
    Mesh mesh;
    mesh.points = channel(members, "P", Pod::f32, 3);
    mesh.indices = channel(members, ".faceIndices", Pod::i32, 1);
    mesh.counts = channel(members, ".faceCounts", Pod::i32, 1);
    if (!mesh.points || !mesh.indices || !mesh.counts)
      file.refuse("Sheet \"" + transform.name + "\" has no points or no faces.");
    mesh.velocities = channel(members, ".velocities", Pod::f32, 3);
    if (const PropertyHeader* normals = find(members, "N");
        normals && normals->type == PropertyType::compound) {
      const std::vector<PropertyHeader> pair = properties_of(file, normals->block);
      mesh.normals = channel(pair, ".vals", Pod::f32, 3);
      mesh.normal_indices = channel(pair, ".indices", Pod::u32, 1);
    } else {
      mesh.normals = channel(members, "N", Pod::f32, 3);
    }
    std::vector<PropertyHeader> named;
    if (const PropertyHeader* others = find(members, ".arbGeomParams");
        others && others->type == PropertyType::compound)
      named = properties_of(file, others->block);
    mesh.colours = channel(named, "crease", Pod::f32, 4);
    const PropertyHeader* pattern = find(named, "pattern");
    if (const PropertyHeader* uv = pattern ? pattern : find(members, "uv");
        uv && uv->type == PropertyType::compound) {
      const std::vector<PropertyHeader> pair = properties_of(file, uv->block);
      mesh.uv = channel(pair, ".vals", Pod::f32, 2);
      mesh.uv_indices = channel(pair, ".indices", Pod::u32, 1);
    }
    Sheet sheet;
    sheet.name = transform.name;
    sheet.frames = mesh.points->header.count;
    if (sheet.frames > max_frames)
      file.refuse("Sheet \"" + transform.name + "\" has " + std::to_string(sheet.frames) +
                  " frames; the limit is " + std::to_string(max_frames) + ".");
    sheet.constant_topology = mesh.indices->samples.size() == 1 && mesh.counts->samples.size() == 1;
    sheet.velocity = mesh.velocities.has_value();
    sheet.normal = mesh.normals.has_value();
    sheet.uv = mesh.uv.has_value();
    sheet.crease = mesh.colours.has_value();
    sheets.push_back(std::move(sheet));
    meshes.push_back(std::move(mesh));
  }

  std::optional<Channel> channel(const std::vector<PropertyHeader>& members, std::string_view name,
                                 Pod pod, std::uint32_t extent) const {
    const PropertyHeader* header = find(members, name);
    if (!header) return std::nullopt;
    if (header->type != PropertyType::array || header->pod != pod || header->extent != extent)
      file.refuse("Property \"" + std::string(name) + "\" does not have the expected type.");
    // two blocks for each sample: data and dimensions
    const std::vector<OgawaBlock> blocks = file.group(header->block);
    Channel c{*header, {}};
    for (std::size_t k = 0; k < blocks.size(); k += 2) c.samples.push_back(blocks[k]);
    if (header->count > 0 && header->stored_index(header->count - 1) >= c.samples.size())
      file.refuse("Property \"" + std::string(name) + "\" lacks some of its samples.");
    return c;
  }

  void read_metadata(const std::string& text) {
    for (std::size_t from = 0; from < text.size();) {
      const std::size_t end = std::min(text.find(';', from), text.size()),
                        equals = text.find('=', from);
      if (equals < end) {
        const std::string key = text.substr(from, equals - from),
                          value = text.substr(equals + 1, end - equals - 1);
        if (key == "FramesPerTimeUnit")
          info.fps = std::strtod(value.c_str(), nullptr);
        else
          info.metadata.emplace_back(key, value);
      }
      from = end + 1;
    }
    if (!(info.fps > 0) || !std::isfinite(info.fps))
      file.refuse("The frames per second are missing.");
  }

  void read_times(const std::string& text) {
    Parser parser(file, text);
    double step = 0, start = 0;
    for (int sampling = 0; sampling < 2; ++sampling) {
      parser.number<std::uint32_t>();
      step = parser.number<double>();
      if (parser.number<std::uint32_t>() != 1) file.refuse("Its sample times are not uniform.");
      start = parser.number<double>();
    }
    const double first = start * info.fps, frames = step * info.fps;
    if (!(std::abs(first) < 1e9 && frames > 0.5 && frames < 1e9))
      file.refuse("Its sample times do not fall on frames.");
    info.first_frame = static_cast<int>(std::lround(first));
    info.frame_step = static_cast<int>(std::lround(frames));
  }

  /// The bytes of a sample. They must match the key that is stored before them.
  std::string bytes(const Channel& channel, std::size_t i) const {
    if (channel.header.count == 0) return {};
    const std::string stored = file.data(
        channel.samples[channel.header.stored_index(std::min(i, channel.header.count - 1))]);
    ContentKey key{};
    if (stored.empty()) return {};
    if (stored.size() < key.size())
      file.refuse("A sample of \"" + channel.header.name + "\" is cut short.");
    std::memcpy(key.data(), stored.data(), key.size());
    std::string values = stored.substr(key.size());
    if (key != paperbake::content_hash(values))
      file.refuse("A sample of \"" + channel.header.name +
                  "\" is damaged: its bytes do not match their hash.");
    return values;
  }

  template <class Number>
  std::vector<Number> numbers(const Channel& channel, std::size_t i) const {
    const std::string raw = bytes(channel, i);
    std::vector<Number> values(raw.size() / sizeof(Number));
    if (values.size() * sizeof(Number) != raw.size() || values.size() % channel.header.extent != 0)
      file.refuse("A sample of \"" + channel.header.name + "\" ends within an element.");
    if (!values.empty()) std::memcpy(values.data(), raw.data(), raw.size());
    return values;
  }

  Points3 z_up(const Channel& channel, std::size_t i) const {
    const std::vector<float> v = numbers<float>(channel, i);
    Points3 rows(v.size() / 3, 3);
    for (Eigen::Index r = 0; r < rows.rows(); ++r)
      rows.row(r) << v[3 * r], -v[3 * r + 2], v[3 * r + 1];
    rows.array() += 0.0;
    return rows;
  }

  /// Rows of three indices below `count`, each row in reverse order.
  Triangles reversed(const std::vector<std::int32_t>& corners, Eigen::Index count) const {
    const auto inside = [&](std::int32_t v) { return v >= 0 && v < count; };
    if (corners.size() % 3 != 0 || !std::all_of(corners.begin(), corners.end(), inside))
      file.refuse("A face refers to a vertex that does not exist.");
    Triangles all(corners.size() / 3, 3);
    for (Eigen::Index t = 0; t < all.rows(); ++t)
      all.row(t) << corners[3 * t + 2], corners[3 * t + 1], corners[3 * t];
    return all;
  }

  Triangles triangles(const Mesh& mesh, std::size_t i, Eigen::Index vertices) const {
    const std::vector<std::int32_t> corners = numbers<std::int32_t>(*mesh.indices, i),
                                    counts = numbers<std::int32_t>(*mesh.counts, i);
    const auto three = [](std::int32_t n) { return n == 3; };
    if (!std::all_of(counts.begin(), counts.end(), three) || corners.size() != 3 * counts.size())
      file.refuse("Some faces are not triangles.");
    return reversed(corners, vertices);
  }

  Eigen::VectorXd crease(const Mesh& mesh, std::size_t i, Eigen::Index vertices) const {
    const std::vector<float> rgba = numbers<float>(*mesh.colours, i);
    if (static_cast<Eigen::Index>(rgba.size()) != 4 * vertices)
      file.refuse("It does not have one colour for each vertex.");
    Eigen::VectorXd angle(vertices);
    for (Eigen::Index v = 0; v < vertices; ++v) angle[v] = M_PI / 2 * rgba[4 * v];
    return angle;
  }

  Points2 uv(const Mesh& mesh, std::size_t i, Eigen::Index vertices) const {
    const std::vector<float> v = numbers<float>(*mesh.uv, i);
    if (static_cast<Eigen::Index>(v.size()) != 2 * vertices ||
        (mesh.uv_indices && bytes(*mesh.uv_indices, i) != bytes(*mesh.indices, i)))
      file.refuse("It does not have one uv for each vertex.");
    Points2 rows(vertices, 2);
    for (Eigen::Index r = 0; r < vertices; ++r) rows.row(r) << v[2 * r], v[2 * r + 1];
    return rows;
  }
};

AlembicReader::AlembicReader(const std::filesystem::path& path)
    : impl_(std::make_unique<Impl>(path)) {}
AlembicReader::~AlembicReader() = default;

const CacheInfo& AlembicReader::info() const { return impl_->info; }
const std::vector<AlembicReader::Sheet>& AlembicReader::sheets() const { return impl_->sheets; }

CacheFrame AlembicReader::frame(std::size_t sheet, std::size_t i) const {
  const Impl& s = *impl_;
  const Impl::Mesh& mesh = s.meshes.at(sheet);
  CacheFrame frame;
  frame.x = s.z_up(*mesh.points, i);
  frame.triangles = s.triangles(mesh, i, frame.x.rows());
  if (mesh.velocities) frame.velocity = s.z_up(*mesh.velocities, i);
  if (mesh.normals) frame.normal = s.z_up(*mesh.normals, i);
  if (mesh.normal_indices)
    frame.normal_of_corner =
        s.reversed(s.numbers<std::int32_t>(*mesh.normal_indices, i), frame.normal.rows());
  if (mesh.colours) frame.crease = s.crease(mesh, i, frame.x.rows());
  if (mesh.uv) frame.uv = s.uv(mesh, i, frame.x.rows());
  return frame;
}

std::string AlembicReader::content_hash(std::size_t sheet, std::size_t i) const {
  return hex(paperbake::content_hash(impl_->bytes(*impl_->meshes.at(sheet).points, i)));
}

}  // namespace paperbake
