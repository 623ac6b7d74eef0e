#include "formats/alembic_cache.h"

#include "core/error.h"
#include "formats/murmur.h"
#include "formats/ogawa.h"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <limits>
#include <map>
#include <set>
#include <string_view>

namespace paperbake {
namespace {

// What the schemas demand of us: readers find a mesh, and its channels, by these texts alone.
constexpr const char* xform_object = "schema=AbcGeom_Xform_v3;schemaObjTitle=AbcGeom_Xform_v3:.xform";
constexpr const char* xform_schema = "schema=AbcGeom_Xform_v3";
constexpr const char* mesh_object =
    "schema=AbcGeom_PolyMesh_v1;schemaBaseType=AbcGeom_GeomBase_v1;schemaObjTitle=AbcGeom_PolyMesh_v1:.geom";
constexpr const char* mesh_schema = "schema=AbcGeom_PolyMesh_v1;schemaBaseType=AbcGeom_GeomBase_v1";
constexpr const char* box_meaning = "interpretation=box";
constexpr const char* point_meaning = "geoScope=vtx;interpretation=point";
constexpr const char* velocity_meaning = "interpretation=vector";
constexpr const char* normal_meaning =
    "arrayExtent=1;geoScope=vtx;interpretation=normal;isGeomParam=true;podExtent=3;podName=float32_t";
constexpr const char* uv_meaning =
    "arrayExtent=1;geoScope=fvr;interpretation=vector;isGeomParam=true;podExtent=2;podName=float32_t;sourceName=UVMap";

constexpr std::int32_t file_version = 0;
constexpr std::int32_t library_version = 10800;  // the Alembic whose files ours look like: 1.8.0

enum class Shape : std::uint32_t { compound = 0, scalar = 1, array = 2 };
enum class Pod : std::uint32_t { boolean = 0, u32 = 5, i32 = 6, f32 = 10, f64 = 11 };
enum class Clock : std::uint32_t { still = 0, frames = 1 };  // the time samplings of the archive, by number

/// A stored value. Equal values share one block of the file, so samples are equal when their blocks are.
struct Sample {
  OgawaBlock block;
  ContentKey key;
};

bool operator!=(const Sample& a, const Sample& b) { return a.block != b.block; }

struct Property {
  std::string name, metadata;
  Shape shape = Shape::compound;
  Pod pod = Pod::boolean;
  std::uint32_t extent = 0;       // numbers in one element
  Clock clock = Clock::still;
  std::vector<Sample> samples;    // one for each frame
  std::vector<Property> members;  // of a compound
};

struct Object {
  std::string name, metadata;
  std::vector<Property> properties;
  std::vector<Object> children;
};

/// The file, and what is known of it while it grows.
struct Archive {
  explicit Archive(const std::filesystem::path& path) : file(path) {}

