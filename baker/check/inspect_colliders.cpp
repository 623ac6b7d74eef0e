#include "baker/check/inspect_colliders.h"

#include "core/geometry/collider_facing.h"
#include "core/geometry/sheet_distance.h"

#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <utility>

namespace paperbake {
namespace {

/// Points spread evenly over the triangles of a sheet, its vertices among them. [m]
std::vector<Vector3d> samples_of(const Sheet& sheet) {
  constexpr double about = 1000;
  const int parts = std::max(
      1, static_cast<int>(std::sqrt(2 * about / std::max<double>(1, sheet.triangles.rows()))));
  std::vector<Vector3d> points;
  for (Eigen::Index t = 0; t < sheet.triangles.rows(); ++t) {
    const auto corner = [&](int k) { return Vector3d(sheet.x.row(sheet.triangles(t, k))); };
    for (int i = 0; i <= parts; ++i)
      for (int j = 0; i + j <= parts; ++j)
        points.push_back(corner(0) + (corner(1) - corner(0)) * i / parts +
                         (corner(2) - corner(0)) * j / parts);
  }
  return points;
}

/// What the collider does in the shot.
const char* motion_of(const ColliderMesh& mesh) {
  constexpr double same_length = 1e-6;  // [m]
  if (mesh.frames.empty()) return "stands still";
  for (const Points3& x : mesh.frames)
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t)
      for (int i = 0; i < 3; ++i) {
        const int a = mesh.triangles(t, i), b = mesh.triangles(t, (i + 1) % 3);
        if (std::abs((x.row(a) - x.row(b)).norm() - (mesh.x.row(a) - mesh.x.row(b)).norm()) >
            same_length)
          return "deforms";
      }
  return "moves";
}

InspectedCollider::Beside beside(const ColliderMesh& mesh, const SceneSheet& sheet) {
  constexpr double anywhere = 1e6;  // [m]
  std::vector<ColliderMesh> facing{mesh};
  face_the_sheet(facing, sheet.start.x, Points3(0, 3));
  const Collider collider(facing.front());
  InspectedCollider::Beside found{sheet.name,
                                  facing.front().paper_side == ColliderMesh::PaperSide::inside,
                                  std::numeric_limits<double>::infinity()};
  for (const Vector3d& p : samples_of(sheet.start)) {
    const double distance = collider.nearest(p, anywhere, 1).distance;
    // the front of an open mesh turns to the sheet
    found.distance = std::min(found.distance, collider.closed() ? distance : std::abs(distance));
  }
  if (found.distance > 0) {  // between the points it may be nearer
    Sheet surface;
    surface.x = mesh.x;
    surface.triangles = mesh.triangles;
    found.distance = distance_between(sheet.start, surface, found.distance);
  }
  return found;
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
