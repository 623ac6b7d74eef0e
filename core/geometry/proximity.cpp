#include "core/geometry/proximity.h"

#include <algorithm>
#include <limits>

namespace paperbake {
namespace {

ClosestPoints with_weights(const std::array<Vector3d, 4>& x, const Eigen::Vector4d& w) {
  return {w, w[0] * x[0] + w[1] * x[1] + w[2] * x[2] + w[3] * x[3]};
}

/// Six times the signed volume of a tetrahedron.
double volume6(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
  return (b - a).cross(c - a).dot(d - a);
}

bool same_sign(double a, double b) { return (a > 0 && b > 0) || (a < 0 && b < 0); }

}  // namespace

ClosestPoints vertex_to_triangle(const std::array<Vector3d, 4>& x) {
  const Vector3d &p = x[0], &a = x[1], &b = x[2], &c = x[3];
  const Vector3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return with_weights(x, {1, -1, 0, 0});
  const Vector3d bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return with_weights(x, {1, 0, -1, 0});
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double s = d1 / (d1 - d3);
    return with_weights(x, {1, s - 1, -s, 0});
  }
  const Vector3d cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return with_weights(x, {1, 0, 0, -1});
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double s = d2 / (d2 - d6);
    return with_weights(x, {1, s - 1, 0, -s});
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    const double s = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return with_weights(x, {1, 0, s - 1, -s});
  }
  const double sum = va + vb + vc;
  return with_weights(x, {1, -va / sum, -vb / sum, -vc / sum});
}

ClosestPoints edge_to_edge(const std::array<Vector3d, 4>& x) {
  const Vector3d d1 = x[1] - x[0], d2 = x[3] - x[2], r = x[0] - x[2];
  const double a = d1.squaredNorm(), e = d2.squaredNorm(), f = d2.dot(r);
  double s = 0, t = 0;
  if (a > 0 && e > 0) {
    const double b = d1.dot(d2), c = d1.dot(r), determinant = a * e - b * b;
    s = determinant > 1e-14 * a * e ? std::clamp((b * f - c * e) / determinant, 0.0, 1.0) : 0.5;
    t = (b * s + f) / e;
    if (t < 0) {
      t = 0;
      s = std::clamp(-c / a, 0.0, 1.0);
    }
    if (t > 1) {
      t = 1;
      s = std::clamp((b - c) / a, 0.0, 1.0);
    }
  } else if (a > 0) {
    s = std::clamp(-d1.dot(r) / a, 0.0, 1.0);
  } else if (e > 0) {
    t = std::clamp(f / e, 0.0, 1.0);
  }
  return with_weights(x, {1 - s, s, t - 1, -t});
}

TriangleCorners corners_of(const Points3& x, const Triangles& triangles, int t) {
  return {x.row(triangles(t, 0)).transpose(), x.row(triangles(t, 1)).transpose(),
          x.row(triangles(t, 2)).transpose()};
}

double feature_distance(const TriangleCorners& p, const TriangleCorners& q) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    least = std::min({least, vertex_to_triangle({p[i], q[0], q[1], q[2]}).distance(),
                      vertex_to_triangle({q[i], p[0], p[1], p[2]}).distance()});
    for (int j = 0; j < 3; ++j)
      least =
          std::min(least, edge_to_edge({p[i], p[(i + 1) % 3], q[j], q[(j + 1) % 3]}).distance());
  }
  return least;
}

bool pierces(const Vector3d& p, const Vector3d& q, const TriangleCorners& t) {
  const double above = volume6(t[0], t[1], t[2], p), below = volume6(t[0], t[1], t[2], q);
  if (above == 0 || below == 0 || same_sign(above, below)) return false;
  const double s0 = volume6(p, q, t[0], t[1]), s1 = volume6(p, q, t[1], t[2]),
               s2 = volume6(p, q, t[2], t[0]);
  return same_sign(s0, s1) && same_sign(s1, s2);
}

bool pierce_each_other(const Points3& x, const Triangles& triangles, int s, int t) {
  const auto has = [&](int a, int v) { return (triangles.row(a).array() == v).any(); };
  const auto passes_through = [&](int a, int b) {
    const TriangleCorners p = corners_of(x, triangles, a), q = corners_of(x, triangles, b);
    for (int i = 0; i < 3; ++i)
      if (const int j = (i + 1) % 3;
          !has(b, triangles(a, i)) && !has(b, triangles(a, j)) && pierces(p[i], p[j], q))
        return true;
    return false;
  };
  return passes_through(s, t) || passes_through(t, s);
}

bool tetrahedron_is_empty(const Sheet& sheet, const std::array<int, 4>& vertices,
                          const std::array<Vector3d, 4>& c, const std::vector<int>& changing,
                          double clearance) {
  constexpr int faces[4][3] = {{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}},
                edges[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
  const Vector3d low = c[0].cwiseMin(c[1]).cwiseMin(c[2].cwiseMin(c[3])).array() - clearance;
  const Vector3d high = c[0].cwiseMax(c[1]).cwiseMax(c[2].cwiseMax(c[3])).array() + clearance;
  const double whole = volume6(c[0], c[1], c[2], c[3]);
  const auto corner_of = [&](int v) {
    return static_cast<int>(std::find(vertices.begin(), vertices.end(), v) - vertices.begin());
  };
  const auto contains = [&](const Vector3d& p) {
    return same_sign(volume6(p, c[1], c[2], c[3]), whole) &&
           same_sign(volume6(c[0], p, c[2], c[3]), whole) &&
           same_sign(volume6(c[0], c[1], p, c[3]), whole) &&
           same_sign(volume6(c[0], c[1], c[2], p), whole);
  };
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    const TriangleCorners x = corners_of(sheet.x, sheet.triangles, t);
    const Vector3d t_low = x[0].cwiseMin(x[1]).cwiseMin(x[2]),
                   t_high = x[0].cwiseMax(x[1]).cwiseMax(x[2]);
    if ((t_low.array() > high.array()).any() || (t_high.array() < low.array()).any()) continue;
    if (std::find(changing.begin(), changing.end(), t) != changing.end()) continue;
    int own[3];  // corner of the tetrahedron that each corner of the triangle is; 4: none
    for (int i = 0; i < 3; ++i) own[i] = corner_of(sheet.triangles(t, i));
    const auto shares = [&](int corner) {
      return own[0] == corner || own[1] == corner || own[2] == corner;
    };
    for (int i = 0; i < 3; ++i)
      if (own[i] == 4 && contains(x[i])) return false;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      if (own[i] < 4 && own[j] < 4) continue;
      // an edge that begins at a corner of a face meets it only there
      for (const auto& f : faces) {
        if (own[i] == f[0] || own[i] == f[1] || own[i] == f[2] || own[j] == f[0] ||
            own[j] == f[1] || own[j] == f[2])
          continue;
        if (pierces(x[i], x[j], {c[f[0]], c[f[1]], c[f[2]]})) return false;
      }
    }
    for (const auto& e : edges)
      if (!shares(e[0]) && !shares(e[1]) && pierces(c[e[0]], c[e[1]], x)) return false;
    if (shares(2) || shares(3)) continue;
    for (int i = 0; i < 3; ++i)
      if (edge_to_edge({c[2], c[3], x[i], x[(i + 1) % 3]}).distance() < clearance) return false;
  }
  return true;
}

}  // namespace paperbake
