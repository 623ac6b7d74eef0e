#include "formats/cache/usd_cache.h"

#include "formats/cache/material_faces.h"
#include "formats/cache/usd_layer.h"
#include "formats/files/own_names.h"

#include <algorithm>
#include <set>

namespace paperbake {
namespace {

using usd::FloatArray;
using usd::Prim;
using usd::Property;
using usd::Token;

constexpr float guide_width = 5e-4f;  // [m] as viewers draw points and curves

/// An attribute as its frames come.
struct Attribute {
  Property property;  // in the only layer, or in that of the asset
  Property moving;    // in the layer of the animation; without samples it is not there
  usd::Value first;   // in the first frame, to tell whether it changes
};

struct UsdSheet {
  std::string name, label;  // as given by the caller, as written to the file
  std::string points_label, folds_label, proxy_label;
  std::vector<Attribute> attributes;
  std::vector<Attribute> points, folds;        // of the guides
  std::vector<Attribute> proxy;                // of the coarser mesh
  std::vector<Attribute> subsets;              // faces of each material
  std::shared_ptr<const MeshSurface> surface;  // of the last frame; names are equal in all
  std::size_t frames = 0;
};

/// The characters that USD allows in all its versions.
std::string identifier(const std::string& name) {
  constexpr unsigned char goes_on = 0x80, mask = 0xc0;  // a byte of a character after its first
  std::string legal;
  for (const char c : name)
    if ((static_cast<unsigned char>(c) & mask) != goes_on)
      legal += (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ? c : '_';
  if (legal.empty() || (legal[0] >= '0' && legal[0] <= '9')) legal = "_" + legal;
  return legal;
}

/// The prims of a path, from the outermost.
std::vector<std::string> parts_of(const std::string& path) {
  std::vector<std::string> parts;
  for (std::size_t from = 0; from < path.size();) {
    const std::size_t slash = std::min(path.find('/', from), path.size());
    if (slash > from) parts.push_back(path.substr(from, slash - from));
    from = slash + 1;
  }
  return parts;
}

// ---- values; -0 becomes 0, so that equal values are stored once

FloatArray y_up(const Points3& rows) {
  FloatArray array{3, {}};
  array.values.reserve(static_cast<std::size_t>(rows.size()));
  for (Eigen::Index i = 0; i < rows.rows(); ++i)
    for (const double number : {rows(i, 0), rows(i, 2), -rows(i, 1)})
      array.values.push_back(static_cast<float>(number) + 0.0f);
  return array;
}

template <class Rows>
FloatArray floats(const Rows& rows) {
  static_assert(Rows::IsRowMajor);
  FloatArray array{static_cast<std::size_t>(rows.cols()), {}};
  array.values.reserve(static_cast<std::size_t>(rows.size()));
  for (Eigen::Index i = 0; i < rows.size(); ++i)
    array.values.push_back(static_cast<float>(rows.data()[i]) + 0.0f);
  return array;
}

FloatArray numbers(const Eigen::VectorXd& values) {
  FloatArray array{1, {}};
  for (const double value : values) array.values.push_back(static_cast<float>(value) + 0.0f);
  return array;
}

std::vector<int> integers(const Triangles& triangles) {
  return {triangles.data(), triangles.data() + triangles.size()};
}

Points3 corners_of_box(const Points3& x) {
  Points3 box(2, 3);  // y up negates the old y, so its upper bound belongs to the lower corner
  if (x.rows() == 0) return box.setZero();
  const Eigen::RowVector3d low = x.colwise().minCoeff(), high = x.colwise().maxCoeff();
  box << low.x(), high.y(), low.z(), high.x(), low.y(), high.z();
  return box;
}

/// Does an attribute belong to the layer of the animation also where it rests?
bool is_motion(const std::string& attribute) {
  static const std::set<std::string> motions{"extent", "normals", "points", "primvars:normals",
                                             "velocities"};
  return motions.count(attribute) > 0;
}

void append_properties(Prim& prim, const std::vector<Attribute>& attributes) {
  for (const Attribute& attribute : attributes)
    if (!attribute.property.samples.empty()) prim.properties.push_back(attribute.property);
}

/// What an animation layer says of a prim of the asset.
Prim over(const std::string& name, const std::vector<Attribute>& attributes) {
  Prim prim{"", name};
  for (const Attribute& attribute : attributes)
    if (!attribute.moving.samples.empty()) prim.properties.push_back(attribute.moving);
  return prim;
}

/// The names of the artist's attributes. The first uv set, which is `st` besides, may be called
/// that.
/// layers  further primvars of the mesh
std::vector<std::string> attribute_labels(const MeshSurface& surface,
                                          const std::vector<CacheLayer>& layers) {
  std::set<std::string> taken = names_of_caches();
  taken.insert({"st", "normals", "displayColor", "displayOpacity"});
  for (const CacheLayer& layer : layers) taken.insert(layer.name);
  OwnNames own(std::move(taken));
  std::vector<std::string> labels;
  for (const MeshSurface::Attribute& attribute : surface.attributes) {
    const std::string label = identifier(attribute.name);
    const bool first_uv = labels.empty() && attribute.kind == AttributeKind::uv;
    labels.push_back(first_uv && label == "st" ? label : own(label));
  }
  return labels;
}

/// "color4f[]"
std::string type_of(const MeshSurface::Attribute& attribute) {
  const std::string width = std::to_string(attribute.values.cols());
  if (attribute.kind == AttributeKind::uv) return "texCoord2f[]";
  if (attribute.kind == AttributeKind::colour) return "color" + width + "f[]";
  return width == "1" ? "float[]" : "float" + width + "[]";
}

/// The names of the subsets of faces of its materials.
std::vector<std::string> subset_labels(const MeshSurface& surface) {
  OwnNames own;
  std::vector<std::string> labels;
  for (const std::string& material : surface.materials) labels.push_back(own(identifier(material)));
  return labels;
}

bool has_one_material(const MeshSurface& surface) {
  return surface.materials.size() == 1 &&
         std::find(surface.material_of.begin(), surface.material_of.end(), -1) ==
             surface.material_of.end();
}

}  // namespace

struct UsdWriter::Impl {
  std::unique_ptr<usd::Encoder> encoder;              // of the only layer, or of that of the asset
  std::unique_ptr<usd::Encoder> animation, composer;  // null: there is one layer
  std::vector<std::string> sub_layers;                // of the composing one
  CacheInfo info;
  std::vector<UsdSheet> sheets;
  std::vector<std::pair<std::string, std::string>> materials;  // names, and those in the file

