#include "baker/check/inspect_colliders.h"

#include "core/geometry/collider_depth.h"
#include "core/geometry/collider_facing.h"
#include "core/geometry/rigid_motion.h"
#include "core/geometry/sheet_distance.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace paperbake {
namespace {

/// What the collider does in the shot.
const char* motion_of(const ColliderMesh& mesh) {
  constexpr double same_place = 1e-6;  // [m]
  if (mesh.frames.empty()) return "stands still";
  const bool is_rigid = std::all_of(mesh.frames.begin(), mesh.frames.end(), [&](const Points3& x) {
    return rigid_motion_between(mesh.x, x, same_place).has_value();
  });
  return is_rigid ? "moves" : "deforms";
}

/// The least distance of a sheet from a mesh. [m]
double distance_from(const ColliderMesh& mesh, const Sheet& sheet) {
  constexpr double anywhere = 1e6;  // [m]
  const Collider collider(mesh);
  double of_vertices = anywhere;
  for (const auto& x : sheet.x.rowwise())
    of_vertices = std::min(of_vertices, std::abs(collider.nearest(x, anywhere, 1).distance));
  Sheet surface;
  surface.x = mesh.x;
  surface.triangles = mesh.triangles;
  return distance_between(sheet, surface, of_vertices);
}

InspectedCollider::Beside beside(const ColliderMesh& mesh, const SceneSheet& sheet) {
  std::vector<ColliderMesh> facing{mesh};
  face_the_sheet(facing, sheet.start.x, Points3(0, 3));
  const double depth =
      ColliderDepth(facing.front()).deepest(sheet.start.x, sheet.start.triangles).depth;
  return {sheet.name, facing.front().paper_side == ColliderMesh::PaperSide::inside,
          depth > 0 ? -depth : distance_from(mesh, sheet.start)};
}

}  // namespace

std::vector<InspectedCollider> inspected_colliders(const Scene& scene) {
  std::vector<InspectedCollider> all;
  for (const ColliderMesh& mesh : scene.colliders) {
    InspectedCollider& found = all.emplace_back(
        InspectedCollider{&mesh,
                          Collider(mesh).closed(),
                          motion_of(mesh),
                          (mesh.x.colwise().maxCoeff() - mesh.x.colwise().minCoeff()).transpose(),
                          {}});
    for (const SceneSheet& sheet : scene.sheets) found.sheets.push_back(beside(mesh, sheet));
  }
  return all;
}

std::string collider_text(const InspectedCollider& c) {
  const Vector3d mm = 1e3 * c.size;
  std::string text = fmt::format(
      "collider \"{}\": {:.1f} x {:.1f} x {:.1f} mm, {} triangles, {}; {}; friction {:g}; in the "
      "first frame ",
      c.mesh->name, mm.x(), mm.y(), mm.z(), c.mesh->triangles.rows(),
      c.closed ? "closed" : "open, keeps the paper on the side where it begins", c.motion,
      c.mesh->friction);
  for (const InspectedCollider::Beside& b : c.sheets) {
    if (&b != &c.sheets.front()) text += ", ";
    text +=
        b.distance < 0
            ? fmt::format("the sheet \"{}\" reaches {:.2f} mm into it", b.sheet, -1e3 * b.distance)
            : fmt::format("the sheet \"{}\" is {:.2f} mm away", b.sheet, 1e3 * b.distance);
    if (c.closed) text += b.holds ? " and stays inside" : " and stays outside";
  }
  return text + "\n";
}

Json collider_json(const InspectedCollider& c) {
  Json sheets = Json::array();
  for (const InspectedCollider::Beside& b : c.sheets)
    sheets.push_back({{"sheet", b.sheet},
                      {"side", !c.closed ? "front"
                               : b.holds ? "inside"
                                         : "outside"},
                      {"distance_m", b.distance}});
  return {{"name", c.mesh->name},
          {"triangles", c.mesh->triangles.rows()},
          {"closed", c.closed},
          {"moves", !c.mesh->frames.empty()},
          {"motion", c.motion},
          {"friction", c.mesh->friction},
          {"size_m", {c.size.x(), c.size.y(), c.size.z()}},
          {"nearest_sheet", c.nearest().sheet},
          {"distance_m", c.nearest().distance},
          {"sheets", std::move(sheets)}};
}

}  // namespace paperbake
