#include "formats/cache/usd_cache.h"

#include "core/model/error.h"
#include "formats/files/atomic_file.h"

#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <iterator>
#include <map>
#include <set>

namespace paperbake {
namespace {

/// Text that is kept in a temporary file until it can be written to the layer.
class Spool {
 public:
  Spool() : file_(std::tmpfile()) {
    if (!file_)
      throw Error(
          ErrorCode::folder, "temporary files", "A temporary file cannot be created.",
          "Check free space and write permission of the folder for temporary files (TMPDIR).");
  }
  ~Spool() { std::fclose(file_); }
  Spool(const Spool&) = delete;
  Spool& operator=(const Spool&) = delete;

  void write(std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), file_) != text.size())
      throw Error(
          ErrorCode::folder, "temporary files", "A temporary file cannot be written.",
          "Check free space and write permission of the folder for temporary files (TMPDIR).");
  }
  void copy_to(AtomicFile& out) {
    std::rewind(file_);
    char buffer[1 << 16];
    while (const std::size_t count = std::fread(buffer, 1, sizeof buffer, file_))
      out.write(buffer, count);
  }

 private:
  std::FILE* file_;
};

/// An attribute of a mesh over time.
struct Attribute {
  std::string declaration, interpolation;  // "point3f[] points"; "vertex" or empty
  std::string first;                       // value in the first frame
  bool varies = false;
  std::unique_ptr<Spool> samples = std::make_unique<Spool>();
};

struct UsdSheet {
  std::string name, label;  // as given by the caller, as written to the file
  std::vector<Attribute> attributes;
  std::vector<Attribute> subsets;              // faces of each material
  std::shared_ptr<const MeshSurface> surface;  // of the last frame; names are equal in all
  std::size_t frames = 0;
};

std::string identifier(const std::string& name) {
  std::string legal;
  for (const char c : name)
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

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text)
    if (c == '"' || c == '\\')
      result += {'\\', c};
    else
      result += c == '\n' ? "\\n" : c >= 0 && c < ' ' ? " " : std::string(1, c);
  return result + '"';
}

/// [(x, y, z), ...] with y up; each number has the fewest digits that read back as the same 32-bit
/// float.
std::string vectors(const Points3& rows) {
  std::string text = "[";
  auto out = std::back_inserter(text);
  for (Eigen::Index i = 0; i < rows.rows(); ++i)
    fmt::format_to(out, "{}({}, {}, {})", i ? ", " : "", float(rows(i, 0)) + 0.0f,
                   float(rows(i, 2)) + 0.0f, float(-rows(i, 1)) + 0.0f);
  return text + "]";
}

std::string pairs(const Points2& rows) {
  std::string text = "[";
  auto out = std::back_inserter(text);
  for (Eigen::Index i = 0; i < rows.rows(); ++i)
    fmt::format_to(out, "{}({}, {})", i ? ", " : "", float(rows(i, 0)) + 0.0f,
                   float(rows(i, 1)) + 0.0f);
  return text + "]";
}

std::string numbers(const Eigen::VectorXd& values) {
  std::string text = "[";
  auto out = std::back_inserter(text);
  for (Eigen::Index i = 0; i < values.size(); ++i)
    fmt::format_to(out, "{}{}", i ? ", " : "", float(values[i]) + 0.0f);
  return text + "]";
}

std::string integers(const Triangles& triangles) {
  std::string text = "[";
  auto out = std::back_inserter(text);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t)
    fmt::format_to(out, "{}{}, {}, {}", t ? ", " : "", triangles(t, 0), triangles(t, 1),
                   triangles(t, 2));
  return text + "]";
}

/// The faces that have a material.
std::string faces_of(const MeshSurface& surface, std::size_t material) {
  std::string text = "[";
  auto out = std::back_inserter(text);
  for (std::size_t t = 0; t < surface.material_of.size(); ++t)
    if (surface.material_of[t] == static_cast<int>(material))
      fmt::format_to(out, "{}{}", text.size() > 1 ? ", " : "", t);
  return text + "]";
}

std::string threes(Eigen::Index count) {
  std::string text = "[";
  for (Eigen::Index t = 0; t < count; ++t) text += t ? ", 3" : "3";
  return text + "]";
}

Points3 corners_of_box(const Points3& x) {
  Points3 box(2, 3);  // y up negates the old y, so its upper bound belongs to the lower corner
  if (x.rows() == 0) return box.setZero();
  const Eigen::RowVector3d low = x.colwise().minCoeff(), high = x.colwise().maxCoeff();
  box << low.x(), high.y(), low.z(), high.x(), low.y(), high.z();
  return box;
}

}  // namespace

struct UsdWriter::Impl {
  AtomicFile file;
  CacheInfo info;
  std::vector<UsdSheet> sheets;

