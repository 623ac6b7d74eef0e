// Sheets with a crease that exists from the start, in every method, in the map and when rendered.

#include "core/animation/animate.h"
#include "core/geometry/hinges.h"
#include "core/geometry/prescribed_creases.h"
#include "core/methods/adaptive.h"
#include "core/methods/fem.h"
#include "core/methods/hybrid.h"
#include "core/render/render_surface.h"
#include "core/render/shot_record.h"
#include "formats/maps/crease_history.h"
#include "formats/scene/scene_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace paperbake {
namespace {

/// S1 with a crease that was folded by 17 degrees before the first frame.
Shot creased_push() {
  const SceneSheet s = read_scene(PAPERBAKE_SAMPLES "/S1_push.glb").sheets.front();
  Shot shot{s.name, s.pattern, s.start, s.handles, Paper{}};
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

TEST(CreasedShotsTest, PaperPushedTogetherBendsAtItsCreaseWithEveryMethod) {
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

TEST(CreasedShotsTest, ACreaseSpringsBackToItsAngle) {
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

}  // namespace
}  // namespace paperbake
