// What an artist prescribes before a crumple begins: where singular points are fixed or forbidden,
// and creases that exist from the start.

#include "core/animation/animate.h"
#include "core/geometry/hinges.h"
#include "core/geometry/pattern_mesh.h"
#include "core/geometry/prescribed_creases.h"
#include "core/methods/adaptive.h"
#include "core/methods/fem.h"
#include "core/methods/hybrid.h"
#include "core/render/render_surface.h"
#include "core/render/shot_record.h"
#include "core/step1_elastic/energies/elastic_energy.h"
#include "formats/maps/crease_history.h"
#include "formats/scene/scene_file.h"

#include <gtest/gtest.h>

#include <cmath>

namespace paperbake {
namespace {

Scene sample(const std::string& name) {
  return read_scene(std::string(PAPERBAKE_SAMPLES) + "/" + name);
}

Shot shot_of(const Scene& scene) {
  const SceneSheet& s = scene.sheets.front();
  return {s.name, s.pattern, s.start, s.handles, Paper{}};
}

std::vector<SingularPoint> born(const Shot& shot, int last_frame) {
  CrumpleOptions crumple;
  crumple.singular_point_rules = shot.singular_point_rules;
  AnimateOptions options;
  options.last_frame = last_frame;
  options.plasticity = Plasticity::on;
  std::vector<SingularPoint> found;
  animate(shot, hybrid(shot.pattern, shot.paper, 120, crumple, 0, 0), options,
          [&](const AnimatedFrame& f) {
            found = f.sheet->singular;
            return true;
          });
  return found;
}

TEST(SingularPointRulesTest, AFixedSingularPointExistsFromTheFirstFrame) {
  Shot shot = shot_of(sample("S8_dcone.glb"));
  shot.singular_point_rules.fixed = {{0.065, 0.03}};
  const auto found = born(shot, 4);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_LT((found[0].pattern - shot.singular_point_rules.fixed[0]).norm(), 1e-9);
  EXPECT_EQ(found[0].frame_of_birth, 1);
}

TEST(SingularPointRulesTest, NoSingularPointIsBornWhereItIsForbidden) {
  Shot shot = shot_of(sample("S8_dcone.glb"));
  const auto without_rules = born(shot, 56);
  ASSERT_FALSE(without_rules.empty());
  const SingularPointRules::Disc disc{without_rules.front().pattern, 0.02};
  shot.singular_point_rules.forbidden = {disc};
  const auto others = born(shot, 56);
  ASSERT_FALSE(others.empty()) << "the next best place is taken";
  for (const SingularPoint& s : others) EXPECT_GT((s.pattern - disc.centre).norm(), disc.radius);
}

// S1 with a crease that was folded by 17 degrees before the first frame
Shot creased_push() {
  Scene scene = sample("S1_push.glb");
  Shot shot = shot_of(scene);
  const Vector2d size = extent(shot.pattern);
  shot.pattern.prescribed_creases = {{{{0.5 * size.x(), 0}, {0.5 * size.x(), size.y()}}, 0.3}};
  return shot;
}

/// [rad] Mean angle over the hinges on the crease, and over the others that are nearly as steep on
/// the pattern.
std::pair<double, double> mean_turns(const Sheet& sheet) {
  const Hinges hinges = find_hinges(sheet.triangles);
  const auto lines = crease_of_hinges(sheet, hinges);
  double on = 0, off = 0, on_length = 0, off_length = 0;
  for (std::size_t h = 0; h < lines.size(); ++h) {
    const auto& v = hinges.hinges[h].vertices;
    const Vector2d along = sheet.pattern.row(v[1]) - sheet.pattern.row(v[0]);
    const double turn = std::abs(dihedral_angle(sheet.x, hinges.hinges[h])), length = along.norm();
    if (lines[h]) {
      on += turn * length;
      on_length += length;
    } else if (std::abs(along.x()) < 0.3 * length) {
      off += turn * length;
      off_length += length;
    }
  }
  return {on / std::max(on_length, 1e-9), off / std::max(off_length, 1e-9)};
}

TEST(SingularPointRulesTest, PaperPushedTogetherBendsAtItsCreaseWithEveryMethod) {
  const Shot shot = creased_push();
  for (const MethodChoice& method :
       {hybrid(shot.pattern, shot.paper, 120, {}, 0, 0), fem(600), adaptive(shot.pattern, 600)}) {
    AnimateOptions options;
    options.last_frame = 24;
    options.plasticity = method.name == "fem" ? Plasticity::off : Plasticity::on;
    ShotRecord record;
    Sheet last;
    animate(shot, method, options, [&](const AnimatedFrame& f) {
      record.add(f);
      last = *f.sheet;
      return true;
    });
    double along = 0;  // [m] length of the edges on the crease
    const Hinges hinges = find_hinges(last.triangles);
    const auto lines = crease_of_hinges(last, hinges);
    for (std::size_t h = 0; h < lines.size(); ++h)
      if (lines[h])
        along += (last.pattern.row(hinges.hinges[h].vertices[0]) -
                  last.pattern.row(hinges.hinges[h].vertices[1]))
                     .norm();
    EXPECT_NEAR(along, extent(shot.pattern).y(), 1e-6)
        << method.name << ": the mesh keeps the line";
    const auto [on, off] = mean_turns(last);
    EXPECT_GT(on, 0.25) << method.name;
    EXPECT_GT(on, 3 * off) << method.name;

    const auto creases = detect_creases(last, {}, shot.pattern, CreaseThresholds{});
    double drawn = 0;
    for (const DetectedCrease& crease : creases)
      if (crease_under(shot.pattern.prescribed_creases, crease.from, crease.to))
        drawn += (crease.to - crease.from).norm();
    EXPECT_GT(drawn, 0.9 * along) << method.name << ": it is in the map";

    RenderSurface render =
        make_render_surface(shot.pattern, record.features(shot), record.edge(), Quality::draft);
    render.hold(record.frames().back().held);
    const Sheet recorded = record.sheet(record.frames().back());
    const RenderFrame shown =
        render.frame(recorded, render.locate_on(recorded.pattern, recorded.triangles),
                     record.frames().back().held_at);
    double sharpest = 0;  // [rad] between two normals of one vertex
    const Triangles& numbers = render.normal_of_corner();
    for (const auto& [a, b] : render.mesh().creases)
      for (int t = 0; t < numbers.rows(); ++t)
        for (int i = 0; i < 3; ++i)
          if (render.mesh().triangles(t, i) == a && numbers(t, i) != a)
            sharpest = std::max(
                sharpest,
                std::acos(std::clamp(shown.normals.row(numbers(t, i)).dot(shown.normals.row(a)),
                                     -1.0, 1.0)));
    EXPECT_GT(sharpest, 0.6 * on) << method.name << ": and has normals of its own on either side";
  }
}

TEST(SingularPointRulesTest, ACreaseSpringsBackToItsAngle) {
  Shot shot = creased_push();
  shot.handles.resize(2);
  shot.handles[1] = shot.handles[0];  // held in space at one point only
  shot.pattern.prescribed_creases[0].angle = 0.5;
  Sheet last;
  AnimateOptions options;
  options.last_frame = 40;
  animate(shot, fem(300), options, [&](const AnimatedFrame& f) {
    last = *f.sheet;
    return true;
  });
  EXPECT_NEAR(mean_turns(last).first, 0.5, 0.02);
}

TEST(SingularPointRulesTest, CreasesThatCrossAreRowsOfEdgesInEveryMesh) {
  Pattern pattern{{{0, 0}, {0.2, 0}, {0.2, 0.1}, {0, 0.1}}, {}, {}};
  pattern.prescribed_creases = {{{{0, 0}, {0.2, 0.1}}, 0},
                                {{{0, 0.1}, {0.07, 0.04}, {0.2, 0.02}}, 0},
                                {{{0.1, 0}, {0.1, 0.1}}, 0}};
  double length = 0;
  for (const PrescribedCrease& fold : pattern.prescribed_creases)
    for (std::size_t k = 0; k + 1 < fold.line.size(); ++k)
      length += (fold.line[k + 1] - fold.line[k]).norm();
  for (const double edge : {0.04, 0.013, 0.004}) {
    const PatternMesh mesh = mesh_pattern(pattern, edge, {{0.05, 0.05}});
    Sheet sheet{mesh.vertices, {}, {}, mesh.triangles, {}, pattern.prescribed_creases};
    const Hinges hinges = find_hinges(mesh.triangles);
    const auto lines = crease_of_hinges(sheet, hinges);
    double found = 0;
    for (std::size_t h = 0; h < lines.size(); ++h)
      if (lines[h])
        found += (mesh.vertices.row(hinges.hinges[h].vertices[0]) -
                  mesh.vertices.row(hinges.hinges[h].vertices[1]))
                     .norm();
    EXPECT_NEAR(found, length, 1e-9) << edge;
    EXPECT_EQ(mesh.vertices.row(mesh.point_vertex[0]), Eigen::RowVector2d(0.05, 0.05));
  }
}

TEST(SingularPointRulesTest, TheForceOfACreaseIsTheGradientOfItsEnergy) {
  Pattern pattern{{{0, 0}, {0.1, 0}, {0.1, 0.1}, {0, 0.1}}, {}, {}};
  pattern.prescribed_creases = {{{{0.03, 0}, {0.05, 0.1}}, 0.4}};
  const PatternMesh mesh = mesh_pattern(pattern, 0.03, {});
  Paper paper;
  paper.membrane_stiffness = 1e-3;  // what is left is bending
  const ElasticEnergy energy(paper, mesh.vertices, mesh.triangles, {}, pattern.prescribed_creases),
      plain(paper, mesh.vertices, mesh.triangles);
  Points3 x(mesh.vertices.rows(), 3), gradient;
  for (int v = 0; v < x.rows(); ++v)
    x.row(v) << mesh.vertices.row(v),
        0.01 * std::sin(40 * mesh.vertices(v, 0)) + 0.1 * mesh.vertices(v, 0) * mesh.vertices(v, 1);
  EXPECT_GT(std::abs(energy.energy(x) / plain.energy(x) - 1), 0.01);
  energy.gradient(x, gradient);
  constexpr double step = 1e-7;
  double worst = 0;
  for (int v = 0; v < x.rows(); ++v)
    for (int c = 0; c < 3; ++c) {
      Points3 up = x, down = x;
      up(v, c) += step;
      down(v, c) -= step;
      worst = std::max(
          worst, std::abs((energy.energy(up) - energy.energy(down)) / (2 * step) - gradient(v, c)));
    }
  ASSERT_GT(gradient.norm(), 1e-3);
  EXPECT_LT(worst, 1e-5 * gradient.norm());
}

}  // namespace
}  // namespace paperbake