  void add(UsdSheet& sheet, const std::string& declaration, const std::string& interpolation,
           std::string value) {
    auto known = std::find_if(sheet.attributes.begin(), sheet.attributes.end(),
                              [&](const Attribute& a) { return a.declaration == declaration; });
    if (known == sheet.attributes.end()) {
      known = sheet.attributes.insert(known, {declaration, interpolation, value});
    }
    add_sample(sheet, *known, value);
  }

  void add_sample(const UsdSheet& sheet, Attribute& attribute, const std::string& value) {
    if (value != attribute.first) attribute.varies = true;
    const long frame = info.first_frame + info.frame_step * static_cast<long>(sheet.frames);
    attribute.samples->write(fmt::format("            {}: {},\n", frame, value));
  }

  /// Adds uv sets and materials of the artist.
  void add_surface(UsdSheet& sheet, const MeshSurface& surface) {
    const auto add_uv = [&](const std::string& name, const MeshSurface::UvSet& set) {
      add(sheet, "texCoord2f[] primvars:" + name, "faceVarying", pairs(set.uv));
      add(sheet, "int[] primvars:" + name + ":indices", "", integers(set.of_corner));
    };
    for (std::size_t n = 0; n < surface.uv_sets.size(); ++n) {
      const std::string name = identifier(surface.uv_sets[n].name);
      if (n == 0) add_uv("st", surface.uv_sets[n]);
      if (name != "st") add_uv(name, surface.uv_sets[n]);
    }
    for (std::size_t m = 0; m < surface.materials.size(); ++m) {
      const std::string faces = faces_of(surface, m);
      if (m == sheet.subsets.size()) sheet.subsets.push_back({"int[] indices", "", faces});
      add_sample(sheet, sheet.subsets[m], faces);
    }
  }

  /// A material of the artist, which the layer has only the name of.
  std::string material_path(const std::string& material) const {
    return "<" + info.root + "/materials/" + identifier(material) + ">";
  }

  static bool has_one_material(const MeshSurface& surface) {
    return surface.materials.size() == 1 &&
           std::find(surface.material_of.begin(), surface.material_of.end(), -1) ==
               surface.material_of.end();
  }

  void write_materials() {
    std::map<std::string, std::string> all;
    for (const UsdSheet& sheet : sheets)
      if (sheet.surface)
        for (const std::string& name : sheet.surface->materials)
          all.emplace(identifier(name), name);
    if (all.empty()) return;
    file.write("    def Scope \"materials\"\n    {\n");
    for (const auto& [label, name] : all)
      file.write(fmt::format(
          "        def Material \"{}\" (\n            displayName = {}\n        )\n        {{\n"
          "        }}\n",
          label, paperbake::quoted(name)));
    file.write("    }\n");
  }

  void write_properties(const AuthoredProperties& properties) {
    for (const auto& [key, value] : properties) {
      const std::string name = "userProperties:" + identifier(key);
      if (const auto* text = std::get_if<std::string>(&value))
        file.write(fmt::format("        custom string {} = {}\n", name, paperbake::quoted(*text)));
      else if (const auto* list = std::get_if<std::vector<double>>(&value))
        file.write(
            fmt::format("        custom double[] {} = [{}]\n", name, fmt::join(*list, ", ")));
      else
        file.write(fmt::format("        custom double {} = {}\n", name, std::get<double>(value)));
    }
  }

  void write_binding(UsdSheet& sheet) {
    if (!sheet.surface || sheet.surface->materials.empty()) return;
    const std::vector<std::string>& materials = sheet.surface->materials;
    if (has_one_material(*sheet.surface))
      return file.write(
          fmt::format("        rel material:binding = {}\n", material_path(materials.front())));
    file.write("        uniform token subsetFamily:materialBind:familyType = \"nonOverlapping\"\n");
    for (std::size_t m = 0; m < materials.size(); ++m) {
      file.write(
          fmt::format("        def GeomSubset \"{}\" (\n            prepend apiSchemas = "
                      "[\"MaterialBindingAPI\"]\n        )\n        {{\n        uniform "
                      "token elementType = \"face\"\n        uniform token familyName = "
                      "\"materialBind\"\n        rel material:binding = {}\n",
                      identifier(materials[m]), material_path(materials[m])));
      write(sheet.subsets[m]);
      file.write("        }\n");
    }
  }

  void write_mesh(UsdSheet& sheet) {
    const bool bound = sheet.surface && !sheet.surface->materials.empty();
    file.write(fmt::format("    def Mesh \"{}\" (\n        displayName = {}\n{}    )\n    {{\n",
                           sheet.label, paperbake::quoted(sheet.name),
                           bound ? "        prepend apiSchemas = [\"MaterialBindingAPI\"]\n" : ""));
    file.write(
        "        uniform token subdivisionScheme = \"none\"\n        uniform token orientation = "
        "\"rightHanded\"\n        uniform bool doubleSided = 1\n");
    for (Attribute& attribute : sheet.attributes) write(attribute);
    if (sheet.surface) write_properties(sheet.surface->properties);
    write_binding(sheet);
    file.write("    }\n");
  }

