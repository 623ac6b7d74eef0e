#include "core/render/mesh_changes.h"

namespace paperbake {
namespace {

/// Whether the sheet goes from this frame to the next one under the same handles.
bool moves_on(const std::vector<RecordedFrame>& frames, std::size_t k) {
  if (k + 1 >= frames.size() || frames[k].held != frames[k + 1].held) return false;
  return frames[k].mesh != frames[k + 1].mesh || frames[k].x != frames[k + 1].x;
}

double smooth_step(double t) { return t * t * t * (10 + t * (-15 + t * 6)); }

struct TriangleFrame {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();  // columns; none of a triangle without an area
  double area = 0;                                 // [m2]
};

TriangleFrame triangle_frame(const Points3& x, const Triangles& triangles, Eigen::Index t) {
  const Vector3d corner = x.row(triangles(t, 0)),
                 edge = x.row(triangles(t, 1)).transpose() - corner,
                 other = x.row(triangles(t, 2)).transpose() - corner, normal = edge.cross(other);
  const double length = edge.norm(), twice_area = normal.norm();
  if (twice_area <= 1e-9 * length * other.norm()) return {};
  TriangleFrame frame;
  frame.axes.col(0) = edge / length;
  frame.axes.col(2) = normal / twice_area;
  frame.axes.col(1) = frame.axes.col(2).cross(frame.axes.col(0));
  frame.area = 0.5 * twice_area;
  return frame;
}

}  // namespace

std::vector<ChangeShare> mesh_changes_near(const ShotRecord& record, std::size_t k, int half) {
  const std::vector<RecordedFrame>& frames = record.frames();
  const auto reach = static_cast<std::size_t>(half);
  std::vector<ChangeShare> near;
  for (std::size_t c = k < reach ? 1 : k - reach + 1; c <= k + reach && c < frames.size(); ++c) {
    if (frames[c].carried.rows() == 0 || frames[c].held != frames[c - 1].held) continue;
    // the last frame before the change and the first one after it that have no part in it
    std::size_t begin = c - 1, end = c;
    while (c - 1 - begin < reach && begin > 0 && moves_on(frames, begin - 1)) --begin;
    while (end - c < reach && moves_on(frames, end)) ++end;
    if (end + 1 == frames.size()) end = c + reach;  // as if it went on
    if (k <= begin || k >= end) continue;
    const double s = smooth_step(double(k - begin) / double(end - begin));
    near.push_back({c, k < c ? s : s - 1});
  }
  return near;
}

Points3 seen_by_triangles(const Triangles& triangles, const Points3& x,
                          const Points3& displacement) {
  Points3 seen(3 * triangles.rows(), 3);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Eigen::Matrix3d axes = triangle_frame(x, triangles, t).axes;
    for (int i = 0; i < 3; ++i) seen.row(3 * t + i) = displacement.row(triangles(t, i)) * axes;
  }
  return seen;
}

Points3 seen_from_outside(const Triangles& triangles, const Points3& x, const Points3& seen) {
  Points3 sum = Points3::Zero(x.rows(), 3);
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(x.rows());
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const TriangleFrame frame = triangle_frame(x, triangles, t);
    for (int i = 0; i < 3; ++i) {
      sum.row(triangles(t, i)) += frame.area * seen.row(3 * t + i) * frame.axes.transpose();
      areas[triangles(t, i)] += frame.area;
    }
  }
  for (Eigen::Index v = 0; v < sum.rows(); ++v)
    if (areas[v] > 0) sum.row(v) /= areas[v];
  return sum;
}

}  // namespace paperbake
