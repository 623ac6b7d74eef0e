#include "formats/scene/scene_colliders.h"

#include "formats/scene/scene_deformation.h"
#include "formats/scene/scene_properties.h"
#include "formats/scene/welded_mesh.h"

#include <fmt/format.h>

#include <algorithm>

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

/// A sentence on what of a collider is not followed; empty: all is.
std::string not_followed(const SceneNodes& scene, const ImportedNode& node) {
  for (const int m : node.meshes)
    if (const std::string& what = scene.file.meshes[m].not_followed; !what.empty())
      return fmt::format("{} of the collider \"{}\" is not followed.", what, node.name);
  return "";
}

using PaperSide = ColliderMesh::PaperSide;

/// What the property paper_collider says of the side of the paper.
PaperSide paper_side_of(const ImportedNode& node) {
  const std::string said = text_property(node, "paper_collider").value_or("");
  return said == "inside"    ? PaperSide::inside
         : said == "outside" ? PaperSide::outside
                             : PaperSide::automatic;
}

}  // namespace

bool is_collider(const ImportedNode& node) {
  return !node.meshes.empty() && !name_begins_with(node.name, "paper") &&
         (flag_property(node, "paper_collider") || paper_side_of(node) != PaperSide::automatic ||
          name_begins_with(node.name, "collider"));
}

std::vector<ColliderMesh> read_colliders(const SceneNodes& scene,
                                         std::vector<std::string>& warnings) {
  constexpr double unmoved = 1e-8;  // [m] rounding
  const auto& nodes = scene.file.nodes;
  std::vector<int> found;
  std::vector<std::vector<int>> kept;  // of each collider: WeldedMesh::kept
  std::vector<ColliderMesh> colliders;
  const auto first = world_at(scene, scene.first_frame);
  for (int i = 0; i < static_cast<int>(nodes.size()); ++i) {
    if (!is_collider(nodes[i])) continue;
    WeldedMesh mesh =
        welded_mesh(scene.file, i, first[i], vertices_at(scene, i, first, scene.first_frame));
    ColliderMesh collider{nodes[i].name, mesh.x, with_area(mesh), {}};
    collider.friction =
        nonnegative_property(scene.source, nodes[i], "paper_friction").value_or(collider.friction);
    if (collider.triangles.rows() == 0) {
      warnings.push_back(
          fmt::format("The collider \"{}\" has no faces: it is ignored.", collider.name));
      continue;
    }
    collider.paper_side = paper_side_of(nodes[i]);
    if (collider.paper_side == PaperSide::inside && !Collider(collider).closed())
      warnings.push_back(fmt::format(
          "The collider \"{}\" is open, and the paper cannot stay inside it: it stays on the side "
          "where it begins. Close the mesh to hold the paper inside.",
          collider.name));
    if (std::string sentence = not_followed(scene, nodes[i]); !sentence.empty())
      warnings.push_back(std::move(sentence));
    found.push_back(i);
    kept.push_back(std::move(mesh.kept));
    colliders.push_back(std::move(collider));
  }
  for (int frame = scene.first_frame; frame <= scene.last_frame && !found.empty(); ++frame) {
    const auto world = world_at(scene, frame);
    for (std::size_t c = 0; c < found.size(); ++c)
      colliders[c].frames.push_back(
          rounded(vertices_at(scene, found[c], world, frame)(kept[c], Eigen::all)));
  }
  for (ColliderMesh& collider : colliders) {
    if (std::all_of(collider.frames.begin(), collider.frames.end(), [&](const Points3& x) {
          return (x - collider.frames.front()).cwiseAbs().maxCoeff() <= unmoved;
        }))
      collider.frames.clear();
    else
      collider.x = collider.frames.front();
  }
  return colliders;
}

}  // namespace paperbake
