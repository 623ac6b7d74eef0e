#include "core/hands/held_points.h"

#include "core/geometry/point_location.h"

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

constexpr double on_a_line = 0.01;  // [1] of the longer side

/// Largest distance of a held point from one line through held points, on the pattern. [m]
double off_line(const Shot& shot, const std::vector<int>& held) {
  double off = 0;
  Vector2d farthest = Vector2d::Zero();
  for (const int h : held)
    if (const Vector2d d = shot.handles[h].pattern - shot.handles[held.front()].pattern;
        d.norm() > farthest.norm())
      farthest = d;
  if (farthest.norm() == 0) return 0;
  const Vector2d across = Vector2d(-farthest.y(), farthest.x()).normalized();
  for (const int h : held)
    off = std::max(
        off, std::abs(across.dot(shot.handles[h].pattern - shot.handles[held.front()].pattern)));
  return off;
}

/// Where a handle holds the sheet in the first frame. [m]
Vector3d holds_at(const Shot& shot, int handle) {
  const Handle& h = shot.handles[handle];
  if (h.mode != HandleMode::relative) return keyed_position(h, 0);
  const PointLocator locator(shot.start.pattern, shot.start.triangles);
  return interpolate(locator.locate(h.pattern), shot.start.triangles, shot.start.x);
}

}  // namespace

std::vector<int> held_handles(const Shot& shot, int frame) {
  std::vector<int> held;
  for (std::size_t h = 0; h < shot.handles.size(); ++h)
    if (shot.handles[h].held(frame)) held.push_back(static_cast<int>(h));
  return held;
}

bool is_held_on_a_line(const Shot& shot, const std::vector<int>& held) {
  return !held.empty() && off_line(shot, held) <= on_a_line * longer_side(shot.pattern);
}

Vector3d held_line(const Shot& shot, const std::vector<int>& held) {
  Vector3d along = Vector3d::Zero();
  for (const int h : held)
    if (const Vector3d d =
            keyed_position(shot.handles[h], 0) - keyed_position(shot.handles[held.front()], 0);
        d.norm() > along.norm())
      along = d;
  return along;
}

Vector3d held_middle(const Shot& shot, const std::vector<int>& held) {
  Vector3d middle = Vector3d::Zero();
  for (const int h : held) middle += holds_at(shot, h) / held.size();
  return middle;
}

}  // namespace paperbake