  void write(Attribute& attribute) {
    const std::string& d = attribute.declaration;
    const std::string meaning =
        attribute.interpolation.empty()
            ? ""
            : fmt::format(" (\n            interpolation = \"{}\"\n        )",
                          attribute.interpolation);
    if (!attribute.varies)
      return file.write(fmt::format("        {} = {}{}\n", d, attribute.first, meaning));
    if (!meaning.empty()) file.write(fmt::format("        {}{}\n", d, meaning));
    file.write(fmt::format("        {}.timeSamples = {{\n", d));
    attribute.samples->copy_to(file);
    file.write("        }\n");
  }
};

UsdWriter::UsdWriter(const std::filesystem::path& path, const CacheInfo& info,
                     const std::vector<std::string>& sheet_names)
    : impl_(new Impl{AtomicFile(path), info, {}}) {
  std::set<std::string> taken;
  for (const std::string& name : sheet_names) {
    std::string label = identifier(name);
    for (int n = 2; !taken.insert(label).second; ++n)
      label = identifier(name) + "_" + std::to_string(n);
    UsdSheet sheet;
    sheet.name = name;
    sheet.label = label;
    impl_->sheets.push_back(std::move(sheet));
  }
}

UsdWriter::~UsdWriter() = default;

void UsdWriter::add_frame(std::size_t number, const CacheFrame& frame) {
  UsdSheet& sheet = impl_->sheets.at(number);
  const auto add = [&](const char* declaration, const char* interpolation, std::string value) {
    impl_->add(sheet, declaration, interpolation, std::move(value));
  };
  add("float3[] extent", "", vectors(corners_of_box(frame.x)));
  add("int[] faceVertexCounts", "", threes(frame.triangles.rows()));
  add("int[] faceVertexIndices", "", integers(frame.triangles));
  add("point3f[] points", "", vectors(frame.x));
  if (frame.velocity.rows() > 0) add("vector3f[] velocities", "", vectors(frame.velocity));
  if (frame.normal_of_corner.rows() > 0) {
    add("normal3f[] primvars:normals", "faceVarying", vectors(frame.normal));
    add("int[] primvars:normals:indices", "", integers(frame.normal_of_corner));
  } else if (frame.normal.rows() > 0) {
    add("normal3f[] normals", "vertex", vectors(frame.normal));
  }
  if (frame.crease.size() > 0) add("float[] primvars:crease", "vertex", numbers(frame.crease));
  for (const CacheLayer& layer : frame.layers)
    add(("float[] primvars:" + layer.name).c_str(), "vertex", numbers(layer.values));
  if (frame.uv.rows() > 0) {
    const std::string pattern = pairs(frame.uv);
    add("texCoord2f[] primvars:pattern", "vertex", pattern);
    if (!frame.surface || frame.surface->uv_sets.empty())
      add("texCoord2f[] primvars:st", "vertex", pattern);
  }
  if (frame.surface && frame.surface != sheet.surface) impl_->add_surface(sheet, *frame.surface);
  sheet.surface = frame.surface;
  ++sheet.frames;
}

void UsdWriter::finish() {
  AtomicFile& file = impl_->file;
  const CacheInfo& info = impl_->info;
  std::size_t frames = 0;
  for (const UsdSheet& sheet : impl_->sheets) frames = std::max(frames, sheet.frames);
  std::string metadata;
  for (const auto& [key, value] : info.metadata)
    metadata += fmt::format("        string {} = {}\n", identifier(key), quoted(value));
  const std::vector<std::string> prims = parts_of(info.root);
  file.write(fmt::format(
      "#usda 1.0\n(\n    customLayerData = {{\n{}    }}\n    defaultPrim = \"{}\"\n    "
      "endTimeCode = {}\n    framesPerSecond = {}\n"
      "    metersPerUnit = 1\n    startTimeCode = {}\n    timeCodesPerSecond = {}\n    upAxis = "
      "\"Y\"\n)\n",
      metadata, prims.front(),
      info.first_frame + info.frame_step * (frames ? static_cast<long>(frames) - 1 : 0), info.fps,
      info.first_frame, info.fps));
  for (const std::string& prim : prims)
    file.write(fmt::format("\ndef Xform \"{}\" (\n    kind = \"{}\"\n)\n{{\n", prim,
                           &prim == &prims.back() ? "component" : "group"));
  for (UsdSheet& sheet : impl_->sheets)
    if (sheet.frames > 0) impl_->write_mesh(sheet);
  impl_->write_materials();
  for (std::size_t k = 0; k < prims.size(); ++k) file.write("}\n");
  file.commit();
}

}  // namespace paperbake