  Property constant(std::string type, std::string name, const usd::Value& value) {
    return {std::move(type), std::move(name), {}, false, false, {{0, encoder->store(value)}}};
  }

  Property uniform(std::string type, std::string name, const usd::Value& value) {
    Property property = constant(std::move(type), std::move(name), value);
    property.uniform = true;
    return property;
  }

  /// Adds the value that an attribute has in the present frame of the sheet.
  void add(const UsdSheet& sheet, std::vector<Attribute>& attributes, const Property& attribute,
           const usd::Value& value) {
    auto known = std::find_if(attributes.begin(), attributes.end(), [&](const Attribute& a) {
      return a.property.name == attribute.name;
    });
    if (known == attributes.end()) known = attributes.insert(known, {attribute, attribute, {}});
    add_sample(sheet, *known, value);
  }

  /// The same for one list of attributes of a sheet: (type, name, interpolation, value).
  auto adder(const UsdSheet& sheet, std::vector<Attribute>& attributes) {
    return [this, &sheet, &attributes](const char* type, const std::string& name,
                                       const char* interpolation, const usd::Value& value) {
      add(sheet, attributes, {type, name, interpolation}, value);
    };
  }

  long time_code(std::size_t frame) const {
    return info.first_frame + info.frame_step * static_cast<long>(frame);
  }

  void add_sample(const UsdSheet& sheet, Attribute& attribute, const usd::Value& value) {
    if (!animation)
      return attribute.property.samples.push_back({time_code(sheet.frames), encoder->store(value)});
    const std::string& name = attribute.property.name;
    if (sheet.frames == 0) {
      attribute.first = value;
      if (name != "velocities")  // an asset does not move
        attribute.property.samples = {{time_code(0), encoder->store(value)}};
    }
    std::vector<usd::TimeSample>& samples = attribute.moving.samples;
    if (samples.empty() && !is_motion(name) && value == attribute.first) return;
    while (samples.size() < sheet.frames)
      samples.push_back({time_code(samples.size()), animation->store(attribute.first)});
    samples.push_back({time_code(sheet.frames), animation->store(value)});
  }