  OgawaWriter file;
  std::map<std::pair<ContentKey, std::size_t>, OgawaBlock> stored;  // by key and size: every sample so far
  std::vector<std::string> metadata;                                // texts that headers refer to by number, from 1
};

/// min x y z, max x y z: the order of the file.
struct Box {
  static constexpr double huge = std::numeric_limits<double>::max();
  std::array<double, 6> sides{huge, huge, huge, -huge, -huge, -huge};  // of nothing; what readers expect of an empty mesh
};

/// The samples of one mesh at one frame.
struct MeshFrame {
  Box box;
  Sample bounds, points, velocities, normals, indices, counts, uv, uv_indices;
};

struct Mesh {
  std::string name, label;  // as asked for, as stored
  std::vector<MeshFrame> frames;
};

using Floats2 = Eigen::Matrix<float, Eigen::Dynamic, 2, Eigen::RowMajor>;
using Floats3 = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;

template <class Values>
std::string_view raw(const Values& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof *values.data()};
}

// ---- names and texts ----------------------------------------------------------------------------------------------

/// A name every host takes: Alembic forbids `/`, Maya `:` and `|`, and Blender's own exporter gives up dots and spaces.
std::string legal_name(std::string name) {
  for (char& c : name)
    if (std::string_view(" ./\\:;|=\"'*?<>").find(c) != std::string_view::npos || (c >= 0 && c < ' ') || c == 127) c = '_';
  return name.empty() ? "_" : name;
}

std::vector<Mesh> meshes_named(const std::vector<std::string>& names) {
  std::vector<Mesh> meshes;
  std::set<std::string> taken;
  for (const std::string& name : names) {
    const std::string legal = legal_name(name);
    std::string label = legal;
    for (int n = 2; !taken.insert(label).second; ++n) label = legal + "_" + std::to_string(n);  // "a.b" beside "a_b"
    meshes.push_back({name, label, {}});
  }
  return meshes;
}

std::string legal_text(std::string text) {
  for (char& c : text)
    if (c == ';' || c == '=' || c == '\0') c = '_';  // they separate pairs
  return text;
}

std::string archive_metadata(const CacheInfo& info) {
  char fps[400];  // the largest double has 309 digits
  const auto end = std::to_chars(fps, fps + sizeof fps, info.fps, std::chars_format::fixed, 6).ptr;
  std::map<std::string, std::string> pairs{{"_ai_Application", "paperbake"},
                                           {"_ai_AlembicVersion", "Alembic 1.8.0 (as written by paperbake)"},
                                           {"FramesPerTimeUnit", std::string(fps, end)}};
  for (const auto& [key, value] : info.metadata) pairs.emplace(legal_text(key), legal_text(value));

  std::string text;
  for (const auto& [key, value] : pairs) text += (text.empty() ? "" : ";") + key + "=" + value;
  return text;
}

// ---- from a frame to samples --------------------------------------------------------------------------------------

template <class Rows>
void refuse_unless_finite(const Rows& rows, const char* what, const std::string& place) {
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    if ((rows.row(i).array().abs() <= std::numeric_limits<float>::max()).all()) continue;
    std::string values;
    for (const double value : rows.row(i)) values += (values.empty() ? "" : ", ") + std::to_string(value);
    throw Error(Fault::simulation, place,
                std::string("The ") + what + " of vertex " + std::to_string(i) + " is not a finite number: (" + values + ").",
                "The sheet was lost before this frame: move the handles more slowly there, and bake again.");
  }
}

[[maybe_unused]] bool fits_together(const CacheFrame& frame) {
  const Eigen::Index vertices = frame.x.rows();
  const auto all_or_none = [&](Eigen::Index rows) { return rows == 0 || rows == vertices; };
  return all_or_none(frame.velocity.rows()) && all_or_none(frame.normal.rows()) && all_or_none(frame.uv.rows()) &&
         (frame.triangles.size() == 0 || (frame.triangles.minCoeff() >= 0 && frame.triangles.maxCoeff() < vertices));
}

Floats3 y_up(const Points3& rows) {
  Floats3 turned(rows.rows(), 3);
  turned << rows.col(0).cast<float>(), rows.col(2).cast<float>(), -rows.col(1).cast<float>();
  turned.array() += 0.0f;  // -0 becomes 0: equal values have equal keys
  return turned;
}

/// The corners in reverse: seen from its front, an Alembic face runs clockwise.
Triangles clockwise(const Triangles& triangles) { return triangles.rowwise().reverse(); }

Box box_of(const Floats3& points) {
  Box box;
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    for (int axis = 0; axis < 3; ++axis) {
      box.sides[axis] = std::min<double>(box.sides[axis], points(i, axis));
      box.sides[axis + 3] = std::max<double>(box.sides[axis + 3], points(i, axis));
    }
  return box;
}

Box around(const Box& a, const Box& b) {
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    box.sides[axis] = std::min(a.sides[axis], b.sides[axis]);
    box.sides[axis + 3] = std::max(a.sides[axis + 3], b.sides[axis + 3]);
  }
  return box;
}

/// Puts a value into the file, unless the same bytes are there already, in whichever property.
Sample store(Archive& archive, std::string_view bytes) {
  const ContentKey key = murmur(bytes);
  if (bytes.empty()) return {empty_data, key};
  OgawaBlock& block = archive.stored[{key, bytes.size()}];
  if (block == 0) block = archive.file.data({raw(key), bytes});
  return {block, key};
}

