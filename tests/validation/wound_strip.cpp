#include "core/animation/animate.h"
#include "core/geometry/curvature.h"
#include "core/geometry/pattern_mesh.h"
#include "core/geometry/point_location.h"
#include "core/model/plastic_grid.h"
#include "core/step1_elastic/elastic.h"
#include "tests/core/test_meshes.h"
#include "tests/core/test_shots.h"
#include "tests/validation/cases.h"

namespace paperbake::validation {
namespace {

constexpr double length = 0.03, width = 0.015;  // [m]

/// Curvature that is left in a sheet after it was wound to the curvature k, with every vertex
/// guided, and released. [1/m]
double residual(Sheet sheet, double k, const Paper& paper) {
  PlasticGrid grid(test::rectangle(length, width));
  ElasticOptions options;
  options.stop = 1e-7;
  Elastic elastic(paper, options);
  elastic.set_plastic_grid(&grid);
  elastic.set_mesh(sheet);
  constexpr int steps = 4;
  for (int step = 1; step <= steps; ++step) {
    Sheet rolled = sheet;
    test::roll(rolled, steps / (k * step));
    PositionConstraints all;
    for (int v = 0; v < sheet.pattern.rows(); ++v) all.push_back({v, rolled.x.row(v)});
    elastic.step(sheet, {all}, 1 / 24.0);
  }
  for (int rest = 0; rest < 40; ++rest) elastic.step(sheet, {}, 1.0);
  const Points3 curvature = vertex_curvature(sheet);
  const std::vector<int> inner = vertices_where(
      sheet, [](const Vector2d& p) { return std::abs(p.x() - 0.5 * length) < 0.4 * length; });
  double sum = 0;
  for (const int v : inner) sum += curvature(v, 0);
  return sum / inner.size();
}

/// The same with handles: they bring the ends of the strip around a circle in frames 1-25, hold
/// them there and release them at frame 28.
Shot winding(double k, const Paper& paper) {
  constexpr int frames = 25, let_go = 28;
  constexpr double clamp = 0.001;  // [m]
  Shot shot = test::blank_shot(test::rectangle(length, width));
  shot.paper = paper;
  for (const double u : {0.0, clamp, length - clamp, length})
    for (int j = 0; j <= 8; ++j) {
      Handle handle = test::bare_handle("end", {u, width * j / 8}, frames);
      handle.release_frame = let_go;
      for (int f = 1; f < frames; ++f) {
        const double now = k * f / (frames - 1), s = now * (u - 0.5 * length);
        handle.keyed.row(f) << 0.5 * length + std::sin(s) / now, handle.pattern.y(),
            (std::cos(s) - 1) / now;
      }
      shot.handles.push_back(handle);
    }
  return shot;
}

/// The same curvature, from the circle through three points of the centre line. [1/m]
double residual(const MethodChoice& method, const Shot& shot) {
  AnimateOptions options;
  options.last_frame = 60;
  options.plasticity = Plasticity::on;
  options.elastic.stop = 1e-7;
  options.elastic.contact = SelfContact::off;
  Sheet sheet;
  animate(shot, method, options, [&](const AnimatedFrame& frame) {
    sheet = *frame.sheet;
    return true;
  });
  const PointLocator locator(sheet.pattern, sheet.triangles);
  const auto at = [&](double part) {
    return interpolate(locator.locate({part * length, 0.5 * width}), sheet.triangles, sheet.x);
  };
  const Vector3d a = at(0.2) - at(0.5), b = at(0.8) - at(0.5);
  return 2 * a.cross(b).norm() / (a.norm() * b.norm() * (a - b).norm());
}

Sheet equilateral(int triangles) {
  PatternMesh mesh = mesh_pattern_with(test::rectangle(length, width), triangles, {});
  return test::flat_sheet(std::move(mesh.vertices), std::move(mesh.triangles));
}

}  // namespace

Rows wound_strip() {
  Rows rows;
  Paper paper;
  for (const double eta : {0.0, 0.3})
    for (const double k : {90.0, 140.0, 200.0}) {
      paper.hardening = eta;
      const double expected = (1 - eta) * std::max(0.0, k - 100);
      char quantity[60];
      std::snprintf(quantity, sizeof quantity, "k %.0f, eta %.1f: residual 1/m", k, eta);
      const double tolerance = expected == 0 ? 1 : 0.02;  // [1/m] below yield, otherwise relative
      rows.push_back({"80 ruling strips", quantity, expected,
                      residual(test::strip_sheet(length, width, 80), k, paper), tolerance,
                      "V7: (1 - eta)(k - k_y)", ""});
      rows.push_back({"500 near-equilateral", quantity, expected,
                      residual(equilateral(500), k, paper), tolerance, "V7: (1 - eta)(k - k_y)",
                      ""});
    }
  paper.hardening = 0.3;
  for (const double k : {90.0, 140.0, 200.0}) {
    const Shot shot = winding(k, paper);
    char quantity[60];
    std::snprintf(quantity, sizeof quantity, "k %.0f, eta 0.3: residual 1/m", k);
    const double expected = 0.7 * std::max(0.0, k - 100);
    for (const auto& [name, method] : methods(shot.pattern, paper))
      rows.push_back({name + ", by its ends", quantity, expected, residual(method, shot),
                      expected == 0 ? 1 : 0.02, "V7: (1 - eta)(k - k_y)", ""});
  }
  Row crease{"any",
             "opening of a creased strip",
             0,
             0,
             0,
             "",
             "no crease of its own stiffness kappa in this version; curvature of the panels is all "
             "there is"};
  rows.push_back(crease);
  return rows;
}

}  // namespace paperbake::validation
