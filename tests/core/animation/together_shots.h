#pragma once

#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/methods/hybrid.h"
#include "tests/core/test_shots.h"

#include <functional>
#include <vector>

namespace paperbake::test {

/// The hybrid method with a mesh of 80 triangles.
inline MethodChoice small_hybrid(const Shot& shot, std::size_t sheet) {
  return hybrid(shot.pattern, shot.paper, 80, {}, 1, static_cast<std::uint32_t>(sheet));
}

/// A rectangle with a flat start shape: the point (u, v) of the pattern is at corner + u a + v b.
/// The start mesh has 4 x 4 cells.
inline Shot placed(double width, double height, const Vector3d& corner, const Vector3d& a,
                   const Vector3d& b) {
  constexpr int n = 4;
  Shot shot = blank_shot(rectangle(width, height));
  shot.start.pattern.resize((n + 1) * (n + 1), 2);
  shot.start.x.resize((n + 1) * (n + 1), 3);
  shot.start.triangles.resize(2 * n * n, 3);
  for (int j = 0, t = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const int k = j * (n + 1) + i;
      shot.start.pattern.row(k) << width * i / n, height * j / n;
      shot.start.x.row(k) = corner + shot.start.pattern(k, 0) * a + shot.start.pattern(k, 1) * b;
      if (i == n || j == n) continue;
      shot.start.triangles.row(t++) << k, k + 1, k + n + 2;
      shot.start.triangles.row(t++) << k, k + n + 2, k + n + 1;
    }
  return shot;
}

/// Holds a point of the pattern where it is at the start, displaced by `way` (argument: frames
/// since the first). [m]
inline void hold(Shot& shot, const Vector2d& pattern, int frames,
                 const std::function<Vector3d(int)>& way, const Vector3d& corner, const Vector3d& a,
                 const Vector3d& b) {
  Handle handle = bare_handle("handle." + std::to_string(shot.handles.size()), pattern, frames);
  for (int f = 0; f < frames; ++f)
    handle.keyed.row(f) = corner + pattern.x() * a + pattern.y() * b + way(f);
  shot.handles.push_back(handle);
}

inline Vector3d stays(int) { return Vector3d::Zero(); }

/// A curtain of 10 cm hangs from two corners at x = 20 mm. A palm of 6 cm, held at its corners, is
/// carried from x = 0 to 80 mm.
inline std::vector<Shot> pushed_curtain(int frames) {
  const Vector3d y(0, 1, 0), z(0, 0, 1), low(0.02, 0, 0), palm(0, 0.02, 0.01);
  Shot curtain = placed(0.1, 0.1, low, y, z), hand = placed(0.06, 0.06, palm, y, z);
  for (const double u : {0.0, 0.1}) hold(curtain, {u, 0.1}, frames, stays, low, y, z);
  for (const double u : {0.0, 0.06})
    for (const double v : {0.0, 0.06})
      hold(
          hand, {u, v}, frames, [=](int f) { return Vector3d(0.08 * f / (frames - 1.0), 0, 0); },
          palm, y, z);
  curtain.sheet_name = "curtain";
  hand.sheet_name = "hand";
  return {curtain, hand};
}

/// The result of a shot of several sheets.
struct Outcome {
  std::vector<std::vector<AnimatedFrame>> frames;  // by sheet
  std::vector<std::vector<Sheet>> shapes;
  int crossings = 0, crossings_with_others = 0, touching_others = 0;
  double stretch = 0, energy = 0, elastic_ms = 0;
};

inline Outcome outcome_of(const std::vector<Shot>& shots,
                          const std::function<MethodChoice(const Shot&, std::size_t)>& method_of,
                          const AnimateOptions& options) {
  std::vector<MethodChoice> methods;
  std::vector<AnimatedSheet> all;
  for (std::size_t s = 0; s < shots.size(); ++s) methods.push_back(method_of(shots[s], s));
  for (std::size_t s = 0; s < shots.size(); ++s) all.push_back({shots[s], methods[s], options});
  Outcome outcome;
  outcome.frames.resize(shots.size());
  outcome.shapes.resize(shots.size());
  animate_together(all, [&](const AnimatedFrame& f) {
    outcome.crossings += paperbake::crossings(*f.sheet);
    for (std::size_t o = 0; o < f.sheet_index; ++o)
      outcome.crossings_with_others += crossings_between(*f.sheet, outcome.shapes[o].back());
    outcome.touching_others = std::max(outcome.touching_others, f.statistics.touching_others);
    outcome.stretch = std::max(outcome.stretch, length_distortion(*f.sheet).largest);
    outcome.energy = std::max(outcome.energy, f.statistics.energy);
    outcome.elastic_ms += f.statistics.elastic_ms;
    outcome.frames[f.sheet_index].push_back(f);
    outcome.shapes[f.sheet_index].push_back(*f.sheet);
    return true;
  });
  return outcome;
}

}  // namespace paperbake::test
