#include "core/model/handles.h"

#include <algorithm>
#include <cmath>

namespace paperbake {

Vector3d keyed_position(const Handle& handle, int row) {
  return handle.keyed.row(std::clamp<long>(row, 0, handle.keyed.rows() - 1));
}

double disc_radius(const std::vector<Handle>& handles, std::size_t handle, const Pattern& pattern) {
  constexpr double finger = 0.010, lone_beyond = 0.030;  // [m]
  if (handles[handle].radius) return *handles[handle].radius;
  const double side = shorter_side(pattern);
  const double row = std::min(lone_beyond, 0.15 * side);
  for (std::size_t other = 0; other < handles.size(); ++other)
    if (other != handle && (handles[other].pattern - handles[handle].pattern).norm() < row)
      return 0;
  return std::min(finger, 0.05 * side);
}

std::vector<Vector2d> disc_rim(const Pattern& pattern, const Vector2d& centre, double radius) {
  std::vector<Vector2d> rim;
  if (radius <= 0) return rim;
  constexpr int samples = 720;
  const auto at = [&](double k) {
    const double a = 2 * M_PI * k / samples;
    return Vector2d(centre + radius * Vector2d(std::cos(a), std::sin(a)));
  };
  std::vector<char> in(samples);
  for (int k = 0; k < samples; ++k) in[k] = contains(pattern, at(k), 1e-6 * radius);
  const auto add_arc = [&](double from, double to, bool closed) {
    const int parts = std::max(1, static_cast<int>(std::lround((to - from) / (samples / 6.0))));
    for (int i = 0; i < parts + (closed ? 0 : 1); ++i)
      rim.push_back(at(from + (to - from) * i / parts));
  };
  // where the arc meets the border, between two samples
  const auto end = [&](double inside, double outside) {
    for (int halving = 0; halving < 40; ++halving) {
      const double middle = 0.5 * (inside + outside);
      (contains(pattern, at(middle), 1e-6 * radius) ? inside : outside) = middle;
    }
    return inside;
  };
  const int out = static_cast<int>(std::find(in.begin(), in.end(), 0) - in.begin());
  if (out == samples) add_arc(0, samples, true);
  // goes once round, from a sample outside; an arc ends where the next sample is outside
  for (int k = out, start = -1; out < samples && k <= out + samples; ++k) {
    const bool inside = in[k % samples];
    if (inside && start < 0) start = k;
    if (!inside && start >= 0) {
      add_arc(end(start, start - 1), end(k - 1, k), false);
      start = -1;
    }
  }
  for (Vector2d& p : rim) {  // avoids sliver triangles between rim and border
    const Vector2d border = nearest_border_point(pattern, p);
    if ((border - p).norm() < 0.02 * radius) p = border;
  }
  // where the circle hardly leaves the pattern, two arcs end beside each other: one point is enough
  std::vector<Vector2d> apart;
  for (const Vector2d& p : rim)
    if (apart.empty() || (p - apart.back()).norm() > 0.1 * radius) apart.push_back(p);
  while (apart.size() > 1 && (apart.front() - apart.back()).norm() <= 0.1 * radius)
    apart.pop_back();
  return apart;
}

}  // namespace paperbake
