#include "formats/scene/scene_colliders.h"

#include "core/geometry/collider_facing.h"
#include "core/model/error.h"
#include "formats/scene/scene_deformation.h"
#include "formats/scene/scene_properties.h"
#include "formats/scene/welded_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

namespace paperbake {
namespace {

/// The triangles that have an area.
Triangles with_area(const WeldedMesh& mesh) {
  std::vector<int> kept;
  for (int t = 0; t < mesh.triangles.rows(); ++t) {
    const Vector3d a = mesh.x.row(mesh.triangles(t, 0)), b = mesh.x.row(mesh.triangles(t, 1)),
                   c = mesh.x.row(mesh.triangles(t, 2));
    const double longest2 =
        std::max({(b - a).squaredNorm(), (c - a).squaredNorm(), (c - b).squaredNorm()});
    if ((b - a).cross(c - a).norm() > 1e-9 * longest2) kept.push_back(t);
  }
  return mesh.triangles(kept, Eigen::all);
}

/// Rounded to 10 nm, so that positions are short as text and unmoved vertices stay the same.
Points3 rounded(const Points3& x) {
  constexpr double unit = 1e8;  // [1/m]
  return (x.array() * unit).round() / unit;
}

using PaperSide = ColliderMesh::PaperSide;

/// What the property paper_collider of a node says.
struct Said {
  bool collider = false;
  PaperSide side = PaperSide::automatic;
};

/// Nothing without that property.
std::optional<Said> said_of(const SceneNodes& scene, const ImportedNode& node) {
  const auto text = text_property(node, "paper_collider");
  if (!text) return std::nullopt;
  const std::string word = matched_name(*text);
  if (word == "inside") return Said{true, PaperSide::inside};
  if (word == "outside") return Said{true, PaperSide::outside};
  if (const auto yes = yes_or_no(node, "paper_collider")) return Said{*yes};
  throw Error(ErrorCode::scene, place_of(scene.source, "collider", node.name),
              fmt::format("paper_collider is \"{}\".", *text),
              "It must be true or false, or inside or outside, which says where the paper stays.");
}

/// Whether a node itself says that it is a collider, or that those below it are.
bool says_collider(const SceneNodes& scene, const ImportedNode& node) {
  return !node.pivot && !name_begins_with(node.name, "paper") &&
         (name_begins_with(node.name, "collider") ||
          said_of(scene, node).value_or(Said{}).collider);
}

/// The nearest empty above a node that says that those below it are colliders; -1: there is none.
int group_above(const SceneNodes& scene, int node) {
  const auto& nodes = scene.file.nodes;
  for (int above = nodes[node].parent; above >= 0; above = nodes[above].parent)
    if (nodes[above].meshes.empty() && says_collider(scene, nodes[above])) return above;
  return -1;
}

/// Whether a mesh in a group of colliders is something else.
bool is_no_part_of_group(const SceneNodes& scene, const ImportedNode& node) {
  return name_begins_with(node.name, "handle") || name_begins_with(node.name, "crease") ||
         node.properties.count("paper_point") > 0 || node.properties.count("paper_crease") > 0 ||
         said_of(scene, node).has_value();
}

/// The node that makes a node a collider: itself, or an empty above it; -1: it is none.
int made_collider_by(const SceneNodes& scene, int node) {
  const ImportedNode& mesh = scene.file.nodes[node];
  if (mesh.meshes.empty() || name_begins_with(mesh.name, "paper")) return -1;
  if (says_collider(scene, mesh)) return node;
  return is_no_part_of_group(scene, mesh) ? -1 : group_above(scene, node);
}

/// A collider as it is in the first frame.
/// group  the node that makes it one: what it does not say itself, this one says
/// returns  with WeldedMesh::kept
std::pair<std::vector<int>, ColliderMesh> collider_at(const SceneNodes& scene, int node,
                                                      const ImportedNode& group,
                                                      const std::vector<Eigen::Affine3d>& first) {
  const ImportedNode& own = scene.file.nodes[node];
  WeldedMesh mesh = welded_mesh(scene.file, node, first[node],
                                vertices_at(scene, node, first, scene.first_frame));
  ColliderMesh collider{own.name, mesh.x, with_area(mesh), {}};
  for (const ImportedNode* of : {&group, &own}) {
    collider.friction =
        nonnegative_property(scene.source, *of, "paper_friction").value_or(collider.friction);
    if (const auto said = said_of(scene, *of)) collider.paper_side = said->side;
  }
  return {std::move(mesh.kept), std::move(collider)};
}

/// Warns of nodes that say that they are colliders, and are none.
/// makes  nodes that have made a mesh a collider
void warn_of_no_colliders(const SceneNodes& scene, const std::set<int>& makes,
                          std::vector<std::string>& warnings) {
  const auto& nodes = scene.file.nodes;
  for (int i = 0; i < static_cast<int>(nodes.size()); ++i) {
    if (name_begins_with(nodes[i].name, "paper") && !nodes[i].meshes.empty() &&
        said_of(scene, nodes[i]).value_or(Said{}).collider)
      warnings.push_back(fmt::format(
          "\"{}\" is a sheet because of its name: its property paper_collider has no effect.",
          nodes[i].name));
    if (nodes[i].meshes.empty() && says_collider(scene, nodes[i]) && !makes.count(i) &&
        group_above(scene, i) < 0)
      warnings.push_back(fmt::format(
          "The collider \"{}\" has no mesh, and none is below it: it is ignored.", nodes[i].name));
  }
}

}  // namespace

bool is_collider(const SceneNodes& scene, int node) { return made_collider_by(scene, node) >= 0; }

std::vector<ColliderMesh> read_colliders(const SceneNodes& scene,
                                         std::vector<std::string>& warnings) {
  constexpr double unmoved = 1e-8;  // [m] rounding
  const auto& nodes = scene.file.nodes;
  std::vector<int> found;
  std::vector<std::vector<int>> kept;  // of each collider: WeldedMesh::kept
  std::vector<ColliderMesh> colliders;
  std::set<int> makes;
  const auto first = world_at(scene, scene.first_frame);
  for (int i = 0; i < static_cast<int>(nodes.size()); ++i) {
    const int by = made_collider_by(scene, i);
    if (by < 0) continue;
    for (int above = by; above >= 0; above = nodes[above].parent) makes.insert(above);
    auto [mesh_kept, collider] = collider_at(scene, i, nodes[by], first);
    if (collider.triangles.rows() == 0) {
      warnings.push_back(
          fmt::format("The collider \"{}\" has no faces: it is ignored.", collider.name));
      continue;
    }
    if (const int turned = turn_to_neighbours(collider.triangles); turned > 0)
      warnings.push_back(
          fmt::format("{} of the {} triangles of the collider \"{}\" face the other way than their "
                      "neighbours: they are taken as turned round. Recalculate its normals.",
                      turned, collider.triangles.rows(), collider.name));
    if (collider.paper_side == PaperSide::inside && !Collider(collider).closed())
      warnings.push_back(fmt::format(
          "The collider \"{}\" is open, and the paper cannot stay inside it: it stays on the side "
          "where it begins. Close the mesh to hold the paper inside.",
          collider.name));
    if (const std::string what = not_followed(scene.file, nodes[i]); !what.empty())
      warnings.push_back(
          fmt::format("{} of the collider \"{}\" is not followed.", what, collider.name));
    found.push_back(i);
    kept.push_back(std::move(mesh_kept));
    colliders.push_back(std::move(collider));
  }
  warn_of_no_colliders(scene, makes, warnings);
  for (int frame = scene.first_frame; frame <= scene.last_frame && !found.empty(); ++frame) {
    const auto world = world_at(scene, frame);
    for (std::size_t c = 0; c < found.size(); ++c)
      colliders[c].frames.own().push_back(
          rounded(vertices_at(scene, found[c], world, frame)(kept[c], Eigen::all)));
  }
  for (ColliderMesh& collider : colliders) {
    if (std::all_of(collider.frames.begin(), collider.frames.end(), [&](const Points3& x) {
          return (x - collider.frames[0]).cwiseAbs().maxCoeff() <= unmoved;
        }))
      collider.frames = {};
    else
      collider.x = collider.frames[0];
  }
  return colliders;
}

}  // namespace paperbake
