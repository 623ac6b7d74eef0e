#pragma once

#include "tests/core/test_meshes.h"

#include <algorithm>
#include <cmath>

namespace paperbake::test {

/// Bends a sheet to a right circular cone without stretching it.
/// apex   [m] on the pattern
/// slope  [rad] of the generators against the axis
/// The curvature is 1/(tan(slope) r) at a distance r from the apex; the cone bulges towards its
/// normal.
inline void bend_to_cone(Sheet& sheet, const Vector2d& apex, double slope) {
  for (int v = 0; v < sheet.pattern.rows(); ++v) {
    const Vector2d d = sheet.pattern.row(v).transpose() - apex;
    const double r = d.norm(), phi = std::atan2(d.y(), d.x()) / std::sin(slope);
    sheet.x.row(v) << r * std::sin(slope) * std::cos(phi), r * std::sin(slope) * std::sin(phi),
        -r * std::cos(slope);
  }
}

/// Bends a sheet about the origin of its pattern, without stretching it, to a cone whose rulings
/// have the slope eps + crest lobe(t): at the elevation alpha(t) a ruling has the azimuth phi with
/// dphi = sqrt(1 - alpha'^2)/cos alpha dt, and `crest` is such that the cone closes after one turn.
/// returns  int kg^2 dt, where kg is the geodesic curvature of the curve in which the cone cuts the
///          unit sphere: psi' + tan alpha cos psi, sin psi = alpha'
inline double bend_to_wavy_cone(Sheet& sheet, double eps,
                                const std::function<double(double)>& lobe) {
  constexpr int n = 7200;
  constexpr double dt = 2 * M_PI / n;
  double crest = 0;
  std::vector<double> alpha(n + 1), phi(n + 1);
  const auto turn = [&] {
    for (int k = 0; k <= n; ++k) alpha[k] = std::atan(eps + crest * lobe(-M_PI + k * dt));
    for (int k = 0; k < n; ++k)
      phi[k + 1] =
          phi[k] + std::sqrt(std::max(0.0, dt * dt - std::pow(alpha[k + 1] - alpha[k], 2))) /
                       std::cos(0.5 * (alpha[k] + alpha[k + 1]));
    return phi[n];
  };
  double low = 0, high = 20 * eps;
  for (int k = 0; k < 60; ++k) {
    crest = 0.5 * (low + high);
    (turn() > 2 * M_PI ? low : high) = crest;
  }
  double squared = 0;
  for (int k = 0; k < n; ++k) {
    const double before = std::asin((alpha[k] - alpha[(k + n - 1) % n]) / dt),
                 after = std::asin((alpha[k + 1] - alpha[k]) / dt);
    squared +=
        std::pow((after - before) / dt + std::tan(alpha[k]) * std::cos(0.5 * (before + after)), 2) *
        dt;
  }
  for (int v = 0; v < sheet.x.rows(); ++v) {
    const double r = sheet.pattern.row(v).norm(),
                 t = std::atan2(sheet.pattern(v, 1), sheet.pattern(v, 0));
    const double place = (t + M_PI) / dt;
    const int k = std::min(n - 1, static_cast<int>(place));
    const double a = alpha[k] + (place - k) * (alpha[k + 1] - alpha[k]),
                 azimuth = phi[k] + (place - k) * (phi[k + 1] - phi[k]);
    sheet.x.row(v) << r * std::cos(a) * std::cos(azimuth), r * std::cos(a) * std::sin(azimuth),
        r * std::sin(a);
  }
  return squared;
}

/// The crest of a d-cone, which lifts off over 139 degrees.
inline double d_cone_lobe(double t) {
  constexpr double half = 139.0 / 2 * M_PI / 180;
  return std::abs(t) < half ? 0.5 * (1 + std::cos(M_PI * t / half)) : 0;
}

}  // namespace paperbake::test
