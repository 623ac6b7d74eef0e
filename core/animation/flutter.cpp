#include "core/animation/flutter.h"

#include "core/hands/held_points.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace paperbake {
namespace {

constexpr double edges_per_wave = 12;
// [1] of the longer side: a sheet whose middle is held streams nowhere
constexpr double least_lever = 0.05;

/// Unit vector from the points that hold the sheet to its middle, across their line. 0: none
Vector3d streams_towards(const Shot& shot, const std::vector<int>& held) {
  Vector3d free = shot.start.x.colwise().mean().transpose() - held_middle(shot, held);
  if (const Vector3d line = held_line(shot, held); line.norm() > 0)
    free -= line * line.dot(free) / line.squaredNorm();
  const bool is_beside = free.norm() > least_lever * longer_side(shot.pattern);
  return is_beside ? Vector3d(free.normalized()) : Vector3d::Zero();
}

}  // namespace

double flutter_wavelength(const Paper& paper, double air_density, double speed) {
  const double rho = paper.area_density, D = paper.bending_stiffness;
  const double pressure = drag_across * air_density / 2 * speed * speed, damping = pressure / speed;
  // of w = exp(i k s + r t): 2 rho times the larger real part of r, but for a constant
  const auto growth = [&](double k) {
    const double a = damping * damping - 4 * rho * D * k * k * k * k, b = 4 * rho * pressure * k;
    return std::sqrt((std::sqrt(a * a + b * b) + a) / 2);
  };
  double low = 0, high = speed * std::sqrt(rho / D);  // it grows from 0 to its maximum, and falls
  for (int halving = 0; halving < 60; ++halving) {
    const double a = (2 * low + high) / 3, b = (low + 2 * high) / 3;
    (growth(a) < growth(b) ? low : high) = growth(a) < growth(b) ? a : b;
  }
  return 4 * M_PI / (low + high);
}

double speed_along_flag(const Shot& shot, const Air& air, int first_frame) {
  const std::vector<int> held = held_handles(shot, first_frame);
  if (!is_held_on_a_line(shot, held)) return 0;
  const Vector3d free = streams_towards(shot, held);
  Eigen::Index frames = 0;
  for (const Wind& wind : air.winds) frames = std::max(frames, wind.velocity.rows());
  double most = 0;
  for (Eigen::Index f = 0; f < frames; ++f) {
    Vector3d velocity = Vector3d::Zero();
    for (const Wind& wind : air.winds)
      velocity += wind.velocity.row(std::min(f, wind.velocity.rows() - 1)).transpose();
    const double along = velocity.dot(free);
    if (along >= std::sqrt(0.5) * velocity.norm()) most = std::max(most, along);
  }
  return most;
}

double longest_edge_of_flag(const Shot& shot, const Air& air, int first_frame) {
  const double speed = air.density > 0 ? speed_along_flag(shot, air, first_frame) : 0;
  if (speed <= 0) return std::numeric_limits<double>::infinity();
  return flutter_wavelength(shot.paper, air.density, speed) / edges_per_wave;
}

}  // namespace paperbake
