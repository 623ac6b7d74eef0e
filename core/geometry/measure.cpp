#include "core/geometry/measure.h"

#include "core/geometry/singular_vertices.h"
#include "core/model/segment2.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_set>

namespace paperbake {

/// [1] |l - L|/L of an edge
static double length_error(const Sheet& sheet, int a, int b) {
  const double rest = (sheet.pattern.row(a) - sheet.pattern.row(b)).norm();
  return std::abs((sheet.x.row(a) - sheet.x.row(b)).norm() - rest) / rest;
}

WorstEdge worst_edge(const Sheet& sheet) {
  WorstEdge worst;
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i) {
      const int a = sheet.triangles(t, i), b = sheet.triangles(t, (i + 1) % 3);
      if (const double error = length_error(sheet, a, b); error > worst.error)
        worst = {error, 0.5 * (sheet.pattern.row(a) + sheet.pattern.row(b))};
    }
  return worst;
}

LengthDistortion length_distortion(const Sheet& sheet) {
  const WorstEdge worst = worst_edge(sheet);
  double sum = 0, count = 0;
  std::unordered_set<std::uint64_t> seen;
  seen.reserve(3 * sheet.triangles.rows());
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i) {
      const int a = sheet.triangles(t, i), b = sheet.triangles(t, (i + 1) % 3);
      if (!seen.insert((std::uint64_t(std::min(a, b)) << 32) | std::uint32_t(std::max(a, b)))
               .second)
        continue;
      sum += length_error(sheet, a, b);
      count += 1;
    }
  return {count > 0 ? sum / count : 0, worst.error, worst.where};
}

double largest_stretch(const Sheet& sheet) {
  double largest = 0;
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i) {
      const int a = sheet.triangles(t, i), b = sheet.triangles(t, (i + 1) % 3);
      const double rest = (sheet.pattern.row(a) - sheet.pattern.row(b)).squaredNorm(),
                   now = (sheet.x.row(a) - sheet.x.row(b)).squaredNorm();
      largest = std::max(largest, now / rest);
    }
  return largest > 1 ? std::sqrt(largest) - 1 : 0;
}

double mean_edge(const Points2& pattern, const Triangles& triangles) {
  double sum = 0;
  for (int t = 0; t < triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i)
      sum += (pattern.row(triangles(t, i)) - pattern.row(triangles(t, (i + 1) % 3))).norm();
  return sum / (3 * std::max<long>(1, triangles.rows()));
}

double angle_defect_max(const Sheet& sheet) {
  const long n = sheet.x.rows();
  std::vector<double> angle(n, 0.0), flat(n, 0.0);
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i) {
      const int a = sheet.triangles(t, i), b = sheet.triangles(t, (i + 1) % 3),
                c = sheet.triangles(t, (i + 2) % 3);
      angle[a] += angle_between(sheet.x.row(b) - sheet.x.row(a), sheet.x.row(c) - sheet.x.row(a));
      const Vector2d u = sheet.pattern.row(b) - sheet.pattern.row(a),
                     v = sheet.pattern.row(c) - sheet.pattern.row(a);
      flat[a] += std::atan2(std::abs(cross(u, v)), u.dot(v));
    }
  const std::vector<char> singular = singular_vertices(sheet);
  double worst = 0;
  for (long v = 0; v < n; ++v) {
    const bool inside = std::abs(flat[v] - 2 * M_PI) < 1e-6;
    if (inside && !singular[v]) worst = std::max(worst, std::abs(2 * M_PI - angle[v]));
  }
  return worst;
}

Points3 vertex_normals(const Points3& x, const Triangles& triangles) {
  Points3 normals = Points3::Zero(x.rows(), 3);
  for (int t = 0; t < triangles.rows(); ++t) {
    const Vector3d a = x.row(triangles(t, 0)), b = x.row(triangles(t, 1)),
                   c = x.row(triangles(t, 2));
    const Vector3d n = (b - a).cross(c - a).stableNormalized();
    const Vector3d corner[3] = {a, b, c};
    for (int i = 0; i < 3; ++i)
      normals.row(triangles(t, i)) +=
          angle_between(corner[(i + 1) % 3] - corner[i], corner[(i + 2) % 3] - corner[i]) * n;
  }
  for (int v = 0; v < normals.rows(); ++v) {
    const double length = normals.row(v).norm();
    if (length > 1e-12)
      normals.row(v) /= length;
    else
      normals.row(v) =
          Eigen::RowVector3d::UnitZ();  // folded flat onto itself: any direction is as good
  }
  return normals;
}

double rms_distance(const Points3& a, const Points3& b) {
  return std::sqrt((a - b).rowwise().squaredNorm().mean());
}

}  // namespace paperbake
