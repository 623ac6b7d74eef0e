#include "core/step1_elastic/elastic.h"

#include "tests/test_meshes.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

using test::hex_sheet;
using test::strip_sheet;

ElasticOptions tight() {
  ElasticOptions options;
  options.stop = 1e-9;
  options.max_iterations = 200;
  return options;
}

std::vector<int> vertices_where(const Sheet& sheet, const std::function<bool(const Vector2d&)>& test) {
  std::vector<int> found;
  for (int v = 0; v < sheet.pattern.rows(); ++v)
    if (test(sheet.pattern.row(v))) found.push_back(v);
  return found;
}

struct Arch {
  double height;  // of the middle, over the length
  double energy;  // over its exact value
};

/// A sheet whose two borders x = 0, x = L, hinged, come 10 % closer in small steps.
Arch elastica(Sheet sheet, double L, double width) {
  const Paper paper;
  for (int v = 0; v < sheet.x.rows(); ++v) sheet.x(v, 2) = 1e-4 * std::sin(M_PI * sheet.pattern(v, 0) / L);
  Elastic elastic(paper, tight());
  elastic.set_mesh(sheet);
  Held held;
  held.vertices = vertices_where(sheet, [&](const Vector2d& p) { return p.x() < 1e-9 || p.x() > L - 1e-9; });
  held.targets.resize(held.vertices.size(), 3);
  ElasticReport report;
  constexpr int steps = 20;
  for (int step = 1; step <= steps + 3; ++step) {  // the last ones at rest: no trace of the way there
    const double shortening = 0.1 * L * std::min(step, steps) / steps;
    for (std::size_t k = 0; k < held.vertices.size(); ++k) {
      const auto p = sheet.pattern.row(held.vertices[k]);
      held.targets.row(k) << (p.x() > 0.5 * L ? p.x() - shortening : p.x()), p.y(), 0;
    }
    report = elastic.step(sheet, held, 1 / 24.0);
    EXPECT_TRUE(report.converged);
  }
  double height = 0;
  for (int v = 0; v < sheet.x.rows(); ++v)
    if (std::abs(sheet.pattern(v, 0) - 0.5 * L) < 1e-9) height = std::max(height, sheet.x(v, 2));
  return {height / L, report.energy / (1.0126 * paper.bending_stiffness / L * width)};
}

// h/L = 0.194924 and U L/D = 1.0126 per width at 10 % shortening: closed form of the elastica with hinged ends
TEST(Elastic, ArchOfRulingStripsHasTheHeightAndEnergyOfTheElastica) {
  const struct { int strips; double height_pct, energy_pct; } cases[] = {{8, 0.7, 2}, {16, 0.2, 0.5}, {32, 0.05, 0.2}};
  for (const auto& c : cases) {
    const Arch arch = elastica(strip_sheet(0.1, 0.05, c.strips), 0.1, 0.05);
    EXPECT_NEAR(arch.height / 0.194924, 1, 0.01 * c.height_pct) << c.strips << " strips";
    EXPECT_NEAR(arch.energy, 1, 0.01 * c.energy_pct) << c.strips << " strips";
  }
}

TEST(Elastic, ArchOfANearEquilateralMeshConvergesToTheElastica) {
  const Arch arch = elastica(hex_sheet(0.1, 0.05, 20), 0.1, 0.05);
  EXPECT_NEAR(arch.height / 0.194924, 1, 0.003);
  EXPECT_NEAR(arch.energy, 1, 0.05);
}

}  // namespace
}  // namespace paperbake
