#include "core/curvature.h"
#include "core/pattern_mesh.h"
#include "core/plastic_grid.h"
#include "core/step1_elastic/elastic.h"
#include "tests/test_meshes.h"
#include "tests/test_shots.h"
#include "tests/validation/cases.h"

namespace paperbake::validation {
namespace {

constexpr double length = 0.03, width = 0.015;  // [m]

/// Curvature that stays of a sheet that was wound to k, every vertex led, and let go. [1/m]
double residual(Sheet sheet, double k, const Paper& paper) {
  PlasticGrid grid(test::rectangle(length, width));
  ElasticOptions options;
  options.stop = 1e-7;
  Elastic elastic(paper, options);
  elastic.remember_in(&grid);
  elastic.set_mesh(sheet);
  constexpr int steps = 4;
  for (int step = 1; step <= steps; ++step) {
    Sheet rolled = sheet;
    test::roll(rolled, steps / (k * step));
    Held all;
    for (int v = 0; v < sheet.pattern.rows(); ++v) all.vertices.push_back(v);
    all.targets = rolled.x;
    elastic.step(sheet, all, 1 / 24.0);
  }
  for (int rest = 0; rest < 40; ++rest) elastic.step(sheet, {{}, Points3(0, 3)}, 1.0);
  const Points3 curvature = vertex_curvature(sheet);
  const std::vector<int> inner = vertices_where(sheet, [](const Vector2d& p) { return std::abs(p.x() - 0.5 * length) < 0.4 * length; });
  double sum = 0;
  for (const int v : inner) sum += curvature(v, 0);
  return sum / inner.size();
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
      const double tolerance = expected == 0 ? 1 : 0.02;  // 1/m below yield
      rows.push_back({"80 ruling strips", quantity, expected, residual(test::strip_sheet(length, width, 80), k, paper), tolerance, "V7: (1 - eta)(k - k_y)", ""});
      rows.push_back({"500 near-equilateral", quantity, expected, residual(equilateral(500), k, paper), tolerance, "V7: (1 - eta)(k - k_y)", ""});
    }
  Row crease{"any", "opening of a creased strip", 0, 0, 0, "", "no crease of its own stiffness kappa in this version; curvature of the panels is all there is"};
  rows.push_back(crease);
  return rows;
}

}  // namespace paperbake::validation
