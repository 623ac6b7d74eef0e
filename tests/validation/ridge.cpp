#include "core/animate.h"
#include "tests/test_shots.h"
#include "tests/validation/cases.h"

// The minimal ridge of [Lobkovsky 1996]: opposite borders of a strip are held in the shape of a V; the paper between them is free.

namespace paperbake::validation {
namespace {

constexpr double X = 0.1, half = 0.04;  // [m] length of the ridge; of each flap

/// Both borders folded along the middle, to 90 degrees between the flaps, in frames 1-13, then at rest.
Shot folded_strip(double thickness) {
  constexpr int frames = 13, points = 48;
  Shot shot = test::blank_shot(test::rectangle(X, 2 * half));
  const double factor = thickness / shot.paper.thickness;
  shot.paper.thickness *= factor, shot.paper.membrane_stiffness *= factor;
  shot.paper.bending_stiffness *= factor * factor * factor;
  for (const double u : {0.0, X})
    for (int k = 0; k <= points; ++k) {
      Handle handle = test::bare_handle("border", {u, 2 * half * k / points}, frames);
      const double out = handle.pattern.y() - half;
      for (int f = 0; f < frames; ++f) {
        const double slope = 0.25 * M_PI * f / (frames - 1);
        handle.keyed.row(f) << u, half + out * std::cos(slope), -std::abs(out) * std::sin(slope);
      }
      shot.handles.push_back(handle);
    }
  return shot;
}

struct Stored {
  double energy, share;  // over D; [1] of it in the membrane
  bool converged;
};
Stored fold(const Method& method, const Shot& shot) {
  AnimateOptions options;
  options.last_frame = 16;
  options.elastic.stop = 1e-7;
  options.elastic.contact = SelfContact::off;
  Stored stored{};
  animate(shot, method, options, [&](const AnimatedFrame& frame) {
    stored = {frame.energy / shot.paper.bending_stiffness, frame.membrane_energy / frame.energy, frame.converged};
    return true;
  });
  return stored;
}

/// Slope of ln E/D against ln X/h over a decade of h by least squares, and what it is made of.
void judge(Rows& rows, const std::string& name, const std::function<Method(const Shot&)>& method, double tolerance) {
  double n = 0, s = 0, ss = 0, e = 0, se = 0;
  Rows single;
  for (const double thickness : {2e-5, 3.6e-5, 6.3e-5, 1.1e-4, 2e-4}) {
    const Shot shot = folded_strip(thickness);
    const Stored stored = fold(method(shot), shot);
    const double a = std::log(X / thickness), b = std::log(stored.energy);
    n += 1, s += a, ss += a * a, e += b, se += a * b;
    char label[80];
    std::snprintf(label, sizeof label, "%s, X/h %.0f", name.c_str(), X / thickness);
    single.push_back({label, "E / D", 0, stored.energy, 0, "", ""});
    single.push_back({label, "bending over stretching", 5, 1 / stored.share - 1, 0, "V5: 5 in the limit", ""});
    if (!stored.converged) single.push_back({label, "unconverged frames at rest", 0, 1, 0.5, "", ""});
  }
  rows.push_back({name, "exponent of E/D in X/h", 1 / 3.0, (n * se - s * e) / (n * ss - s * s), tolerance, "V5: minimal ridge", ""});
  rows.insert(rows.end(), single.begin(), single.end());
}

}  // namespace

Rows ridge() {
  Rows rows;
  constexpr double tolerance = 0.05 * 3;  // 0.05 of 0.333
  for (const int triangles : {6000, 12000}) judge(rows, "fem " + std::to_string(triangles), [&](const Shot&) { return fem(triangles); }, tolerance);
  judge(rows, "adaptive 3000", [](const Shot& shot) { return adaptive(shot.pattern, 3000); }, tolerance);
  rows.push_back({"hybrid", "exponent of E/D in X/h", 0, 0, 0, "", "a ruled mesh has no stretching ridge (known limit of the paper)"});
  return rows;
}

}  // namespace paperbake::validation
