#include "core/animation/animate.h"
#include "core/methods/adaptive.h"
#include "core/methods/fem.h"
#include "tests/core/test_shots.h"
#include "tests/validation/cases.h"

// The minimal ridge of [Lobkovsky 1996]: opposite borders of a strip are held in the shape of a V,
// and the paper between them is free. The law holds for thin paper: the local exponent is 0.23 at
// X/h = 250 and 0.30 at 700, so the decade is 500-5000. There the ridge is 2-5 mm wide, and the
// 1.8 mm edges of fem 6000 do not resolve it. A converged ridge stores about five times as much
// energy in bending as in stretching.

namespace paperbake::validation {
namespace {

constexpr double X = 0.1, half = 0.04;  // [m] length of the ridge; width of each flap

/// A sheet that is folded sharply along its middle, which does not stretch it, and then left free
/// between its borders.
Shot folded_strip(double thickness) {
  constexpr int points = 48;
  Shot shot = test::blank_shot(test::rectangle(X, 2 * half));
  const double factor = thickness / shot.paper.thickness;
  shot.paper.thickness *= factor;
  shot.paper.membrane_stiffness *= factor;
  shot.paper.bending_stiffness *= factor * factor * factor;
  const auto place = [](double u, double v) {
    return Vector3d(u, half + (v - half) * std::sqrt(0.5), -std::abs(v - half) * std::sqrt(0.5));
  };
  shot.start.pattern.resize(6, 2);
  shot.start.pattern << 0, 0, X, 0, 0, half, X, half, 0, 2 * half, X, 2 * half;
  shot.start.x.resize(6, 3);
  for (int v = 0; v < 6; ++v)
    shot.start.x.row(v) = place(shot.start.pattern(v, 0), shot.start.pattern(v, 1));
  shot.start.triangles.resize(4, 3);
  shot.start.triangles << 0, 1, 3, 0, 3, 2, 2, 3, 5, 2, 5, 4;
  for (const double u : {0.0, X})
    for (int k = 0; k <= points; ++k) {
      const double v = 2 * half * k / points;
      Handle handle = test::bare_handle("border", {u, v}, 1);
      handle.keyed.row(0) = place(u, v);
      shot.handles.push_back(handle);
    }
  return shot;
}

struct Stored {
  double energy, share;  // [1] over D; [1] its share in the membrane
  bool converged;
};
Stored fold(const MethodChoice& method, const Shot& shot) {
  AnimateOptions options;
  options.last_frame = 12;
  options.elastic.stop = 1e-7;
  options.elastic.contact = SelfContact::off;
  Stored stored{};
  animate(shot, method, options, [&](const AnimatedFrame& frame) {
    stored = {frame.statistics.energy / shot.paper.bending_stiffness,
              frame.statistics.membrane_energy / frame.statistics.energy,
              frame.statistics.converged};
    return true;
  });
  return stored;
}

/// Slope of ln E/D against ln X/h over a decade of h, by least squares, and the values that it is
/// made of.
void judge(Rows& rows, const std::string& name,
           const std::function<MethodChoice(const Shot&)>& method, double tolerance) {
  double n = 0, s = 0, ss = 0, e = 0, se = 0;
  Rows single;
  for (const double thickness : {2e-5, 3.6e-5, 6.3e-5, 1.1e-4, 2e-4}) {
    const Shot shot = folded_strip(thickness);
    const Stored stored = fold(method(shot), shot);
    const double a = std::log(X / thickness), b = std::log(stored.energy);
    n += 1;
    s += a;
    ss += a * a;
    e += b;
    se += a * b;
    char label[80];
    std::snprintf(label, sizeof label, "%s, X/h %.0f", name.c_str(), X / thickness);
    single.push_back({label, "E / D", 0, stored.energy, 0, "", ""});
    single.push_back(
        {label, "bending over stretching", 5, 1 / stored.share - 1, 0, "V5: 5 in the limit", ""});
    if (!stored.converged)
      single.push_back({label, "unconverged frames at rest", 0, 1, 0.5, "", ""});
  }
  rows.push_back({name, "exponent of E/D in X/h", 1 / 3.0, (n * se - s * e) / (n * ss - s * s),
                  tolerance, "V5: minimal ridge", ""});
  rows.insert(rows.end(), single.begin(), single.end());
}

}  // namespace

Rows ridge() {
  Rows rows;
  constexpr double tolerance = 0.05 * 3;  // 0.05 of 0.333
  for (const int triangles : {6000, 20000})
    judge(
        rows, "fem " + std::to_string(triangles), [&](const Shot&) { return fem(triangles); },
        tolerance);
  judge(
      rows, "adaptive 3000", [](const Shot& shot) { return adaptive(shot.pattern, 3000); },
      tolerance);
  rows.push_back({"hybrid", "exponent of E/D in X/h", 0, 0, 0, "",
                  "a ruled mesh has no stretching ridge (known limit of the paper)"});
  return rows;
}

}  // namespace paperbake::validation