  /// Adds attributes and materials of the artist.
  void add_surface(UsdSheet& sheet, const MeshSurface& surface,
                   const std::vector<CacheLayer>& layers) {
    const auto add_as = [&](const std::string& name, const MeshSurface::Attribute& attribute) {
      add(sheet, sheet.attributes, {type_of(attribute), "primvars:" + name, "faceVarying"},
          floats(attribute.values));
      add(sheet, sheet.attributes, {"int[]", "primvars:" + name + ":indices"},
          integers(attribute.of_corner));
    };
    const std::vector<std::string> labels = attribute_labels(surface, layers);
    if (has_uv(surface.attributes)) add_as("st", surface.attributes.front());
    for (std::size_t n = 0; n < surface.attributes.size(); ++n)
      if (labels[n] != "st") add_as(labels[n], surface.attributes[n]);
    for (std::size_t m = 0; m < surface.materials.size(); ++m) {
      const Property indices{"int[]", "indices"};
      if (m == sheet.subsets.size()) sheet.subsets.push_back({indices, indices, {}});
      add_sample(sheet, sheet.subsets[m], faces_of(surface, m));
    }
  }

  void name_materials() {
    OwnNames own;
    for (const UsdSheet& sheet : sheets)
      if (sheet.surface)
        for (const std::string& name : sheet.surface->materials)
          if (std::none_of(materials.begin(), materials.end(),
                           [&](const auto& known) { return known.first == name; }))
            materials.emplace_back(name, own(identifier(name)));
  }

  /// A material of the artist, which the layer has only the name of.
  std::string material_path(const std::string& material) const {
    const auto named = std::find_if(materials.begin(), materials.end(),
                                    [&](const auto& known) { return known.first == material; });
    return info.root + "/materials/" + named->second;
  }

  static Property relationship(std::string name, std::string target) {
    Property property;
    property.name = std::move(name);
    property.target = std::move(target);
    return property;
  }

  Property binding(const std::string& material) const {
    return relationship("material:binding", material_path(material));
  }

  void add_materials(std::vector<Prim>& prims) const {
    if (materials.empty()) return;
    Prim scope{"Scope", "materials"};
    for (const auto& [name, label] : materials)
      scope.children.push_back({"Material", label, "", name});
    std::sort(scope.children.begin(), scope.children.end(),
              [](const Prim& a, const Prim& b) { return a.name < b.name; });
    prims.push_back(std::move(scope));
  }

  void add_properties(Prim& mesh, const AuthoredProperties& properties) {
    OwnNames own;
    for (const auto& [key, value] : properties) {
      const std::string name = "userProperties:" + own(identifier(key));
      if (const auto* text = std::get_if<std::string>(&value))
        mesh.properties.push_back(constant("string", name, *text));
      else if (const auto* list = std::get_if<std::vector<double>>(&value))
        mesh.properties.push_back(constant("double[]", name, *list));
      else
        mesh.properties.push_back(constant("double", name, std::get<double>(value)));
      mesh.properties.back().custom = true;
    }
  }

  void bind_materials(Prim& mesh, const UsdSheet& sheet) {
    if (!sheet.surface || sheet.surface->materials.empty()) return;
    const std::vector<std::string>& materials = sheet.surface->materials;
    mesh.api_schemas = {"MaterialBindingAPI"};
    if (has_one_material(*sheet.surface)) {
      mesh.properties.push_back(binding(materials.front()));
      return;
    }
    mesh.properties.push_back(
        uniform("token", "subsetFamily:materialBind:familyType", Token{"nonOverlapping"}));
    const std::vector<std::string> labels = subset_labels(*sheet.surface);
    for (std::size_t m = 0; m < materials.size(); ++m) {
      Prim subset{"GeomSubset", labels[m]};
      subset.api_schemas = {"MaterialBindingAPI"};
      subset.properties = {uniform("token", "elementType", Token{"face"}),
                           uniform("token", "familyName", Token{"materialBind"}),
                           binding(materials[m]), sheet.subsets[m].property};
      mesh.children.push_back(std::move(subset));
    }
  }

  Prim mesh_of(const UsdSheet& sheet) {
    Prim mesh{"Mesh", sheet.label, "", sheet.name};
    mesh.properties = {uniform("token", "subdivisionScheme", Token{"none"}),
                       uniform("token", "orientation", Token{"rightHanded"}),
                       uniform("bool", "doubleSided", true)};
    if (animation) mesh.properties.push_back(uniform("token", "purpose", Token{"render"}));
    if (!sheet.proxy.empty())
      mesh.properties.push_back(relationship("proxyPrim", info.root + "/" + sheet.proxy_label));
    append_properties(mesh, sheet.attributes);
    if (sheet.surface) add_properties(mesh, sheet.surface->properties);
    bind_materials(mesh, sheet);
    return mesh;
  }