MeshFrame store_frame(Archive& archive, const CacheFrame& frame) {
  const Floats3 points = y_up(frame.x), velocities = y_up(frame.velocity), normals = y_up(frame.normal);
  const Triangles triangles = clockwise(frame.triangles);
  const std::vector<std::int32_t> corners_of_faces(triangles.rows(), 3);
  const Floats2 uv = (frame.uv.cast<float>().array() + 0.0f).matrix();

  MeshFrame samples;
  samples.box = box_of(points);
  samples.bounds = store(archive, raw(samples.box.sides));
  samples.points = store(archive, raw(points));
  samples.velocities = store(archive, raw(velocities));
  samples.normals = store(archive, raw(normals));
  samples.indices = store(archive, raw(triangles));
  samples.counts = store(archive, raw(corners_of_faces));
  samples.uv = store(archive, raw(uv));
  // a corner's uv is that of its vertex: these are the bytes of the face indices, and cost nothing
  samples.uv_indices = uv.rows() == 0 ? samples.uv : samples.indices;
  return samples;
}

// ---- from samples to properties -----------------------------------------------------------------------------------

Property animated(std::string name, std::string metadata, Shape shape, Pod pod, std::uint32_t extent,
                  std::vector<Sample> samples) {
  return {std::move(name), std::move(metadata), shape, pod, extent, Clock::frames, std::move(samples), {}};
}

Property compound(std::string name, std::string metadata, std::vector<Property> members) {
  Property property;
  property.name = std::move(name);
  property.metadata = std::move(metadata);
  property.members = std::move(members);
  return property;
}

std::vector<Sample> column(const std::vector<MeshFrame>& frames, Sample MeshFrame::*channel) {
  std::vector<Sample> samples;
  for (const MeshFrame& frame : frames) samples.push_back(frame.*channel);
  return samples;
}

/// A channel that was never given is left out of the file.
bool ever_given(const std::vector<MeshFrame>& frames, Sample MeshFrame::*channel) {
  return std::any_of(frames.begin(), frames.end(), [&](const MeshFrame& f) { return (f.*channel).block != empty_data; });
}

Property box_property(const char* name, std::vector<Sample> samples) {
  return animated(name, box_meaning, Shape::scalar, Pod::f64, 6, std::move(samples));
}

Property geometry(const std::vector<MeshFrame>& frames) {
  const auto array = [&](const char* name, const char* meaning, Pod pod, std::uint32_t extent, Sample MeshFrame::*channel) {
    return animated(name, meaning, Shape::array, pod, extent, column(frames, channel));
  };
  std::vector<Property> members{
      box_property(".selfBnds", column(frames, &MeshFrame::bounds)),
      array("P", point_meaning, Pod::f32, 3, &MeshFrame::points),
      array(".faceIndices", "", Pod::i32, 1, &MeshFrame::indices),
      array(".faceCounts", "", Pod::i32, 1, &MeshFrame::counts),
  };
  if (ever_given(frames, &MeshFrame::velocities))
    members.push_back(array(".velocities", velocity_meaning, Pod::f32, 3, &MeshFrame::velocities));
  if (ever_given(frames, &MeshFrame::normals))
    members.push_back(array("N", normal_meaning, Pod::f32, 3, &MeshFrame::normals));
  if (ever_given(frames, &MeshFrame::uv))
    members.push_back(compound("uv", uv_meaning,
                               {array(".vals", uv_meaning, Pod::f32, 2, &MeshFrame::uv),
                                array(".indices", "", Pod::u32, 1, &MeshFrame::uv_indices)}));
  return compound(".geom", mesh_schema, std::move(members));
}

/// The sheet as hosts expect it: the mesh under an Xform that does nothing but carry the name.
Object sheet_object(Archive& archive, const Mesh& mesh) {
  const char inherits = 1;
  Property inherited{".inherits", "", Shape::scalar, Pod::boolean, 1, Clock::still, {store(archive, {&inherits, 1})}, {}};
  std::vector<Property> transform{box_property(".childBnds", column(mesh.frames, &MeshFrame::bounds)), inherited};
  Object geom{mesh.label + "Shape", mesh_object, {geometry(mesh.frames)}, {}};
  return {mesh.label, xform_object, {compound(".xform", xform_schema, std::move(transform))}, {std::move(geom)}};
}

