#include "core/animation/inertia_need.h"

#include "core/geometry/box_of.h"
#include "core/geometry/collider.h"
#include "core/hands/held_points.h"
#include "core/model/air.h"
#include "core/model/formatted.h"

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

constexpr double carried_along = 0.005, flung = 0.25;  // [1] of the longer side
constexpr double of_the_earth = 9.81;                  // [m/s2]

/// Twice the largest distance of the paper from the nearest held point. [m]
double free_length(const Shot& shot, const std::vector<int>& held) {
  constexpr int along = 21;
  const Vector2d size = extent(shot.pattern);
  double farthest = 0;
  for (int i = 0; i < along; ++i)
    for (int j = 0; j < along; ++j) {
      const Vector2d p(size.x() * i / (along - 1), size.y() * j / (along - 1));
      if (!contains(shot.pattern, p, 1e-6 * size.maxCoeff())) continue;
      double nearest = INFINITY;
      for (const int h : held) nearest = std::min(nearest, (shot.handles[h].pattern - p).norm());
      farthest = std::max(farthest, nearest);
    }
  return 2 * farthest;
}

/// True if the start shape hangs straight below the points that hold it.
bool hangs(const Shot& shot, const std::vector<int>& held, const ExternalForces& forces,
           double side) {
  Vector3d down = shot.start.x.colwise().mean().transpose() - held_middle(shot, held);
  if (const Vector3d along = held_line(shot, held); along.norm() > 0)
    down -= along * along.dot(down) / along.squaredNorm();
  return down.z() * forces.gravity < 0 && down.head<2>().norm() < carried_along * side;
}

/// Name of the first collider that comes, as it moves, into the place where the start shape hangs,
/// to within 0.5 % of the longer side; empty if there is none. Places are compared by their boxes.
std::string striking_collider(const Shot& shot, const std::vector<int>& held, double side) {
  if (!shot.colliders) return {};
  const Eigen::AlignedBox3d start = box_of(shot.start.x);
  const Vector3d around = Vector3d::Constant(carried_along * side);
  for (const Collider& collider : *shot.colliders) {
    const std::vector<Points3>& frames = collider.frames();
    for (std::size_t f = 1; f < frames.size(); ++f) {
      if (frames[f] == frames[f - 1]) continue;
      Eigen::AlignedBox3d sheet;  // wherever a handle has carried it
      for (const int h : held) {
        const Handle& handle = shot.handles[h];
        const int row = std::min(static_cast<int>(f), static_cast<int>(handle.keyed.rows()) - 1);
        sheet.extend(start.translated(keyed_position(handle, row) - keyed_position(handle, 0)));
      }
      sheet = {sheet.min() - around, sheet.max() + around};
      if (sheet.intersects(box_of(frames[f - 1]).extend(box_of(frames[f]))))
        return collider.mesh().name;
    }
  }
  return {};
}

/// Sway that the motion of one handle causes while it holds the sheet. [m]
double sway_of(const Shot& shot, const Handle& handle, const ExternalForces& forces, double fps,
               int first_frame, int last_frame) {
  double most = 0, w = 0;
  std::vector<int> held;
  Vector3d r = Vector3d::Zero(), r_per_w = r, v = r;  // r'/w
  for (int frame = first_frame; frame < last_frame; ++frame) {
    if (!handle.held(frame + 1)) continue;
    if (const std::vector<int> now = held_handles(shot, frame + 1); now != held) {
      held = now;
      const double l = free_length(shot, held);
      if (l <= 0) return most;
      const double before = w;
      w = std::sqrt(std::pow(M_PI, 4) * shot.paper.bending_stiffness /
                        (shot.paper.area_density * std::pow(l, 4)) +
                    (forces.gravity != 0 ? std::abs(forces.gravity) : of_the_earth) / l);
      if (before > 0) r_per_w *= before / w;
    }
    const Vector3d v_next = handle.held(frame)
                                ? Vector3d(fps * (keyed_position(handle, frame + 1 - first_frame) -
                                                  keyed_position(handle, frame - first_frame)))
                                : v;
    r_per_w -= (v_next - v) / w;
    v = v_next;
    const double a = w / fps;
    most = std::max(most, a < M_PI / 2 ? (std::cos(a) * r + std::sin(a) * r_per_w).norm()
                                       : std::hypot(r.norm(), r_per_w.norm()));
    const Vector3d turned = std::cos(a) * r + std::sin(a) * r_per_w;
    r_per_w = std::pow(velocity_kept, 24 / fps) * (std::cos(a) * r_per_w - std::sin(a) * r);
    r = turned;
  }
  return most;
}

}  // namespace

InertiaNeed need_of_inertia(const Shot& shot, const ExternalForces& forces, double fps,
                            int first_frame, int last_frame) {
  const double side = longer_side(shot.pattern);
  InertiaNeed need;
  for (const Handle& handle : shot.handles)
    need.sway =
        std::max(need.sway, sway_of(shot, handle, forces, fps, first_frame, last_frame) / side);
  const std::vector<int> at_first = held_handles(shot, first_frame);
  bool hanging = false;
  for (int frame = first_frame; frame <= last_frame && forces.gravity != 0; ++frame) {
    const std::vector<int> held = held_handles(shot, frame);
    if (held.empty())
      return {true, need.sway,
              formatted("nothing holds the sheet from frame %d on: it falls", frame)};
    if (!is_held_on_a_line(shot, held)) continue;
    if (held != at_first || !hangs(shot, held, forces, side) || need.sway > carried_along)
      return {true, need.sway,
              formatted("the sheet is held at a point or on a line from frame %d on: it swings",
                        frame)};
    if (!hanging)
      if (const std::string name = striking_collider(shot, held, side); !name.empty())
        return {true, need.sway,
                formatted("the sheet hangs where the collider \"%.100s\" moves: it swings",
                          name.c_str())};
    hanging = true;
  }
  need.needed = need.sway > flung;
  need.why =
      need.needed ? formatted("handles throw the sheet by %.0f %% of its side", 100 * need.sway)
      : shot.handles.empty() ? "no handle holds the sheet, and it has no weight"
      : hanging ? formatted("the sheet hangs at rest; handles carry it by %.2g %% of its side",
                            100 * need.sway)
                : formatted(
                      "handles hold the sheet; without air they would throw it by %.2g %% "
                      "of its side, less than %.0f %%",
                      100 * need.sway, 100 * flung);
  return need;
}

}  // namespace paperbake