  void add_proxy(UsdSheet& sheet, const CacheProxy& proxy) {
    const auto add_to_proxy = adder(sheet, sheet.proxy);
    add_to_proxy("float3[]", "extent", "", y_up(corners_of_box(proxy.x)));
    add_to_proxy("int[]", "faceVertexCounts", "",
                 std::vector<int>(static_cast<std::size_t>(proxy.triangles.rows()), 3));
    add_to_proxy("int[]", "faceVertexIndices", "", integers(proxy.triangles));
    add_to_proxy("point3f[]", "points", "", y_up(proxy.x));
  }

  Prim proxy_of(const UsdSheet& sheet) {
    Prim mesh{"Mesh", sheet.proxy_label};
    mesh.properties = {uniform("token", "subdivisionScheme", Token{"none"}),
                       uniform("token", "orientation", Token{"rightHanded"}),
                       uniform("bool", "doubleSided", true),
                       uniform("token", "purpose", Token{"proxy"})};
    append_properties(mesh, sheet.proxy);
    return mesh;
  }

  void add_guides(UsdSheet& sheet, const CacheGuides& guides) {
    const auto point = adder(sheet, sheet.points), fold = adder(sheet, sheet.folds);
    point("float3[]", "extent", "", y_up(corners_of_box(guides.points)));
    point("point3f[]", "points", "", y_up(guides.points));
    point("int[]", "primvars:point_id", "vertex", guides.point_id);
    point("int[]", "primvars:birth", "vertex", guides.point_birth);
    fold("float3[]", "extent", "", y_up(corners_of_box(guides.folds)));
    fold("point3f[]", "points", "", y_up(guides.folds));
    fold("int[]", "curveVertexCounts", "", guides.fold_size);
    fold("int[]", "primvars:fold_id", "uniform", guides.fold_id);
    fold("int[]", "primvars:birth", "uniform", guides.fold_birth);
    fold("float[]", "primvars:angle", "vertex", numbers(guides.angle));
  }

  void append_guides(std::vector<Prim>& prims, const UsdSheet& sheet) {
    if (sheet.points.empty()) return;
    Prim points{"Points", sheet.points_label}, folds{"BasisCurves", sheet.folds_label};
    append_properties(points, sheet.points);
    append_properties(folds, sheet.folds);
    folds.properties.push_back(uniform("token", "type", Token{"linear"}));
    folds.properties.push_back(uniform("token", "wrap", Token{"nonperiodic"}));
    for (Prim* prim : {&points, &folds}) {
      Property width = constant("float[]", "widths", FloatArray{1, {guide_width}});
      width.interpolation = "constant";
      prim->properties.push_back(width);
      prim->properties.push_back(uniform("token", "purpose", Token{"guide"}));
      prims.push_back(std::move(*prim));
    }
  }

  /// The prims of the path `root`, the innermost with these children.
  Prim below_root(std::vector<Prim> children) const {
    const std::vector<std::string> names = parts_of(info.root);
    Prim prim{"Xform", names.back(), "component"};
    prim.children = std::move(children);
    for (auto name = names.rbegin() + 1; name < names.rend(); ++name) {
      Prim parent{"Xform", *name, "group"};
      parent.children.push_back(std::move(prim));
      prim = std::move(parent);
    }
    return prim;
  }

  /// The same as overs.
  Prim over_root(std::vector<Prim> children) const {
    const std::vector<std::string> names = parts_of(info.root);
    for (auto name = names.rbegin(); name < names.rend(); ++name) {
      Prim prim{"", *name};
      prim.children = std::move(children);
      children = {std::move(prim)};
    }
    return children.front();
  }

  std::vector<Prim> prims() {
    std::vector<Prim> all;
    name_materials();
    for (const UsdSheet& sheet : sheets)
      if (sheet.frames > 0) all.push_back(mesh_of(sheet));
    for (const UsdSheet& sheet : sheets)
      if (!sheet.proxy.empty()) all.push_back(proxy_of(sheet));
    for (const UsdSheet& sheet : sheets) append_guides(all, sheet);
    add_materials(all);
    return all;
  }

  /// The prims of the animation layer.
  std::vector<Prim> overs() const {
    std::vector<Prim> all;
    for (const UsdSheet& sheet : sheets) {
      if (sheet.frames == 0) continue;
      all.push_back(over(sheet.label, sheet.attributes));
      for (std::size_t m = 0; m < sheet.subsets.size(); ++m)
        if (!sheet.subsets[m].moving.samples.empty())
          all.back().children.push_back(over(subset_labels(*sheet.surface)[m], {sheet.subsets[m]}));
      if (!sheet.proxy.empty()) all.push_back(over(sheet.proxy_label, sheet.proxy));
      if (sheet.points.empty()) continue;
      all.push_back(over(sheet.points_label, sheet.points));
      all.push_back(over(sheet.folds_label, sheet.folds));
    }
    return all;
  }