Object archive_object(Archive& archive, const std::vector<Mesh>& meshes, std::size_t frames) {
  std::vector<Sample> bounds;
  for (std::size_t i = 0; i < frames; ++i) {
    Box box;
    for (const Mesh& mesh : meshes) box = around(box, mesh.frames[i].box);
    bounds.push_back(store(archive, raw(box.sides)));
  }
  Object root;
  if (frames > 0) root.properties.push_back(box_property(".childBnds", std::move(bounds)));
  for (const Mesh& mesh : meshes) root.children.push_back(sheet_object(archive, mesh));
  return root;
}

// ---- from properties and objects to the file ----------------------------------------------------------------------

/// The number that stands for a text in headers; 0 is no text.
std::uint32_t metadata_number(Archive& archive, const std::string& text) {
  if (text.empty()) return 0;
  auto known = std::find(archive.metadata.begin(), archive.metadata.end(), text);
  if (known == archive.metadata.end()) known = archive.metadata.insert(known, text);
  return static_cast<std::uint32_t>(known - archive.metadata.begin()) + 1;
}

/// Which samples differ: the first one from sample 0, the last one from the one before it. Both 0: none ever does.
struct Changes {
  std::size_t first = 0, last = 0;
};

Changes changes_of(const std::vector<Sample>& samples) {
  Changes changes;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    if (changes.first == 0 && samples[i] != samples[0]) changes.first = i;
    if (samples[i] != samples[i - 1]) changes.last = i;
  }
  return changes;
}

std::string header_of(const Property& property, std::uint32_t metadata) {
  const std::size_t count = property.samples.size();
  const Changes changes = changes_of(property.samples);
  const bool value = property.shape != Shape::compound;
  const bool constant = changes.first == 0, partly = !constant && (changes.first > 1 || changes.last + 1 < count);

  const std::size_t largest = std::max(count, property.name.size());
  const std::uint32_t width = largest <= 0xFF ? 0 : largest <= 0xFFFF ? 1 : 2;  // of the numbers below: 2^width bytes
  std::string numbers;
  const auto number = [&](std::size_t n) { numbers.append(bytes_of(std::uint64_t{n}).substr(0, std::size_t{1} << width)); };

  std::uint32_t info = static_cast<std::uint32_t>(property.shape) | width << 2 | metadata << 20;
  if (value) {
    const auto clock = static_cast<std::uint32_t>(property.clock);
    info |= static_cast<std::uint32_t>(property.pod) << 4 | property.extent << 12;
    info |= std::uint32_t{clock != 0} << 8 | std::uint32_t{partly} << 9 | std::uint32_t{constant} << 11;
    number(count);
    if (partly) number(changes.first), number(changes.last);
    if (clock != 0) number(clock);
  }
  number(property.name.size());
  return std::string(bytes_of(info)) + numbers + property.name;
}

/// A property's values; the keys of them are added to `content`.
OgawaBlock write_samples(Archive& archive, const Property& property, std::string& content) {
  const Changes changes = changes_of(property.samples);
  std::vector<OgawaBlock> children;
  for (std::size_t i = 0; i <= changes.last && i < property.samples.size(); ++i) {
    if (i > 0 && i < changes.first) continue;  // readers put sample 0 there
    children.push_back(property.samples[i].block);
    if (property.shape == Shape::array) children.push_back(empty_data);  // no dimensions: the size tells the count
    content += raw(property.samples[i].key);
  }
  return archive.file.group(children);
}

