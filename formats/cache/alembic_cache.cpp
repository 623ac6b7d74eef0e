#include "formats/cache/alembic_cache.h"

#include "core/model/error.h"
#include "formats/cache/alembic_mesh.h"
#include "formats/files/own_names.h"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <limits>
#include <map>
#include <string_view>

namespace paperbake {
namespace {

using alembic::Mesh;

// ---- names and texts

/// A name that every program accepts: Alembic forbids `/`, Maya `:` and `|`, and Blender's own
/// exporter replaces dots and spaces.
std::string legal_name(std::string name) {
  for (char& c : name)
    if (std::string_view(" ./\\:;|=\"'*?<>").find(c) != std::string_view::npos ||
        (c >= 0 && c < ' ') || c == 127)
      c = '_';
  return name.empty() ? "_" : name;
}

std::vector<Mesh> meshes_named(const std::vector<std::string>& names) {
  std::vector<Mesh> meshes;
  OwnNames own;
  for (const std::string& name : names) meshes.push_back({name, own(legal_name(name))});
  for (Mesh& mesh : meshes)
    mesh.guide_labels = {own(mesh.label + "_points"), own(mesh.label + "_folds")};
  return meshes;
}

std::string legal_text(std::string text) {
  for (char& c : text)
    if (c == ';' || c == '=' || c == '\0') c = '_';  // these separate the pairs
  return text;
}

std::string archive_metadata(const CacheInfo& info) {
  char fps[400];  // the largest double has 309 digits
  const auto end = std::to_chars(fps, fps + sizeof fps, info.fps, std::chars_format::fixed, 6).ptr;
  std::map<std::string, std::string> pairs{
      {"_ai_Application", "paperbake"},
      {"_ai_AlembicVersion", "Alembic 1.8.0 (as written by paperbake)"},
      {"FramesPerTimeUnit", std::string(fps, end)}};
  for (const auto& [key, value] : info.metadata) pairs.emplace(legal_text(key), legal_text(value));

  std::string text;
  for (const auto& [key, value] : pairs) text += (text.empty() ? "" : ";") + key + "=" + value;
  return text;
}

// ---- checks of a frame

template <class Rows>
void refuse_unless_finite(const Rows& rows, const char* what, const std::string& place) {
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    if ((rows.row(i).array().abs() <= std::numeric_limits<float>::max()).all()) continue;
    std::string values;
    for (const double value : rows.row(i))
      values += (values.empty() ? "" : ", ") + std::to_string(value);
    throw Error(ErrorCode::simulation, place,
                std::string("The ") + what + " of vertex " + std::to_string(i) +
                    " is not a finite number: (" + values + ").",
                "The simulation failed before this frame: move the handles more slowly there and "
                "bake again.");
  }
}

[[maybe_unused]] bool fits_together(const CacheFrame& frame) {
  const Eigen::Index vertices = frame.x.rows();
  const auto all_or_none = [&](Eigen::Index rows) { return rows == 0 || rows == vertices; };
  const Triangles& n = frame.normal_of_corner;
  const bool normals = n.size() == 0 ? all_or_none(frame.normal.rows())
                                     : n.rows() == frame.triangles.rows() && n.minCoeff() >= 0 &&
                                           n.maxCoeff() < frame.normal.rows();
  return all_or_none(frame.velocity.rows()) && normals && all_or_none(frame.uv.rows()) &&
         (frame.triangles.size() == 0 ||
          (frame.triangles.minCoeff() >= 0 && frame.triangles.maxCoeff() < vertices));
}

}  // namespace

struct AlembicWriter::Impl {
  alembic::Archive archive;
  CacheInfo info;
  std::vector<Mesh> meshes;
  struct Added {
    std::size_t sheet;
    std::uint64_t begin;  // [bytes] position in the file
  };
  std::vector<Added> added;  // the frames in the order of add_frame

  /// Removes the last frame from the file.
  void drop_last() {
    alembic::truncate(archive, added.back().begin);
    Mesh& mesh = meshes[added.back().sheet];
    mesh.frames.pop_back();
    mesh.guides.resize(std::min(mesh.guides.size(), mesh.frames.size()));
    added.pop_back();
  }
};

AlembicWriter::AlembicWriter(const std::filesystem::path& path, const CacheInfo& info,
                             const std::vector<std::string>& sheet_names)
    : impl_(new Impl{alembic::Archive(path), info, meshes_named(sheet_names), {}}) {
  assert(info.fps > 0);
}

AlembicWriter::~AlembicWriter() = default;

std::string AlembicWriter::add_frame(std::size_t sheet, const CacheFrame& frame) {
  Mesh& mesh = impl_->meshes.at(sheet);
  assert(fits_together(frame));
  const auto number =
      impl_->info.first_frame + impl_->info.frame_step * static_cast<long>(mesh.frames.size());
  const std::string place = "sheet \"" + mesh.name + "\", frame " + std::to_string(number);
  refuse_unless_finite(frame.x, "position", place);
  refuse_unless_finite(frame.velocity, "velocity", place);
  refuse_unless_finite(frame.normal, "normal", place);
  refuse_unless_finite(frame.uv, "uv", place);
  if (frame.surface)
    for (const MeshSurface::Attribute& attribute : frame.surface->attributes)
      refuse_unless_finite(attribute.values, attribute.name.c_str(), place);
  refuse_unless_finite(frame.crease, "crease", place);

  const std::uint64_t begin = impl_->archive.file.end();
  try {
    mesh.frames.push_back(alembic::store_frame(impl_->archive, frame, mesh));
    mesh.surface = frame.surface;
    if (frame.guides) mesh.guides.push_back(alembic::store_guides(impl_->archive, *frame.guides));
  } catch (const Error&) {
    alembic::truncate(impl_->archive, begin);
    throw;
  }
  impl_->added.push_back({sheet, begin});
  return hex(mesh.frames.back().points.key);
}

std::vector<std::size_t> AlembicWriter::finish() {
  const CacheInfo& info = impl_->info;
  alembic::Archive& archive = impl_->archive;
  for (;;) {
    const std::uint64_t begin = archive.file.end();
    std::vector<std::size_t> frames;
    for (const Mesh& mesh : impl_->meshes) frames.push_back(mesh.frames.size());
    const std::size_t most = frames.empty() ? 0 : *std::max_element(frames.begin(), frames.end());
    if (most == 0) return frames;
    OgawaBlock root;
    try {
      root = alembic::write_tree(archive, alembic::archive_object(archive, impl_->meshes, most),
                                 {most, info.frame_step / info.fps, info.first_frame / info.fps},
                                 archive_metadata(info));
    } catch (const Error&) {
      alembic::truncate(archive, begin);
      if (impl_->added.size() < 2) throw;
      impl_->drop_last();
      continue;
    }
    archive.file.commit(root);
    return frames;
  }
}

}  // namespace paperbake
