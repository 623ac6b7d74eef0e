#pragma once

#include "core/animation/animate.h"

#include <cmath>

namespace paperbake::test {

inline Pattern rectangle(double width, double height) {
  return {{{0, 0}, {width, 0}, {width, height}, {0, height}}, {}};
}

/// An L: the 0.2 m square without its upper right quarter; the re-entrant corner is (0.1, 0.1).
inline Pattern ell() {
  return {{{0, 0}, {0.2, 0}, {0.2, 0.1}, {0.1, 0.1}, {0.1, 0.2}, {0, 0.2}}, {}};
}

inline Shot blank_shot(const Pattern& pattern) {
  Shot shot;
  shot.sheet_name = "paper";
  shot.pattern = pattern;
  const int n = static_cast<int>(pattern.outline.size());
  shot.start.pattern.resize(n, 2);
  for (int i = 0; i < n; ++i) shot.start.pattern.row(i) = pattern.outline[i];
  shot.start.x = Points3::Zero(n, 3);
  shot.start.x.leftCols<2>() = shot.start.pattern;
  shot.start.triangles.resize(n - 2, 3);
  for (int i = 0; i + 2 < n; ++i) shot.start.triangles.row(i) << 0, i + 1, i + 2;
  return shot;
}

inline Handle bare_handle(const std::string& name, const Vector2d& pattern, int frames) {
  Handle handle;
  handle.name = name;
  handle.pattern = pattern;
  handle.radius = 0;
  handle.keyed.resize(frames, 3);
  for (int f = 0; f < frames; ++f) handle.keyed.row(f) << pattern.x(), pattern.y(), 0;
  return handle;
}

/// Scene S1: a sheet of 10 cm, hinged at two borders, the right one pushed 10 mm inwards in frames
/// 1-24. With `back` it returns in frames 24-47; otherwise the middle of the front border is pushed
/// down by 20 mm from frame 24 to frame 60.
inline Shot s1_push(bool back = false) {
  const int frames = back ? 47 : 60;
  Shot shot = blank_shot(rectangle(0.1, 0.1));
  for (int i = 0; i <= 10; ++i)
    for (double side : {0.0, 0.1}) {
      Handle handle = bare_handle((side > 0 ? "handle.right." : "handle.left.") + std::to_string(i),
                                  {side, 0.01 * i}, frames);
      for (int f = 0; side > 0 && f < frames; ++f) {
        const double way = back && f > 23 ? (46 - f) / 23.0 : std::min(f, 23) / 23.0;
        handle.keyed(f, 0) -= 0.01 * way;
      }
      shot.handles.push_back(handle);
    }
  if (!back) {
    Handle mid = bare_handle("handle.mid.0", {0.05, 0}, frames);
    mid.mode = HandleMode::relative;
    mid.grab_frame = 24;
    mid.radius = 0.002;
    for (int f = 23; f < frames; ++f) mid.keyed(f, 2) -= 0.02 * (f - 23) / 36;
    shot.handles.push_back(mid);
  }
  // the start shape of the scene has a slight arch, a half wave of 0.1 mm
  const int n = 20;
  shot.start.pattern.resize(2 * (n + 1), 2);
  shot.start.x.resize(2 * (n + 1), 3);
  shot.start.triangles.resize(2 * n, 3);
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j < 2; ++j) {
      shot.start.pattern.row(2 * i + j) << 0.1 * i / n, 0.1 * j;
      shot.start.x.row(2 * i + j) << 0.1 * i / n, 0.1 * j, 1e-4 * std::sin(M_PI * i / n);
    }
  for (int i = 0; i < n; ++i) {
    shot.start.triangles.row(2 * i) << 2 * i, 2 * i + 2, 2 * i + 3;
    shot.start.triangles.row(2 * i + 1) << 2 * i, 2 * i + 3, 2 * i + 1;
  }
  return shot;
}

}  // namespace paperbake::test
