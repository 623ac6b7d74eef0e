#include "core/animation/animate.h"
#include "core/methods/adaptive.h"
#include "core/methods/fem.h"
#include "core/methods/hybrid.h"
#include "core/step1_elastic/energies/elastic_energy.h"
#include "tests/core/test_meshes.h"
#include "tests/core/test_shots.h"
#include "tests/validation/cases.h"

namespace paperbake::validation {
namespace {

constexpr double side = 0.1;
const char* const closed_form = "V1: 2E(k)/K(k) = 1.9";

/// Rows for a sheet of side x side whose borders u = 0 and u = side are hinged and 10 % closer.
Rows judge(const std::string& name, const Sheet& sheet, const Paper& paper, double height_tolerance,
           double energy_tolerance, double force_tolerance) {
  const ElasticEnergy energy(paper, sheet.pattern, sheet.triangles);
  Points3 gradient;
  const double stored = energy.gradient(sheet.x, gradient);
  double force = 0;  // [N] along x on the right border
  for (const int v : vertices_where(sheet, [](const Vector2d& p) { return p.x() > side - 1e-9; }))
    force += gradient(v, 0);
  const double width = sheet.pattern.col(1).maxCoeff();
  double height = 0;
  for (const int v : vertices_where(
           sheet, [&](const Vector2d& p) { return std::abs(p.x() - 0.5 * side) < 1e-9; }))
    height = std::max(height, sheet.x(v, 2));
  if (height == 0) height = sheet.x.col(2).maxCoeff();  // no vertex on the middle line
  const double D = paper.bending_stiffness;
  return {{name, "mid height / L", 0.194924, height / side, height_tolerance, closed_form, ""},
          {name, "energy L / (D W)", 1.0126, stored * side / (D * width), energy_tolerance,
           closed_form, ""},
          {name, "force L^2 / (pi^2 D W)", 1.0530, -force * side * side / (M_PI * M_PI * D * width),
           force_tolerance, closed_form, ""}};
}

Sheet push_strips(int strips, const Paper& paper) {
  Sheet sheet = test::strip_sheet(side, 0.5 * side, strips);
  for (int v = 0; v < sheet.x.rows(); ++v)
    sheet.x(v, 2) = 1e-4 * std::sin(M_PI * sheet.pattern(v, 0) / side);
  ElasticOptions options;
  options.stop = 1e-9;
  options.max_iterations = 200;
  Elastic elastic(paper, options);
  elastic.set_mesh(sheet);
  PositionConstraints held = test::held_at(
      vertices_where(sheet, [](const Vector2d& p) { return p.x() < 1e-9 || p.x() > side - 1e-9; }),
      sheet.x);
  constexpr int steps = 20, rests = 6;
  for (int step = 1; step <= steps + rests; ++step) {
    for (PositionConstraint& c : held) {
      const auto p = sheet.pattern.row(c.vertex);
      c.target << p.x() - (p.x() > 0.5 * side ? 0.1 * side * std::min(step, steps) / steps : 0),
          p.y(), 0;
    }
    elastic.step(sheet, {held}, 1 / 24.0);
  }
  return sheet;
}

Sheet push_shot(const MethodChoice& method, const Shot& shot) {
  AnimateOptions options;
  options.last_frame = 30;
  options.elastic.stop = 1e-7;
  Sheet sheet;
  animate(shot, method, options, [&](const AnimatedFrame& frame) {
    sheet = *frame.sheet;
    return true;
  });
  return sheet;
}

}  // namespace

Rows elastica() {
  const Paper paper;
  Rows rows;
  const auto add = [&](const Rows& more) { rows.insert(rows.end(), more.begin(), more.end()); };
  const struct {
    int strips;
    double height, energy, force;
  } meshes[] = {{8, 0.007, 0.02, 0.02}, {16, 0.002, 0.01, 0.02}, {32, 0.0005, 0.01, 0.02}};
  for (const auto& m : meshes)
    add(judge(std::to_string(m.strips) + " ruling strips", push_strips(m.strips, paper), paper,
              m.height, m.energy, m.force));
  Shot shot = test::s1_push();
  shot.handles.back().grab_frame = 1000;  // no push from above
  for (const int triangles : {1700, 6000})
    add(judge("fem " + std::to_string(triangles), push_shot(fem(triangles), shot), paper, 0.005,
              0.01, 0.02));
  // About 10 facets along the arch, in hybrid not all of them along rulings: 8 % too much energy,
  // which is shown but not judged.
  add(judge("hybrid 120", push_shot(hybrid(shot.pattern, paper, 120, {}, 0, 0), shot), paper, 0.015,
            0, 0));
  add(judge("adaptive 3000", push_shot(adaptive(shot.pattern, 3000), shot), paper, 0.015, 0, 0));
  return rows;
}

}  // namespace paperbake::validation
