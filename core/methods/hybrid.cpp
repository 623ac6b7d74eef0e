#include "core/methods/method.h"

#include "core/geometry/pattern_mesh.h"
#include "core/step3_developable/developable.h"

#include <cmath>
#include <memory>

namespace paperbake {
namespace {

/// About that many triangles, but where handles stand so close that they alone take most of them:
/// cells between them would be as large as the sheet then, and a straight edge from clamp to handle
/// a taut string. (S8 with 60: 40 triangles in the clamps, edges of 45 mm, stretched by 8 %.)
PatternMesh first_mesh_with(const Pattern& pattern, int triangles,
                            const std::vector<Vector2d>& points, double turn) {
  constexpr double largest_edge = 1.15;  // of what as many equilateral triangles have
  const double edge = largest_edge * std::sqrt(area(pattern) / triangles / (std::sqrt(3.0) / 4));
  PatternMesh coarsest = mesh_pattern(pattern, edge, points, turn);
  return coarsest.triangles.rows() > triangles
             ? coarsest
             : mesh_pattern_with(pattern, triangles, points, turn);
}

BentParts bent_parts(const Crumple& crumple, const Sheet& sheet) {
  BentParts parts;
  for (const Ruling& ruling : crumple.rulings()) parts.rulings.emplace_back(ruling.a, ruling.b);
  const Regions& regions = crumple.regions();
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    const Eigen::RowVector3i corners = sheet.triangles.row(t);
    const Vector2d centre = (sheet.pattern.row(corners[0]) + sheet.pattern.row(corners[1]) +
                             sheet.pattern.row(corners[2])) /
                            3;
    const int place = regions.grid().nearest(centre),
              region = place < 0 ? -1 : regions.region_of_sample()[place];
    parts.region.push_back(region < 0 ? -1 : regions.all()[region].id);
  }
  return parts;
}

}  // namespace

Method hybrid(const Pattern& pattern, const Paper& paper, int base_triangles,
              const CrumpleOptions& options, std::uint32_t seed, std::uint32_t sheet, double turn) {
  Method method;
  method.name = "hybrid";
  const auto crumple = std::make_shared<Crumple>(pattern, paper, options, seed, sheet);
  method.first_mesh = [=](const Pattern& cut, const std::vector<Vector2d>& points) {
    PatternMesh mesh = first_mesh_with(cut, base_triangles, points, turn);
    const int required = number_points_first(mesh);
    crumple->set_base_mesh(mesh.vertices, mesh.triangles, required);
    return Method::FirstMesh{std::move(mesh.vertices), std::move(mesh.triangles),
                             std::move(mesh.point_vertex)};
  };
  method.remesh = [crumple](Sheet& sheet_now, const RemeshContext& is) {
    return !is.snap_in_progress &&
           crumple->step(sheet_now, is.fixed, is.now, is.moving).mesh_changed();
  };
  method.propose = [crumple](const Sheet& sheet_now,
                             const RemeshContext& is) -> std::optional<Sheet> {
    // what yields keeps its mesh: another one folds in other places, and what yields there too is
    // not undone
    if (!is.moving || !is.at_minimum || is.yielding) return std::nullopt;
    // its edges are where they have to be
    if (!sheet_now.prescribed_creases.empty()) return std::nullopt;
    return crumple->propose(sheet_now, is.isolated_moving_handles, is.rests_on_contact, is.now);
  };
  method.on_proposal_result = [crumple](bool accepted, const FrameTime& now) {
    crumple->on_proposal_result(accepted, now);
  };
  method.finish = [](Sheet& shown, const std::vector<int>& held) { restore_lengths(shown, held); };
  method.archive = [crumple](Serializer& a) { crumple->archive(a); };
  method.parts = [crumple](const Sheet& sheet_now) { return bent_parts(*crumple, sheet_now); };
  return method;
}

}  // namespace paperbake
