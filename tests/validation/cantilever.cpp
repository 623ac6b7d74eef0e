#include "core/animation/animate.h"
#include "core/geometry/pattern_mesh.h"
#include "core/geometry/point_location.h"
#include "core/step1_elastic/elastic.h"
#include "tests/core/test_meshes.h"
#include "tests/core/test_shots.h"
#include "tests/validation/cases.h"

namespace paperbake::validation {
namespace {

// [m] from the clamp line, which is in the middle of the first cell, to the free end
constexpr double L = 0.1;
constexpr int cells = 16;
constexpr double h = L / (cells - 0.5);

/// Near-equilateral triangles in a lattice turned by `angle` [rad], with the same first two cells
/// in all; angle < 0: ruling strips.
Sheet strip(double angle) {
  if (angle < 0) return test::strip_sheet(cells * h, 4 * h, cells);
  std::vector<Vector2d> clamped;
  for (int j = 0; j <= 8; ++j)
    for (double x : {0.0, h, 2 * h}) clamped.emplace_back(x, 0.5 * j * h);
  PatternMesh mesh = mesh_pattern(test::rectangle(cells * h, 4 * h), h, clamped, angle);
  return test::flat_sheet(std::move(mesh.vertices), std::move(mesh.triangles));
}

struct Hang {
  double drop, angle;  // [1] of L; [degrees]
};
Hang hang(Sheet sheet, double lam) {
  Paper paper;
  paper.poisson = 0;  // in the closed form the strip is free to curl crosswise
  ElasticOptions options;
  options.stop = 1e-9;
  options.max_iterations = 200;
  const PositionConstraints held = test::held_at(
      vertices_where(sheet, [](const Vector2d& p) { return p.x() < 1.01 * h; }), sheet.x);
  constexpr int steps = 16;
  for (int step = 1; step <= steps; ++step) {
    options.forces.gravity =
        lam * paper.bending_stiffness / (paper.area_density * std::pow(L, 3)) * step / steps;
    Elastic elastic(paper, options);
    elastic.set_mesh(sheet);
    for (int rest = 0; rest < (step == steps ? 4 : 1); ++rest) elastic.step(sheet, {held}, 1.0);
  }
  // position and slope of the free end, from a straight line through the last two cells, where
  // nothing bends
  double n = 0, s = 0, ss = 0;
  Eigen::Vector2d p = Eigen::Vector2d::Zero(), sp = p;
  for (int v = 0; v < sheet.x.rows(); ++v) {
    const double a = sheet.pattern(v, 0) - cells * h;
    if (a < -1.6 * h) continue;
    const Eigen::Vector2d q(sheet.x(v, 0), sheet.x(v, 2));
    n += 1;
    s += a;
    ss += a * a;
    p += q;
    sp += a * q;
  }
  const Eigen::Vector2d slope = (n * sp - s * p) / (n * ss - s * s), tip = (p - slope * s) / n;
  return {-tip.y() / L, std::atan2(-slope.y(), slope.x()) * 180 / M_PI};
}

/// Two such strips in one, released from level over a line that holds the middle. There it stays
/// level by symmetry, whatever the width of a cell.
Shot draped_shot() {
  Shot shot = test::blank_shot(test::rectangle(2 * L, 4 * h));
  for (int k = 0; k <= 8; ++k)
    shot.handles.push_back(test::bare_handle("middle", {L, 0.5 * k * h}, 1));
  shot.paper.poisson = 0;
  return shot;
}

/// Mean of both ends.
Hang hang(const MethodChoice& method, const Shot& shot, double lam) {
  AnimateOptions options;
  options.last_frame = 40;
  options.elastic.stop = 1e-7;
  options.elastic.forces.gravity =
      lam * shot.paper.bending_stiffness / (shot.paper.area_density * std::pow(L, 3));
  Sheet sheet;
  animate(shot, method, options, [&](const AnimatedFrame& frame) {
    sheet = *frame.sheet;
    return true;
  });
  const PointLocator locator(sheet.pattern, sheet.triangles);
  const auto at = [&](double u) {
    return interpolate(locator.locate({u, 2 * h}), sheet.triangles, sheet.x);
  };
  Hang mean{0, 0};
  for (const int way : {-1, 1}) {
    const Vector3d tip = at(L + way * L), end = tip - at(L + way * (L - 1.5 * h));
    mean.drop -= 0.5 * tip.z() / L;
    mean.angle += 0.5 * std::atan2(-end.z(), way * end.x()) * 180 / M_PI;
  }
  return mean;
}

}  // namespace

Rows cantilever() {
  // heavy elastica, solved to 5 digits: lam, drop of the tip / L, angle of the tip
  constexpr double table[][3] = {
      {0.5, 0.06231, 4.763}, {2, 0.23851, 18.426}, {8, 0.64063, 53.865}, {32, 0.87846, 83.730}};
  Rows rows;
  for (const auto& [lam, drop, angle] : table) {
    const Hang got = hang(strip(-1), lam);
    const std::string name = "16 ruling strips, lam " + std::to_string(lam).substr(0, 4);
    rows.push_back({name, "tip drop / L", drop, got.drop, 0.01, "V2: heavy elastica", ""});
    rows.push_back({name, "tip angle, degrees", angle, got.angle, 0.01, "V2: heavy elastica", ""});
  }
  for (const double degrees : {0.0, 30.0, 45.0})
    rows.push_back({"lattice at " + std::to_string(int(degrees)) + " degrees, lam 8",
                    "tip drop / L", 0.64063, hang(strip(degrees * M_PI / 180), 8).drop, 0.02,
                    "V2: heavy elastica", ""});
  const Shot shot = draped_shot();
  for (const int row : {1, 2})
    for (const auto& [method_name, method] : methods(shot.pattern, shot.paper)) {
      const auto& [lam, drop, angle] = table[row];
      const Hang got = hang(method, shot, lam);
      const std::string name = method_name + ", lam " + std::to_string(int(lam));
      rows.push_back({name, "tip drop / L", drop, got.drop, 0.02, "V2: heavy elastica", ""});
      rows.push_back(
          {name, "tip angle, degrees", angle, got.angle, 0.02, "V2: heavy elastica", ""});
    }
  return rows;
}

}  // namespace paperbake::validation
