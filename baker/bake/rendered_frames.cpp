#include "baker/bake/rendered_frames.h"

#include "core/model/serializer.h"
#include "formats/cache/content_hash.h"
#include "formats/files/frame_statistics_table.h"

#include <cstdint>
#include <fcntl.h>
#include <fmt/format.h>
#include <type_traits>
#include <unistd.h>

namespace paperbake {

namespace fs = std::filesystem;

static void archive(Serializer& a, RenderStatistics& s) {
  visit_frame_statistics([&](const auto& field) {
    if constexpr (std::is_same_v<typename std::decay_t<decltype(field)>::Struct, RenderStatistics>)
      a(s.*field.member);
  });
}

static void archive(Serializer& a, Judgement& j) {
  a(j.length.mean, j.length.largest, j.length.where, j.crossings, j.inside, j.inside_at,
    j.inside_of);
}

static void archive(Serializer& a, CacheLayer& layer) { a(layer.name, layer.values); }

static void archive(Serializer& a, MeshSurface::Attribute& attribute) {
  a(attribute.name, attribute.kind, attribute.values, attribute.of_corner);
}

/// A custom property of an object; one of the three last has its value.
struct KeptProperty {
  std::string name;
  int kind = 0;  // index of the variant
  double number = 0;
  std::string text;
  std::vector<double> numbers;
};
static void archive(Serializer& a, KeptProperty& p) {
  a(p.name, p.kind, p.number, p.text, p.numbers);
}

namespace {

constexpr std::uintmax_t min_free = std::uintmax_t(256) << 20;  // [bytes] left to everybody else

/// Numbers in 32 bits; of any number of columns.
template <class Matrix>
void archive_floats(Serializer& a, Matrix& m) {
  using Floats =
      Eigen::Matrix<float, Matrix::RowsAtCompileTime, Matrix::ColsAtCompileTime, Matrix::Options>;
  Floats floats;
  if (!a.reads()) floats = m.template cast<float>();
  a(floats);
  if (a.reads()) m = floats.template cast<double>();
}

KeptProperty kept(const AuthoredProperties::value_type& property) {
  KeptProperty p;
  p.name = property.first;
  p.kind = static_cast<int>(property.second.index());
  if (const auto* number = std::get_if<double>(&property.second)) p.number = *number;
  if (const auto* text = std::get_if<std::string>(&property.second)) p.text = *text;
  if (const auto* list = std::get_if<std::vector<double>>(&property.second)) p.numbers = *list;
  return p;
}

/// What the artist made of a sheet; there need not be anything.
void archive_surface(Serializer& a, std::shared_ptr<const MeshSurface>& surface) {
  bool there_is = surface != nullptr;
  a(there_is);
  if (!there_is) return;
  MeshSurface copy = surface ? *surface : MeshSurface{};
  std::vector<KeptProperty> properties;
  for (const auto& property : copy.properties) properties.push_back(kept(property));
  a(copy.attributes, copy.materials, copy.material_of, properties);
  if (!a.reads()) return;
  for (const KeptProperty& p : properties)
    if (p.kind == 0)
      copy.properties[p.name] = p.number;
    else if (p.kind == 1)
      copy.properties[p.name] = p.text;
    else
      copy.properties[p.name] = p.numbers;
  surface = std::make_shared<const MeshSurface>(std::move(copy));
}

/// mesh  what of the frame seldom changes, as it was the last time; its own afterwards
void archive_sheet(Serializer& a, RenderedSheet& s, CacheFrame& mesh) {
  a(s.frame, s.record_index, s.statistics, s.judgement, s.handle_error);
  archive_floats(a, s.mesh.x);
  archive_floats(a, s.mesh.velocity);
  archive_floats(a, s.mesh.normal);
  archive_floats(a, s.mesh.crease);
  a(s.mesh.layers);
  bool as_before = !a.reads() && same_entries(s.mesh.triangles, mesh.triangles) &&
                   same_entries(s.mesh.normal_of_corner, mesh.normal_of_corner) &&
                   same_entries(s.mesh.uv, mesh.uv) && s.mesh.surface == mesh.surface;
  a(as_before);
  if (!as_before) {
    a(s.mesh.triangles, s.mesh.normal_of_corner, s.mesh.uv);
    archive_surface(a, s.mesh.surface);
    mesh.triangles = s.mesh.triangles;
    mesh.normal_of_corner = s.mesh.normal_of_corner;
    mesh.uv = s.mesh.uv;
    mesh.surface = s.mesh.surface;
  } else if (a.reads()) {
    s.mesh.triangles = mesh.triangles;
    s.mesh.normal_of_corner = mesh.normal_of_corner;
    s.mesh.uv = mesh.uv;
    s.mesh.surface = mesh.surface;
  }
  a.require(s.mesh.x.rows() == s.mesh.uv.rows());
}

/// The next entry of the file: its size, its bytes and their hash. Nothing: it ends, or is damaged.
std::optional<std::string> read_entry(std::FILE* file) {
  std::uint64_t size = 0;
  if (std::fread(&size, sizeof size, 1, file) != 1) return {};
  const long here = std::ftell(file);
  if (here < 0 || std::fseek(file, 0, SEEK_END) != 0) return {};
  const long end = std::ftell(file);
  ContentKey seal;
  const auto rest = static_cast<std::uint64_t>(end - here);
  if (std::fseek(file, here, SEEK_SET) != 0 || rest < seal.size() || size > rest - seal.size())
    return {};
  std::string bytes(size, '\0');
  if (std::fread(bytes.data(), 1, size, file) != size ||
      std::fread(seal.data(), 1, seal.size(), file) != seal.size() || seal != content_hash(bytes))
    return {};
  return bytes;
}

}  // namespace

RenderedFrames::RenderedFrames(fs::path file, std::string key, Resume resume)
    : path_(std::move(file)) {
  std::error_code unknown;
  if (resume == Resume::never || fs::is_symlink(path_, unknown) ||
      !fs::is_regular_file(path_, unknown))
    fs::remove(path_, unknown);
  const int fd = ::open(path_.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0666);
  file_ = fd < 0 ? nullptr : ::fdopen(fd, "rb+");
  if (!file_ || read_entry(file_) == key) return;
  std::rewind(file_);
  if (::ftruncate(::fileno(file_), 0) == 0)
    write(key);
  else
    give_up();
}

RenderedFrames::~RenderedFrames() {
  if (file_) std::fclose(file_);
}

std::optional<std::vector<RenderedSheet>> RenderedFrames::take() {
  if (!file_) return {};
  const long before = std::ftell(file_);
  if (const std::optional<std::string> bytes = read_entry(file_)) {
    try {
      std::vector<RenderedSheet> sheets;
      Serializer a(*bytes);
      std::uint32_t count = 0;
      a(count);
      a.require(count > 0 && count < bytes->size());
      meshes_.resize(std::max<std::size_t>(meshes_.size(), count));
      for (std::uint32_t s = 0; s < count; ++s) archive_sheet(a, sheets.emplace_back(), meshes_[s]);
      a.end();
      return sheets;
    } catch (const Error&) {
      // written by nobody: what follows is dropped
    }
  }
  if (std::fseek(file_, before, SEEK_SET) != 0 || ::ftruncate(::fileno(file_), before) != 0)
    give_up();
  return {};
}

void RenderedFrames::add(const std::vector<RenderedSheet>& sheets) {
  if (!file_) return;
  Serializer a;
  auto count = static_cast<std::uint32_t>(sheets.size());
  a(count);
  meshes_.resize(std::max<std::size_t>(meshes_.size(), count));
  for (std::size_t s = 0; s < sheets.size(); ++s) {
    RenderedSheet copy = sheets[s];
    archive_sheet(a, copy, meshes_[s]);
  }
  std::error_code unknown;
  const fs::space_info space = fs::space(path_, unknown);
  if (unknown || space.available < min_free + a.bytes().size()) return give_up();
  write(a.bytes());
}

void RenderedFrames::write(const std::string& bytes) {
  const std::uint64_t size = bytes.size();
  const ContentKey seal = content_hash(bytes);
  if (std::fwrite(&size, sizeof size, 1, file_) != 1 ||
      std::fwrite(bytes.data(), 1, size, file_) != size ||
      std::fwrite(seal.data(), 1, seal.size(), file_) != seal.size() || std::fflush(file_) != 0)
    give_up();
}

void RenderedFrames::give_up() {
  std::fclose(file_);
  file_ = nullptr;
  std::error_code none;
  fs::remove(path_, none);
}

void round_to_32_bits(CacheFrame& frame) {
  const auto round = [](auto& m) {
    m = m.template cast<float>().eval().template cast<double>().eval();
  };
  round(frame.x);
  round(frame.velocity);
  round(frame.normal);
  round(frame.crease);
}

void remove_rendered_frames(const fs::path& state_folder) {
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(state_folder, none))
    if (entry.path().filename().string().rfind("rendered.", 0) == 0) fs::remove(entry.path(), none);
}

std::string rendered_frames_file(std::size_t first, MeshFeatures features) {
  return fmt::format("rendered.{}{}", first, features == MeshFeatures::all ? "" : ".handles");
}

}  // namespace paperbake
