#include "formats/scene/scene_sheets.h"

#include "core/geometry/measure.h"
#include "core/model/error.h"
#include "core/model/paper.h"
#include "formats/config/preset_file.h"
#include "formats/files/own_names.h"
#include "formats/scene/flat_sheet.h"
#include "formats/scene/scene_deformation.h"
#include "formats/scene/scene_properties.h"
#include "formats/scene/scene_unroll.h"
#include "formats/scene/sheet_rules.h"
#include "formats/scene/sheet_size.h"
#include "formats/scene/welded_mesh.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

namespace paperbake {
namespace {

/// Caches hold positions as numbers of 32 bits, whose distance grows with the distance from the
/// origin. Warns where it is more than a fortieth of the shortest edges of a render mesh.
void warn_of_distance(const std::string& name, const Points3& x,
                      std::vector<std::string>& warnings) {
  constexpr double coarse = 1e-6;  // [m]
  const auto farthest = static_cast<float>(x.cwiseAbs().maxCoeff());
  const double step = std::nextafter(farthest, 2 * farthest) - farthest;
  if (!(step > coarse)) return;
  warnings.push_back(
      fmt::format("The sheet \"{}\" is {:.0f} m away from the origin. Positions in a cache are "
                  "numbers of 32 bits, which are {:.2g} mm apart there: creases and close layers "
                  "become rough. Bake the shot within 16 m of the origin, and move the cache back "
                  "in the scene.",
                  name, max_row_norm(x), 1e3 * step));
}

/// The lines NAME=name of a property, or NAME alone where that is the name to have.
std::map<std::string, std::string> names_in(const std::optional<std::string>& property) {
  std::map<std::string, std::string> names;
  std::istringstream lines(property.value_or(""));
  for (std::string line; std::getline(lines, line);) {
    const std::size_t equals = line.find('=');
    const std::string read = line.substr(0, equals);
    names.emplace(read, equals == std::string::npos ? read : line.substr(equals + 1));
  }
  return names;
}

/// Names that the file does not have, and what is a colour there, as properties of the sheet tell
/// them: glTF has no names for uv sets and colours, and those of other attributes in capitals.
void name_attributes(const ImportedNode& node, AuthoredSurface& authored) {
  std::istringstream uv_sets(text_property(node, "paper_uv_sets").value_or(""));
  const auto colours = names_in(text_property(node, "paper_colours")),
             others = names_in(text_property(node, "paper_attributes"));
  for (AuthoredAttribute& attribute : authored.attributes) {
    if (attribute.kind == AttributeKind::uv) {
      if (std::string name; std::getline(uv_sets, name) && !name.empty()) attribute.name = name;
    } else if (const auto colour = colours.find(attribute.name);
               colour != colours.end() && attribute.values.cols() >= 3) {
      attribute.kind = AttributeKind::colour;
      attribute.name = colour->second;
    } else if (const auto other = others.find(attribute.name); other != others.end()) {
      attribute.name = other->second;
    }
  }
  OwnNames own(names_of_caches());
  for (AuthoredAttribute& attribute : authored.attributes) attribute.name = own(attribute.name);
}

/// The number that a sheet gives for a parameter of its paper; nothing without that property.
std::optional<double> paper_property(const SceneNodes& scene, const ImportedNode& node,
                                     const std::string& key, const PaperParameter& parameter) {
  const auto number = number_property(scene.source, node, key);
  if (number && !parameter.accepts(*number))
    throw Error(ErrorCode::scene, place_of(scene.source, "sheet", node.name) + ", " + key,
                out_of_bounds(parameter, *number), unit_remedy(parameter, *number));
  return number;
}

/// Sets what the properties of its node say of the paper of a sheet.
void read_paper(const SceneNodes& scene, const ImportedNode& node, SceneSheet& sheet) {
  const std::string place = place_of(scene.source, "sheet", node.name);
  sheet.preset = text_property(node, "paper_preset");
  sheet.grammage = paper_property(scene, node, "paper_gsm", grammage_parameter);
  sheet.thickness = paper_property(scene, node, "paper_thickness", paper_parameter("thickness"));
  sheet.friction = nonnegative_property(scene.source, node, "paper_friction");
  if (sheet.friction && *sheet.friction > max_friction)
    throw Error(ErrorCode::scene, place, fmt::format("paper_friction is {}.", *sheet.friction),
                fmt::format("It must be a number from 0 to {}; paper on paper has about 0.4.",
                            max_friction));
  if (const auto seed = whole_property(scene.source, node, "paper_seed")) {
    if (*seed < 0)
      throw Error(ErrorCode::scene, place, fmt::format("paper_seed is {}.", *seed),
                  "It must be a whole number of at least 0.");
    sheet.seed = static_cast<unsigned>(*seed);
  }
}

/// The sheet as it was modelled, without bones and blend shapes.
/// world  of every node at the first frame
FlatSheet undeformed_sheet(const SceneNodes& scene, int index,
                           const std::vector<Eigen::Affine3d>& world, const std::string& place) {
  return flat_sheet(scene.file, index, world[index],
                    combined_mesh(scene.file, index, world[index]).x, place);
}

/// The sheet as bones and blend shapes put it at the first frame. The pattern is that of the sheet
/// as it was modelled, where its lengths are kept, else that of the shape itself.
/// world  of every node at the first frame
FlatSheet deformed_sheet(const SceneNodes& scene, int index,
                         const std::vector<Eigen::Affine3d>& world, const std::string& place) {
  const Points3 x = vertices_at(scene, index, world, scene.first_frame);
  if (!x.allFinite())
    throw Error(ErrorCode::scene, place, "A vertex is moved beyond all numbers.", export_again);
  try {
    FlatSheet flat = undeformed_sheet(scene, index, world, place);
    flat.start.x = x(flat.kept, Eigen::all);
    if (keeps_lengths({flat.start.x, {}, flat.start.triangles}, flat.start.pattern)) return flat;
  } catch (const Error&) {  // what was modelled need not be a sheet
  }
  return flat_sheet(scene.file, index, world[index], x, place);
}

/// The sheet with which the shot begins. Warns where bones and blend shapes are not followed.
/// world  of every node at the first frame
/// sheet  its `deformed` is set
FlatSheet flat_sheet_at_start(const SceneNodes& scene, int index,
                              const std::vector<Eigen::Affine3d>& world, SceneSheet& sheet,
                              std::vector<std::string>& warnings) {
  const ImportedNode& node = scene.file.nodes[index];
  const std::string place = place_of(scene.source, "sheet", node.name);
  if (const std::string what = not_followed(scene.file, node); !what.empty())
    warnings.push_back(fmt::format(
        "{} of the sheet \"{}\" is not followed: it starts without. Apply the deformation that it "
        "has at frame {} to the mesh in the DCC and export again.",
        what, node.name, scene.first_frame));
  if (!is_deformed(scene.file, node)) return undeformed_sheet(scene, index, world, place);
  try {
    FlatSheet flat = deformed_sheet(scene, index, world, place);
    sheet.deformed = true;
    return flat;
  } catch (const Error& error) {
    warnings.push_back(fmt::format(
        "Bones or blend shapes give the sheet \"{}\" at frame {} a shape that paper does not have: "
        "it starts undeformed. {} Bend it without stretch, or apply the deformation to the mesh in "
        "the DCC, correct the mesh and export again.",
        node.name, scene.first_frame, error.cause));
    return undeformed_sheet(scene, index, world, place);
  }
}

SceneSheet read_sheet(const SceneNodes& scene, int index, const std::vector<Eigen::Affine3d>& world,
                      const SceneOptions& options, const AppliedOverrides& overrides,
                      std::vector<std::string>& warnings) {
  const ImportedNode& node = scene.file.nodes[index];
  SceneSheet sheet;
  FlatSheet flat = flat_sheet_at_start(scene, index, world, sheet, warnings);
  if (flat.joined_cuts > 0)
    warnings.push_back(fmt::format(
        "At {} {} of the sheet \"{}\" the faces have vertices of their own, as at a cut, but in "
        "one place: they are joined. To keep a cut, move its sides apart at frame {}, be it by a "
        "hundredth of a millimetre.",
        flat.joined_cuts, flat.joined_cuts == 1 ? "edge" : "edges", node.name, scene.first_frame));
  sheet.name = node.name;
  sheet.pattern = std::move(flat.pattern);
  sheet.start = std::move(flat.start);
  sheet.authored = std::move(flat.authored);
  for (const auto& [key, value] : node.properties)
    if (key.rfind("paper_", 0) != 0) sheet.authored.properties.emplace(key, value);
  name_attributes(node, sheet.authored);
  check_size(scene, node, extent(sheet.pattern), options, warnings);
  warn_of_distance(sheet.name, sheet.start.x, warnings);
  read_paper(scene, node, sheet);
  for (const char* key : {"preset", "gsm", "thickness", "friction", "seed"})
    if (overrides.places.count(std::string("paper_") + key)) sheet.overridden.insert(key);
  sheet.singular_point_rules = overrides.singular_point_rules;
  sheet.pattern.prescribed_creases = with_ends_on_border(overrides.creases, sheet.pattern);
  check_rules(sheet.singular_point_rules, sheet.pattern, overrides.rules_place, node.name);
  sheet.crease_origin.assign(sheet.pattern.prescribed_creases.size(), "job");
  return sheet;
}

[[noreturn]] void reject_without_sheet(const SceneNodes& scene) {
  std::vector<std::string> meshes;
  for (const ImportedNode& node : scene.file.nodes) {
    if (node.meshes.empty()) continue;
    if (name_begins_with(node.name, "paper"))
      throw Error(ErrorCode::scene, place_of(scene.source, "node", node.name),
                  "The scene has no sheet: this mesh is named like one, but it is ignored.",
                  "Take its property paper_ignore away.");
    if (name_begins_with(instanced_name(node.name), "paper"))
      throw Error(ErrorCode::scene, place_of(scene.source, "node", node.name),
                  "The scene has no sheet: this mesh is the instance of a collection.",
                  realise_instances);
    if (meshes.size() < 8) meshes.push_back('"' + node.name + '"');
  }
  throw Error(ErrorCode::scene, scene.source,
              "The scene has no sheet: no mesh whose name starts with \"paper\".",
              meshes.empty() ? "It has no mesh at all: was the sheet exported?"
                             : fmt::format("Rename the mesh that is the sheet; the meshes are {}.",
                                           fmt::join(meshes, ", ")));
}

bool is_named_sheet(const ImportedNode& node) {
  return !node.meshes.empty() && name_begins_with(node.name, "paper") &&
         !flag_property(node, "paper_ignore");
}

/// The error of a mesh that is taken for a sheet because of its name.
Error taken_for_sheet(const Error& error) {
  return Error(error.code, error.place, error.cause,
               error.remedy +
                   " Or, if it is no sheet: it is taken for one because its name begins "
                   "with \"paper\"; rename it, or give it the property paper_ignore.");
}

}  // namespace

std::vector<SceneSheet> read_sheets(const SceneNodes& scene, const SceneOptions& options,
                                    const std::vector<AppliedOverrides>& overrides,
                                    std::vector<std::string>& warnings) {
  const auto world = world_at(scene, scene.first_frame);
  std::vector<SceneSheet> sheets;
  std::optional<Error> no_sheet;
  std::set<std::string> names;
  for (int i = 0; i < static_cast<int>(scene.file.nodes.size()); ++i) {
    const ImportedNode& node = scene.file.nodes[i];
    if (!is_named_sheet(node)) continue;
    if (!names.insert(node.name).second)
      throw Error(ErrorCode::scene, place_of(scene.source, "sheet", node.name),
                  "Two sheets have this name.",
                  "Give every sheet a name of its own and export again.");
    try {
      sheets.push_back(read_sheet(scene, i, world, options, overrides[i], warnings));
    } catch (const Error& error) {
      if (!is_longer_word(node.name, "paper")) throw;
      if (!no_sheet) no_sheet = taken_for_sheet(error);
      warnings.push_back(
          fmt::format("\"{}\" is ignored, although its name begins with \"paper\". {}", node.name,
                      error.cause));
    }
  }
  if (sheets.empty() && no_sheet) throw *no_sheet;
  if (sheets.empty()) reject_without_sheet(scene);
  return sheets;
}

void warn_of_keyed_sheets(const SceneNodes& scene, std::vector<std::string>& warnings) {
  constexpr int looks = 16;  // frames that are compared with the first
  const auto first = world_at(scene, scene.first_frame);
  std::set<int> moved, deformed;
  for (int look = 1; look <= looks; ++look) {
    const int frame = scene.first_frame + (scene.last_frame - scene.first_frame) * look / looks;
    const auto world = world_at(scene, frame);
    for (int i = 0; i < static_cast<int>(world.size()); ++i) {
      if (!is_named_sheet(scene.file.nodes[i])) continue;
      if (!world[i].isApprox(first[i], 1e-5))
        moved.insert(i);
      else if (is_deformed(scene.file, scene.file.nodes[i]) &&
               !vertices_at(scene, i, world, frame)
                    .isApprox(vertices_at(scene, i, first, scene.first_frame), 1e-5))
        deformed.insert(i);
    }
  }
  for (const int i : moved)
    warnings.push_back(
        fmt::format("The sheet \"{}\" is keyed or moves with its parent: it starts where it is at "
                    "frame {}, then only handles move it.",
                    scene.file.nodes[i].name, scene.first_frame));
  for (const int i : deformed)
    warnings.push_back(fmt::format(
        "Bones or blend shapes go on to deform the sheet \"{}\" after frame {}, with which it "
        "starts: that is not followed, only handles move it.",
        scene.file.nodes[i].name, scene.first_frame));
}

}  // namespace paperbake
