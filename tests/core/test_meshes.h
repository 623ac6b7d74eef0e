#pragma once

#include "core/step1_elastic/elastic.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <utility>
#include <vector>

namespace paperbake::test {

/// A flat sheet in the plane z = 0, from pattern and triangles.
inline Sheet flat_sheet(Points2 pattern, Triangles triangles) {
  Sheet sheet;
  sheet.x = Points3::Zero(pattern.rows(), 3);
  sheet.x.leftCols<2>() = pattern;
  sheet.v = Points3::Zero(pattern.rows(), 3);
  sheet.pattern = std::move(pattern);
  sheet.triangles = std::move(triangles);
  return sheet;
}

/// A sheet of n ruling strips along x: two vertices at each of n+1 positions, and every cell cut by
/// a diagonal in the same direction (alternating diagonals make every other ruling softer: the arch
/// of 8 strips is then 1.4 % instead of 0.6 % too high).
inline Sheet strip_sheet(double length, double width, int n) {
  Points2 p(2 * (n + 1), 2);
  Triangles t(2 * n, 3);
  for (int i = 0; i <= n; ++i) {
    p.row(2 * i) << length * i / n, 0;
    p.row(2 * i + 1) << length * i / n, width;
  }
  for (int i = 0; i < n; ++i) {
    const int a = 2 * i, b = 2 * i + 2, c = 2 * i + 3, d = 2 * i + 1;
    t.row(2 * i) << a, b, c;
    t.row(2 * i + 1) << a, c, d;
  }
  return flat_sheet(std::move(p), std::move(t));
}

/// Rows of nearly equilateral triangles; inner vertices are moved by up to `jitter` edges.
inline Sheet hex_sheet(double length, double width, int columns, double jitter = 0,
                       unsigned seed = 1) {
  const double dx = length / columns;
  const int rows = std::max(1, static_cast<int>(std::lround(width / (dx * std::sqrt(0.75)))));
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-jitter * dx, jitter * dx);
  std::vector<std::vector<int>> row(rows + 1);
  std::vector<Vector2d> points;
  for (int r = 0; r <= rows; ++r) {
    std::vector<double> xs;
    if (r % 2 == 0)
      for (int c = 0; c <= columns; ++c) xs.push_back(c * dx);
    else {
      xs.push_back(0);
      for (int c = 0; c < columns; ++c) xs.push_back((c + 0.5) * dx);
      xs.push_back(length);
    }
    for (std::size_t c = 0; c < xs.size(); ++c) {
      Vector2d p(xs[c], width * r / rows);
      if (r > 0 && r < rows && c > 0 && c + 1 < xs.size()) {
        // drawn in this order by every compiler
        const double up = uniform(random), along = uniform(random);
        p += Vector2d(along, up);
      }
      row[r].push_back(static_cast<int>(points.size()));
      points.push_back(p);
    }
  }
  std::vector<Eigen::RowVector3i> faces;
  for (int r = 0; r < rows; ++r) {  // joins two rows, ordered by x
    std::size_t i = 0, j = 0;
    while (i + 1 < row[r].size() || j + 1 < row[r + 1].size()) {
      const bool lower =
          j + 1 >= row[r + 1].size() ||
          (i + 1 < row[r].size() && points[row[r][i + 1]].x() + points[row[r][i]].x() <=
                                        points[row[r + 1][j + 1]].x() + points[row[r + 1][j]].x());
      if (lower) {
        faces.emplace_back(row[r][i], row[r][i + 1], row[r + 1][j]);
        ++i;
      } else {
        faces.emplace_back(row[r][i], row[r + 1][j + 1], row[r + 1][j]);
        ++j;
      }
    }
  }
  Points2 p(points.size(), 2);
  for (std::size_t k = 0; k < points.size(); ++k) p.row(k) = points[k];
  Triangles t(faces.size(), 3);
  for (std::size_t k = 0; k < faces.size(); ++k) t.row(k) = faces[k];
  return flat_sheet(std::move(p), std::move(t));
}

/// Wraps a sheet around a cylinder of radius R [m] whose rulings run along y of the pattern; it
/// bulges upwards, towards its normal.
inline void roll(Sheet& sheet, double R) {
  for (int v = 0; v < sheet.pattern.rows(); ++v) {
    const double s = sheet.pattern(v, 0) / R;
    sheet.x.row(v) << R * std::sin(s), sheet.pattern(v, 1), R * (std::cos(s) - 1);
  }
}

/// Measured order of convergence of error(h) between h0 and h1.
inline double order(const std::function<double(double)>& error, double h0, double h1) {
  return std::log(error(h0) / error(h1)) / std::log(h0 / h1);
}

/// Hard constraints that hold these vertices where x has them.
inline PositionConstraints held_at(const std::vector<int>& vertices, const Points3& x) {
  PositionConstraints held;
  for (const int v : vertices) held.push_back({v, x.row(v)});
  return held;
}

}  // namespace paperbake::test
