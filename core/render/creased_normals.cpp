#include "core/render/creased_normals.h"

#include "core/render/curved_surface.h"

#include <algorithm>

namespace paperbake {
namespace {

/// Which corner of the triangle is vertex v.
int corner_of(const Triangles& triangles, int t, int v) {
  for (int i = 0; i < 2; ++i)
    if (triangles(t, i) == v) return i;
  return 2;
}

/// The triangle across the edge opposite corner i; -1 at the border.
int beyond(const Hinges& hinges, int t, int i) {
  const int h = hinges.of_triangle[t][i];
  if (h < 0) return -1;
  const auto& both = hinges.hinges[h].triangles;
  return both[0] == t ? both[1] : both[0];
}

}  // namespace

CreasedNormals::CreasedNormals(const Triangles& triangles,
                               const std::vector<std::pair<int, int>>& creases,
                               const std::vector<char>& sharp)
    : vertices_(triangles.size() ? triangles.maxCoeff() + 1 : 0),
      normals_(vertices_),
      triangles_(triangles),
      of_corner_(triangles) {
  const Hinges hinges = find_hinges(triangles);
  std::vector<int> crease_of_hinge(hinges.hinges.size(), -1);
  for (std::size_t h = 0; h < hinges.hinges.size(); ++h) {
    const auto& v = hinges.hinges[h].vertices;
    const std::pair<int, int> edge = std::minmax(v[0], v[1]);
    const auto found = std::lower_bound(creases.begin(), creases.end(), edge);
    if (found == creases.end() || *found != edge) continue;
    number_.push_back(found - creases.begin());
    sharp_.push_back(!sharp.empty() && sharp[number_.back()]);
    crease_of_hinge[h] = static_cast<int>(creases_.size());
    creases_.push_back(hinges.hinges[h]);
  }
  const auto crease_at = [&](int t, int i) {
    return hinges.of_triangle[t][i] < 0 ? -1 : crease_of_hinge[hinges.of_triangle[t][i]];
  };

  // a triangle of each vertex to begin the round with: next to the border, otherwise next to a
  // crease
  std::vector<int> first(vertices_, -1), lines(vertices_, 0);
  std::vector<char> at_border(vertices_, 0);
  for (int t = 0; t < triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i) {
      // the edge from v that has the triangle on its left side
      const int v = triangles(t, i), right = (i + 2) % 3;
      const bool border = hinges.of_triangle[t][right] < 0, crease = crease_at(t, right) >= 0;
      lines[v] += border || crease;
      if (border || (crease && !at_border[v])) first[v] = t;
      at_border[v] |= border;
    }
  for (int v = 0; v < vertices_; ++v) {
    if (lines[v] < 2) continue;  // smooth all round, or the end of a crease
    Crossroads roads;
    roads.normal.push_back(v);
    int t = first[v];
    do {
      const int i = corner_of(triangles, t, v), left = (i + 1) % 3;
      of_corner_(t, i) = roads.normal.back();
      const int crease = crease_at(t, left);
      t = beyond(hinges, t, left);
      if (t < 0 || crease >= 0) roads.after.push_back(crease);
      if (crease >= 0 && t >= 0 && t != first[v]) roads.normal.push_back(normals_++);
    } while (t >= 0 && t != first[v]);
    if (roads.normal.size() > 1) crossroads_.push_back(std::move(roads));
  }
}

Points3 CreasedNormals::normals(const Points3& x, const std::vector<double>& least) const {
  Points3 sum = Points3::Zero(normals_, 3);
  for (int t = 0; t < triangles_.rows(); ++t) {
    const Vector3d a = x.row(triangles_(t, 0)), b = x.row(triangles_(t, 1)),
                   c = x.row(triangles_(t, 2));
    const Vector3d ab = b - a, bc = c - b, ca = a - c, n = ab.cross(-ca);
    const double lab = 1 / std::max(ab.squaredNorm(), 1e-30),
                 lbc = 1 / std::max(bc.squaredNorm(), 1e-30),
                 lca = 1 / std::max(ca.squaredNorm(), 1e-30);
    sum.row(of_corner_(t, 0)) += lab * lca * n;
    sum.row(of_corner_(t, 1)) += lab * lbc * n;
    sum.row(of_corner_(t, 2)) += lbc * lca * n;
  }
  std::vector<double> open(creases_.size());
  for (std::size_t c = 0; c < creases_.size(); ++c) {
    open[c] = sharp_[c] ? 0 : 1 - crease_share(dihedral_angle(x, creases_[c]));
    if (!least.empty()) open[c] = std::min(open[c], 1 - least[number_[c]]);
  }
  std::vector<Eigen::RowVector3d> mixed;
  for (const Crossroads& roads : crossroads_) {
    const int n = static_cast<int>(roads.normal.size());
    mixed.assign(n, Eigen::RowVector3d::Zero());
    // [1] how smoothly sector k passes into the next one
    const auto passage = [&](int k) { return roads.after[k] < 0 ? 0.0 : open[roads.after[k]]; };
    for (int i = 0; i < n; ++i) {
      mixed[i] = sum.row(roads.normal[i]);
      for (int j = 0; j < n; ++j) {
        if (j == i) continue;
        double forward = 1, backward = 1;
        for (int k = i; k != j; k = (k + 1) % n) forward *= passage(k);
        for (int k = j; k != i; k = (k + 1) % n) backward *= passage(k);
        mixed[i] += std::max(forward, backward) * sum.row(roads.normal[j]);
      }
    }
    for (int i = 0; i < n; ++i) sum.row(roads.normal[i]) = mixed[i];
  }
  for (int k = 0; k < normals_; ++k) {
    const double length = sum.row(k).norm();
    if (length > 1e-12)
      sum.row(k) /= length;
    else
      sum.row(k) =
          Eigen::RowVector3d::UnitZ();  // folded flat upon itself: any direction is as good
  }
  return sum;
}

Eigen::VectorXd CreasedNormals::strength(const Points3& x) const {
  Eigen::VectorXd most = Eigen::VectorXd::Zero(vertices_);
  for (const Hinge& crease : creases_) {
    const double fold = std::abs(dihedral_angle(x, crease));
    for (int k = 0; k < 2; ++k) most[crease.vertices[k]] = std::max(most[crease.vertices[k]], fold);
  }
  return most;
}

}  // namespace paperbake