  /// What all layers say of the shot.
  usd::Layer empty_layer() const {
    usd::Layer layer;
    std::size_t frames = 0;
    for (const UsdSheet& sheet : sheets) frames = std::max(frames, sheet.frames);
    for (const auto& [key, value] : info.metadata)
      layer.metadata.push_back({identifier(key), value});
    layer.fps = info.fps;
    layer.first_frame = info.first_frame;
    layer.last_frame = time_code(frames ? frames - 1 : 0);
    return layer;
  }
};

std::filesystem::path usd_part_path(const std::filesystem::path& path, const std::string& part) {
  const std::filesystem::path extension = path.extension();
  return std::filesystem::path(path).replace_extension().concat("." + part) += extension;
}

UsdWriter::UsdWriter(const std::filesystem::path& path, UsdEncoding encoding, const CacheInfo& info,
                     const std::vector<std::string>& sheet_names, UsdLayers layers)
    : impl_(new Impl) {
  const auto make_encoder =
      encoding == UsdEncoding::text ? usd::make_text_encoder : usd::make_crate_encoder;
  impl_->info = info;
  if (layers == UsdLayers::separate) {
    const std::filesystem::path asset = usd_part_path(path, "asset"),
                                animation = usd_part_path(path, "animation");
    impl_->encoder = make_encoder(asset);
    impl_->animation = make_encoder(animation);
    impl_->composer = make_encoder(path);
    impl_->sub_layers = {animation.filename().string(), asset.filename().string()};
  } else {
    impl_->encoder = make_encoder(path);
  }
  OwnNames own;
  for (const std::string& name : sheet_names) {
    UsdSheet sheet;
    sheet.name = name;
    sheet.label = own(identifier(name));
    impl_->sheets.push_back(std::move(sheet));
  }
  for (UsdSheet& sheet : impl_->sheets) {
    sheet.points_label = own(sheet.label + "_points");
    sheet.folds_label = own(sheet.label + "_folds");
    sheet.proxy_label = own(sheet.label + "_proxy");
  }
}

UsdWriter::~UsdWriter() = default;

void UsdWriter::add_frame(std::size_t number, const CacheFrame& frame) {
  UsdSheet& sheet = impl_->sheets.at(number);
  const auto add = impl_->adder(sheet, sheet.attributes);
  add("float3[]", "extent", "", y_up(corners_of_box(frame.x)));
  add("int[]", "faceVertexCounts", "",
      std::vector<int>(static_cast<std::size_t>(frame.triangles.rows()), 3));
  add("int[]", "faceVertexIndices", "", integers(frame.triangles));
  add("point3f[]", "points", "", y_up(frame.x));
  if (frame.velocity.rows() > 0) add("vector3f[]", "velocities", "", y_up(frame.velocity));
  if (frame.normal_of_corner.rows() > 0) {
    add("normal3f[]", "primvars:normals", "faceVarying", y_up(frame.normal));
    add("int[]", "primvars:normals:indices", "", integers(frame.normal_of_corner));
  } else if (frame.normal.rows() > 0) {
    add("normal3f[]", "normals", "vertex", y_up(frame.normal));
  }
  if (frame.crease.size() > 0) add("float[]", "primvars:crease", "vertex", numbers(frame.crease));
  for (const CacheLayer& layer : frame.layers)
    add("float[]", "primvars:" + layer.name, "vertex", numbers(layer.values));
  if (frame.uv.rows() > 0) {
    add("texCoord2f[]", "primvars:pattern", "vertex", floats(frame.uv));
    if (!frame.surface || !has_uv(frame.surface->attributes))
      add("texCoord2f[]", "primvars:st", "vertex", floats(frame.uv));
  }
  if (frame.surface && frame.surface != sheet.surface)
    impl_->add_surface(sheet, *frame.surface, frame.layers);
  sheet.surface = frame.surface;
  if (frame.guides) impl_->add_guides(sheet, *frame.guides);
  if (frame.proxy && impl_->animation) impl_->add_proxy(sheet, *frame.proxy);
  ++sheet.frames;
}

void UsdWriter::finish() {
  usd::Layer layer = impl_->empty_layer();
  layer.root = impl_->below_root(impl_->prims());
  impl_->encoder->finish(layer);
  if (!impl_->animation) return;
  layer.root = impl_->over_root(impl_->overs());
  impl_->animation->finish(layer);
  layer.root = impl_->over_root({});
  layer.sub_layers = impl_->sub_layers;
  impl_->composer->finish(layer);
}

}  // namespace paperbake