/// All that is in the properties is added to `content`.
OgawaBlock write_compound(Archive& archive, const std::vector<Property>& properties, std::string& content) {
  if (properties.empty()) return empty_group;
  std::vector<OgawaBlock> children;
  std::string headers;
  for (const Property& property : properties) {
    children.push_back(property.shape == Shape::compound ? write_compound(archive, property.members, content)
                                                         : write_samples(archive, property, content));
    headers += header_of(property, metadata_number(archive, property.metadata));
  }
  children.push_back(archive.file.data({headers}));
  content += headers;
  return archive.file.group(children);
}

struct WrittenObject {
  OgawaBlock block;
  std::string hashes;  // of the properties and of the children; tools take objects with equal ones for copies
};

WrittenObject write_object(Archive& archive, const Object& object) {
  std::string content, names, children_content;
  std::vector<OgawaBlock> blocks{write_compound(archive, object.properties, content)};
  for (const Object& child : object.children) {
    const WrittenObject written = write_object(archive, child);
    blocks.push_back(written.block);
    children_content += child.name + child.metadata + written.hashes;
    names += bytes_of(static_cast<std::uint32_t>(child.name.size()));
    names += child.name;
    names += static_cast<char>(metadata_number(archive, child.metadata));
  }
  std::string hashes(raw(murmur(content)));
  hashes += raw(murmur(children_content));
  blocks.push_back(archive.file.data({names, hashes}));
  return {archive.file.group(blocks), hashes};
}

std::string time_sampling(std::size_t most_samples, double seconds_per_sample, double start) {
  std::string text(bytes_of(static_cast<std::uint32_t>(most_samples)));
  text += bytes_of(seconds_per_sample);
  text += bytes_of(std::uint32_t{1});  // times stored: the start
  text += bytes_of(start);
  return text;
}

OgawaBlock write_archive(Archive& archive, const CacheInfo& info, const Object& root, std::size_t frames) {
  const OgawaBlock objects = write_object(archive, root).block;
  const std::string still = time_sampling(1, 1.0, 0.0), clock = time_sampling(frames, info.frame_step / info.fps, info.first_frame / info.fps);
  std::string texts;
  for (const std::string& text : archive.metadata) {
    assert(text.size() <= 255 && archive.metadata.size() <= 254);
    texts += static_cast<char>(text.size());
    texts += text;
  }
  OgawaWriter& file = archive.file;
  return file.group({file.data({bytes_of(file_version)}), file.data({bytes_of(library_version)}), objects,
                     file.data({archive_metadata(info)}), file.data({still, clock}), file.data({texts})});
}

}  // namespace

struct AlembicWriter::Impl {
  Archive archive;
  CacheInfo info;
  std::vector<Mesh> meshes;
};

AlembicWriter::AlembicWriter(const std::filesystem::path& path, const CacheInfo& info,
                             const std::vector<std::string>& sheet_names)
    : impl_(new Impl{Archive(path), info, meshes_named(sheet_names)}) {
  assert(info.fps > 0);
}

AlembicWriter::~AlembicWriter() = default;

std::string AlembicWriter::add_frame(std::size_t sheet, const CacheFrame& frame) {
  Mesh& mesh = impl_->meshes.at(sheet);
  assert(fits_together(frame));
  const auto number = impl_->info.first_frame + impl_->info.frame_step * static_cast<long>(mesh.frames.size());
  const std::string place = "sheet \"" + mesh.name + "\", frame " + std::to_string(number);
  refuse_unless_finite(frame.x, "position", place);
  refuse_unless_finite(frame.velocity, "velocity", place);
  refuse_unless_finite(frame.normal, "normal", place);
  refuse_unless_finite(frame.uv, "uv", place);

  mesh.frames.push_back(store_frame(impl_->archive, frame));
  return hex(mesh.frames.back().points.key);
}

void AlembicWriter::finish() {
  std::vector<Mesh>& meshes = impl_->meshes;
  std::size_t frames = meshes.empty() ? 0 : meshes[0].frames.size();
  for (const Mesh& mesh : meshes) frames = std::min(frames, mesh.frames.size());
  for (Mesh& mesh : meshes) mesh.frames.resize(frames);

  const Object root = archive_object(impl_->archive, meshes, frames);
  impl_->archive.file.commit(write_archive(impl_->archive, impl_->info, root, frames));
}

}  // namespace paperbake
