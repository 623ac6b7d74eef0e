#include "formats/scene/sheet_point.h"

#include "core/model/error.h"
#include "formats/scene/scene_properties.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace paperbake {
namespace {

/// Barycentric coordinates of the point of a triangle that is nearest to p.
/// source  [Ericson 2005] Real-Time Collision Detection, section 5.1.5
Vector3d nearest_weights(const Vector3d& p, const Vector3d& a, const Vector3d& b,
                         const Vector3d& c) {
  const Vector3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp),
               d6 = ac.dot(cp);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    const double t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - t, t};
  }
  return Vector3d(va, vb, vc) / (va + vb + vc);
}

}  // namespace

SheetPoint nearest_point(const Sheet& sheet, const Vector3d& p) {
  SheetPoint nearest;
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    const auto i = sheet.triangles.row(t);
    const Vector3d weights =
        nearest_weights(p, sheet.x.row(i(0)), sheet.x.row(i(1)), sheet.x.row(i(2)));
    const Vector3d at = weights(0) * sheet.x.row(i(0)) + weights(1) * sheet.x.row(i(1)) +
                        weights(2) * sheet.x.row(i(2));
    if ((at - p).norm() >= nearest.distance) continue;
    nearest.distance = (at - p).norm();
    nearest.pattern = weights(0) * sheet.pattern.row(i(0)) + weights(1) * sheet.pattern.row(i(1)) +
                      weights(2) * sheet.pattern.row(i(2));
  }
  return nearest;
}

std::optional<std::size_t> target_sheet(const SceneNodes& scene,
                                        const std::vector<SceneSheet>& sheets, int node,
                                        const std::string& place) {
  const auto target = text_property(scene.file.nodes[node], "paper_target");
  if (!target) return std::nullopt;
  std::vector<std::string> names;
  std::vector<std::size_t> alike;
  for (std::size_t i = 0; i < sheets.size(); ++i) {
    if (sheets[i].name == *target) return i;
    if (matched_name(sheets[i].name) == matched_name(*target)) alike.push_back(i);
    names.push_back(sheets[i].name);
  }
  if (alike.size() == 1) return alike.front();
  throw Error(ErrorCode::scene, place,
              fmt::format("paper_target names \"{}\", which is not a sheet of the scene.", *target),
              fmt::format("The sheets are: {}.", fmt::join(names, ", ")));
}

}  // namespace paperbake
