#include "formats/cache/alembic_mesh.h"

#include "formats/cache/material_faces.h"
#include "formats/files/bytes_of.h"
#include "formats/files/own_names.h"

#include <algorithm>

namespace paperbake::alembic {
namespace {

constexpr const char* mesh_schema = "AbcGeom_PolyMesh_v1";
constexpr const char* face_set_schema = "AbcGeom_FaceSet_v1";

using Floats2 = Eigen::Matrix<float, Eigen::Dynamic, 2, Eigen::RowMajor>;
using FloatRows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// ---- from a frame to samples

/// Grey levels: black where the sheet is flat, white where it is folded by a right angle or more.
Eigen::Matrix<float, Eigen::Dynamic, 4, Eigen::RowMajor> colours(const Eigen::VectorXd& crease) {
  Eigen::Matrix<float, Eigen::Dynamic, 4, Eigen::RowMajor> rgba(crease.size(), 4);
  rgba.leftCols<3>() = (crease / (M_PI / 2)).cwiseMin(1.0).cast<float>().replicate<1, 3>();
  rgba.col(3).setOnes();
  return rgba;
}

/// The corners in reverse order: seen from its front, an Alembic face is clockwise.
Triangles clockwise(const Triangles& triangles) { return triangles.rowwise().reverse(); }

/// Whether an attribute is written as a list of numbers for each corner: AbcGeom has no other type
/// for pairs that are no uv set, and for four numbers that are no colour.
bool is_list(const MeshSurface::Attribute& attribute) {
  const Eigen::Index width = attribute.values.cols();
  return attribute.kind == AttributeKind::number && (width == 2 || width == 4);
}

/// The values of all corners, clockwise.
FloatRows of_corners(const FloatRows& values, const Triangles& of_corner) {
  FloatRows all(of_corner.size(), values.cols());
  for (Eigen::Index i = 0; i < of_corner.size(); ++i) all.row(i) = values.row(of_corner.data()[i]);
  return all;
}

/// Stores the attributes and materials of the artist.
void store_surface(Archive& archive, const MeshSurface& surface, MeshFrame& samples) {
  for (const MeshSurface::Attribute& attribute : surface.attributes) {
    const FloatRows values = (attribute.values.cast<float>().array() + 0.0f).matrix();
    const Triangles of_corner = clockwise(attribute.of_corner);
    if (is_list(attribute))
      samples.attributes.push_back(
          {store(archive, bytes_of_values(of_corners(values, of_corner))), {}});
    else
      samples.attributes.push_back(
          {store(archive, bytes_of_values(values)), store(archive, bytes_of_values(of_corner))});
  }
  for (std::size_t m = 0; m < surface.materials.size(); ++m)
    samples.face_sets.push_back(store(archive, bytes_of_values(faces_of(surface, m))));
}

}  // namespace

MeshFrame store_frame(Archive& archive, const CacheFrame& frame, const Mesh& mesh) {
  const Floats3 points = y_up(frame.x), velocities = y_up(frame.velocity),
                normals = y_up(frame.normal);
  const Triangles triangles = clockwise(frame.triangles);
  const Triangles normal_of_corner = clockwise(frame.normal_of_corner);
  const std::vector<std::int32_t> corners_of_faces(triangles.rows(), 3);
  const Floats2 uv = (frame.uv.cast<float>().array() + 0.0f).matrix();

  MeshFrame samples;
  samples.box = box_of(points);
  samples.bounds = store(archive, bytes_of_values(samples.box.sides));
  samples.points = store(archive, bytes_of_values(points));
  samples.velocities = store(archive, bytes_of_values(velocities));
  samples.normals = store(archive, bytes_of_values(normals));
  samples.normal_indices = store(archive, bytes_of_values(normal_of_corner));
  samples.colours = store(archive, bytes_of_values(colours(frame.crease)));
  samples.indices = store(archive, bytes_of_values(triangles));
  samples.counts = store(archive, bytes_of_values(corners_of_faces));
  samples.pattern = store(archive, bytes_of_values(uv));
  // the uv of a corner is that of its vertex: the indices equal the face indices, which are stored
  // already
  samples.pattern_indices = uv.rows() == 0 ? samples.pattern : samples.indices;
  if (!mesh.frames.empty() && mesh.surface == frame.surface) {
    samples.attributes = mesh.frames.back().attributes;
    samples.face_sets = mesh.frames.back().face_sets;
  } else if (frame.surface) {
    store_surface(archive, *frame.surface, samples);
  }
  return samples;
}

// ---- from samples to properties

namespace {

std::vector<Sample> column(const std::vector<MeshFrame>& frames, Sample MeshFrame::*channel) {
  std::vector<Sample> samples;
  for (const MeshFrame& frame : frames) samples.push_back(frame.*channel);
  return samples;
}

/// Whether any frame has the channel.
bool ever_given(const std::vector<MeshFrame>& frames, Sample MeshFrame::*channel) {
  return std::any_of(frames.begin(), frames.end(),
                     [&](const MeshFrame& f) { return (f.*channel).block != empty_data; });
}

/// A text that may stand in metadata and as a name in the archive.
std::string legal(std::string text) {
  constexpr std::size_t longest = 60;  // a metadata text has at most 255 bytes
  for (char& c : text)
    if (c == ';' || c == '=' || c == '/' || c == '\0') c = '_';
  return text.empty() ? "_" : text.substr(0, longest);
}

/// Values, and for each corner the index of its value.
Property indexed(const std::string& name, const std::string& metadata, std::uint32_t extent,
                 std::vector<Sample> values, std::vector<Sample> indices) {
  return compound(
      name, metadata,
      {animated(".vals", metadata, PropertyType::array, Pod::f32, extent, std::move(values)),
       animated(".indices", "", PropertyType::array, Pod::u32, 1, std::move(indices))});
}

Property uv_property(const std::string& name, const std::string& source, std::vector<Sample> values,
                     std::vector<Sample> indices) {
  const std::string metadata =
      parameter_metadata("fvr", "vector", 2) + ";sourceName=" + legal(source);
  return indexed(name, metadata, 2, std::move(values), std::move(indices));
}

/// Attribute n of the artist.
Property authored(const Mesh& mesh, std::size_t n, const std::string& property) {
  const MeshSurface::Attribute& attribute = mesh.surface->attributes[n];
  const auto width = static_cast<int>(attribute.values.cols());
  std::vector<Sample> values, indices;
  for (const MeshFrame& frame : mesh.frames) {
    values.push_back(frame.attributes[n][0]);
    indices.push_back(frame.attributes[n][1]);
  }
  if (attribute.kind == AttributeKind::uv)
    return uv_property(property, attribute.name, std::move(values), std::move(indices));
  if (is_list(attribute))
    return animated(property, parameter_metadata("fvr", "", 1, "float32_t", width),
                    PropertyType::array, Pod::f32, 1, std::move(values));
  const bool colour = attribute.kind == AttributeKind::colour;
  const char* means = width == 1 ? "" : !colour ? "vector" : width == 3 ? "rgb" : "rgba";
  return indexed(property, parameter_metadata("fvr", means, width),
                 static_cast<std::uint32_t>(width), std::move(values), std::move(indices));
}

/// Adds the attributes: the artist's first uv set as `uv`, and the others and the pattern to
/// `named`.
void add_attributes(const Mesh& mesh, std::vector<Property>& members,
                    std::vector<Property>& named) {
  const bool uv = mesh.surface && has_uv(mesh.surface->attributes);
  if (uv) members.push_back(authored(mesh, 0, "uv"));
  OwnNames own(names_of_caches());
  for (std::size_t n = uv; mesh.surface && n < mesh.surface->attributes.size(); ++n)
    named.push_back(authored(mesh, n, own(legal(mesh.surface->attributes[n].name))));
  if (!ever_given(mesh.frames, &MeshFrame::pattern)) return;
  const std::vector<Sample> values = column(mesh.frames, &MeshFrame::pattern),
                            indices = column(mesh.frames, &MeshFrame::pattern_indices);
  if (!uv) members.push_back(uv_property("uv", "UVMap", values, indices));
  named.push_back(uv_property("pattern", "pattern", values, indices));
}

/// The custom properties of the artist's object.
std::vector<Property> user_properties(Archive& archive, const AuthoredProperties& authored) {
  std::vector<Property> found;
  OwnNames own;
  const auto add = [&](const std::string& name, PropertyType type, Pod pod,
                       std::string_view bytes) {
    found.push_back(
        {own(legal(name)), "", type, pod, 1, TimeSampling::identity, {store(archive, bytes)}, {}});
  };
  for (const auto& [name, value] : authored)
    if (const auto* text = std::get_if<std::string>(&value))
      add(name, PropertyType::scalar, Pod::text, {text->c_str(), text->size() + 1});
    else if (const auto* list = std::get_if<std::vector<double>>(&value))
      add(name, PropertyType::array, Pod::f64, bytes_of_values(*list));
    else
      add(name, PropertyType::scalar, Pod::f64, bytes_of(std::get<double>(value)));
  return found;
}

Property geometry(Archive& archive, const Mesh& mesh) {
  const std::vector<MeshFrame>& frames = mesh.frames;
  const auto array = [&](const char* name, const std::string& metadata, Pod pod,
                         std::uint32_t extent, Sample MeshFrame::*channel) {
    return animated(name, metadata, PropertyType::array, pod, extent, column(frames, channel));
  };
  std::vector<Property> members{
      box_property(".selfBnds", column(frames, &MeshFrame::bounds)),
      array("P", point_metadata, Pod::f32, 3, &MeshFrame::points),
      array(".faceIndices", "", Pod::i32, 1, &MeshFrame::indices),
      array(".faceCounts", "", Pod::i32, 1, &MeshFrame::counts),
  };
  if (ever_given(frames, &MeshFrame::velocities))
    members.push_back(
        array(".velocities", "interpretation=vector", Pod::f32, 3, &MeshFrame::velocities));
  const std::string corner_normal = parameter_metadata("fvr", "normal", 3);
  if (ever_given(frames, &MeshFrame::normal_indices))
    members.push_back(compound("N", corner_normal,
                               {array(".vals", corner_normal, Pod::f32, 3, &MeshFrame::normals),
                                array(".indices", "", Pod::u32, 1, &MeshFrame::normal_indices)}));
  else if (ever_given(frames, &MeshFrame::normals))
    members.push_back(
        array("N", parameter_metadata("vtx", "normal", 3), Pod::f32, 3, &MeshFrame::normals));
  std::vector<Property> named;
  if (ever_given(frames, &MeshFrame::colours))
    named.push_back(
        array("crease", parameter_metadata("vtx", "rgba", 4), Pod::f32, 4, &MeshFrame::colours));
  add_attributes(mesh, members, named);
  if (!named.empty()) members.push_back(compound(".arbGeomParams", "", std::move(named)));
  if (mesh.surface && !mesh.surface->properties.empty())
    members.push_back(
        compound(".userProperties", "", user_properties(archive, mesh.surface->properties)));
  return compound(".geom", geometry_metadata(mesh_schema), std::move(members));
}

/// The faces of each material, below their mesh.
std::vector<Object> face_sets(const Mesh& mesh) {
  std::vector<Object> sets;
  OwnNames own;
  for (std::size_t m = 0; mesh.surface && m < mesh.surface->materials.size(); ++m) {
    std::vector<Sample> faces;
    for (const MeshFrame& frame : mesh.frames) faces.push_back(frame.face_sets[m]);
    std::vector<Property> members{
        box_property(".selfBnds", column(mesh.frames, &MeshFrame::bounds)),
        animated(".faces", "", PropertyType::array, Pod::i32, 1, std::move(faces))};
    sets.push_back({own(legal(mesh.surface->materials[m])),
                    object_metadata(face_set_schema, ".faceset"),
                    {compound(".faceset", geometry_metadata(face_set_schema), std::move(members))},
                    {}});
  }
  return sets;
}

/// The mesh below an Xform of its name.
Object sheet_object(Archive& archive, const Mesh& mesh) {
  return below_xform(archive, mesh.label, column(mesh.frames, &MeshFrame::bounds),
                     {mesh.label + "Shape",
                      object_metadata(mesh_schema),
                      {geometry(archive, mesh)},
                      face_sets(mesh)});
}

}  // namespace

Object archive_object(Archive& archive, const std::vector<Mesh>& meshes, std::size_t frames) {
  std::vector<Sample> bounds;
  for (std::size_t i = 0; i < frames; ++i) {
    Box box;
    for (const Mesh& mesh : meshes)
      if (!mesh.frames.empty())
        box = around(box, mesh.frames[std::min(i, mesh.frames.size() - 1)].box);
    bounds.push_back(store(archive, bytes_of_values(box.sides)));
  }
  Object root;
  if (frames > 0) root.properties.push_back(box_property(".childBnds", std::move(bounds)));
  for (const Mesh& mesh : meshes)
    if (!mesh.frames.empty()) root.children.push_back(sheet_object(archive, mesh));
  for (const Mesh& mesh : meshes)
    for (Object& guide : guide_objects(archive, mesh.guides, mesh.guide_labels))
      root.children.push_back(std::move(guide));
  return root;
}

}  // namespace paperbake::alembic
