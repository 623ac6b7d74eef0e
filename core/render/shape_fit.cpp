#include "core/render/shape_fit.h"

#include "core/geometry/measure.h"
#include "core/geometry/prescribed_creases.h"
#include "core/model/segment2.h"
#include "core/render/curved_surface.h"

#include <cmath>
#include <map>

namespace paperbake {
namespace {

/// Cotangent of the angle at p between a and b.
double cotangent(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const Vector2d u = a - p, v = b - p;
  return u.dot(v) / std::abs(cross(u, v));
}

// a row of three numbers and one that is idle: one register
using Row = Eigen::Array4d;
using Rows = std::vector<Row, Eigen::aligned_allocator<Row>>;

Rows padded(const Points3& x) {
  Rows rows(x.rows());
  for (Eigen::Index v = 0; v < x.rows(); ++v) rows[v] << x(v, 0), x(v, 1), x(v, 2), 0;
  return rows;
}

/// Replaces the columns f, g of a matrix F by those of F (F^T F)^(-1/2), by the closed form of the
/// root of a 2x2 matrix C: C^(1/2) = (C + d)/t with d^2 = det C, t^2 = tr C + 2 d.
void rotate_only(Row& f, Row& g) {
  const double a = (f * f).sum(), b = (f * g).sum(), c = (g * g).sum();
  const double d = std::sqrt(std::max(a * c - b * b, 1e-12)), t = std::sqrt(a + c + 2 * d);
  // the inverse of the root is t (C + d)^(-1), and det (C + d) = d t^2
  const double scale = 1 / (d * t);
  const Row before = f;
  f = scale * ((c + d) * f - b * g);
  g = scale * ((a + d) * g - b * before);
}

}  // namespace

ShapeFit::ShapeFit(const Points2& pattern, const Triangles& triangles,
                   const ShapeFitOptions& options, const std::vector<PrescribedCrease>& folds,
                   const std::vector<std::pair<int, int>>& creases)
    : options_(options), hinges_(find_hinges(triangles)), area_(pattern.rows(), 0.0) {
  const auto at = [&](int v) -> Vector2d { return pattern.row(v); };
  const double ell2 = options.length * options.length;
  std::vector<double> areas(triangles.rows());
  std::vector<Eigen::Triplet<double>> entries, stretch;
  entries.reserve(16 * hinges_.hinges.size() + pattern.rows());
  stretch.reserve(9 * triangles.rows());
  for (int t = 0; t < triangles.rows(); ++t) {
    Face face;
    for (int i = 0; i < 3; ++i) face.v[i] = triangles(t, i);
    areas[t] = signed_area(at(face.v[0]), at(face.v[1]), at(face.v[2]));
    Vector2d slope[3];
    for (int i = 0; i < 3; ++i) {
      const Vector2d e = at(face.v[(i + 2) % 3]) - at(face.v[(i + 1) % 3]);
      slope[i] = Vector2d(-e.y(), e.x()) / (2 * areas[t]);
      area_[face.v[i]] += areas[t] / 3;
    }
    face.slope[0] = slope[1];
    face.slope[1] = slope[2];
    face.weight = options.stretch * ell2 * areas[t];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        stretch.emplace_back(face.v[i], face.v[j], face.weight * slope[i].dot(slope[j]));
    faces_.push_back(face);
  }
  for (const Hinge& hinge : hinges_.hinges) {
    const Vector2d p[4] = {at(hinge.vertices[0]), at(hinge.vertices[1]), at(hinge.vertices[2]),
                           at(hinge.vertices[3])};
    const double left0 = cotangent(p[0], p[1], p[2]), left1 = cotangent(p[1], p[0], p[2]);
    const double right0 = cotangent(p[0], p[1], p[3]), right1 = cotangent(p[1], p[0], p[3]);
    Bend bend{{left1 + right1, left0 + right0, -left0 - left1, -right0 - right1},
              {0, 0, 0},
              ell2 * ell2 / (areas[hinge.triangles[0]] + areas[hinge.triangles[1]]),
              is_on_crease(folds, pattern, hinge.vertices[0], hinge.vertices[1])};
    for (int i = 1; i < 4; ++i) {  // relative to p[0]
      const Vector2d q = p[i] - p[0];
      bend.of_curvature -=
          0.5 * bend.k[i] * Vector3d(q.x() * q.x(), 2 * q.x() * q.y(), q.y() * q.y());
    }
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        entries.emplace_back(hinge.vertices[i], hinge.vertices[j],
                             bend.weight * bend.k[i] * bend.k[j]);
    bends_.push_back(bend);
  }
  number(creases);
  for (int v = 0; v < pattern.rows(); ++v) entries.emplace_back(v, v, area_[v]);
  smooth_.resize(pattern.rows(), pattern.rows());
  smooth_.setFromTriplets(entries.begin(), entries.end());
  stiff_.resize(pattern.rows(), pattern.rows());
  stiff_.setFromTriplets(stretch.begin(), stretch.end());
  stiff_ += smooth_;
}

void ShapeFit::number(const std::vector<std::pair<int, int>>& creases) {
  std::map<std::pair<int, int>, int> crease_at;
  for (std::size_t c = 0; c < creases.size(); ++c)
    crease_at.emplace(std::minmax(creases[c].first, creases[c].second), static_cast<int>(c));
  for (std::size_t h = 0; h < bends_.size(); ++h) {
    const auto& v = hinges_.hinges[h].vertices;
    if (const auto crease = crease_at.find(std::minmax(v[0], v[1])); crease != crease_at.end())
      bends_[h].crease = crease->second;
  }
}

void ShapeFit::hold(const std::vector<int>& vertices) {
  if (held_ == vertices) return;
  held_ = vertices;
  std::vector<int> place(area_.size(), 0);
  for (const int v : vertices) place[v] = -1;
  free_.clear();
  for (std::size_t v = 0; v < place.size(); ++v)
    if (place[v] == 0) {
      place[v] = static_cast<int>(free_.size());
      free_.push_back(static_cast<int>(v));
    }
  if (free_.empty()) return;
  const auto lower_of_free = [&](const Eigen::SparseMatrix<double>& all) {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(all.nonZeros());
    for (const int v : free_)
      for (Eigen::SparseMatrix<double>::InnerIterator it(all, v); it; ++it)
        if (place[it.row()] >= place[v])
          entries.emplace_back(place[it.row()], place[v], it.value());
    Eigen::SparseMatrix<double> lower(free_.size(), free_.size());
    lower.setFromTriplets(entries.begin(), entries.end());
    return lower;
  };
  // all entries of the smooth matrix are among those of the stiff one
  stiff_factor_.emplace(lower_of_free(stiff_));
  smooth_factor_.emplace(stiff_factor_->of_matrix_alike(lower_of_free(smooth_)));
}

Points3 ShapeFit::stretch_pull(const Points3& x) const {
  const Rows at = padded(x);
  Rows pull(at.size(), Row::Zero());
  for (const Face& face : faces_) {
    const Row u = at[face.v[1]] - at[face.v[0]], v = at[face.v[2]] - at[face.v[0]];
    const auto& s = face.slope;
    const Row f = u * s[0].x() + v * s[1].x(), g = u * s[0].y() + v * s[1].y();
    Row to_f = f, to_g = g;
    rotate_only(to_f, to_g);
    to_f = face.weight * (to_f - f);
    to_g = face.weight * (to_g - g);
    const Row first = to_f * s[0].x() + to_g * s[0].y(), second = to_f * s[1].x() + to_g * s[1].y();
    pull[face.v[0]] -= first + second;
    pull[face.v[1]] += first;
    pull[face.v[2]] += second;
  }
  Points3 r(x.rows(), 3);
  for (Eigen::Index v = 0; v < x.rows(); ++v) r.row(v) = pull[v].head<3>().matrix().transpose();
  return r;
}

Points3 ShapeFit::bend_pull(const Points3& y, const Points3& bend) const {
  Points3 r = Points3::Zero(y.rows(), 3);
  for (std::size_t h = 0; h < bends_.size(); ++h) {
    const auto& v = hinges_.hinges[h].vertices;
    const auto& k = bends_[h].k;
    const Eigen::RowVector3d pull =
        bends_[h].weight * (bend.row(h) - (k[0] * y.row(v[0]) + k[1] * y.row(v[1]) +
                                           k[2] * y.row(v[2]) + k[3] * y.row(v[3])));
    for (int i = 0; i < 4; ++i) r.row(v[i]) += k[i] * pull;
  }
  return r;
}

Points3 ShapeFit::bend(const Points3& y, const Points3& curvature,
                       const std::vector<double>& least) const {
  // [1] cosine of an angle that is safely no crease: most hinges need no look at theirs
  static const double smooth = std::cos(crease_begins) + 4e-5;
  Points3 normal(faces_.size(), 3);
  for (std::size_t t = 0; t < faces_.size(); ++t) {
    const Vector3d a = y.row(faces_[t].v[0]), b = y.row(faces_[t].v[1]), c = y.row(faces_[t].v[2]);
    normal.row(t) = triangle_normal(a, b, c);
  }
  Points3 result(bends_.size(), 3);
  for (std::size_t h = 0; h < bends_.size(); ++h) {
    const auto& v = hinges_.hinges[h].vertices;
    const auto& k = bends_[h].k;
    const auto& t = hinges_.hinges[h].triangles;
    const bool is_smooth = normal.row(t[0]).dot(normal.row(t[1])) > smooth;
    double c = bends_[h].sharp ? 1
               : is_smooth || !options_.may_crease
                   ? 0
                   : crease_share(dihedral_angle(y, hinges_.hinges[h]));
    if (!least.empty() && bends_[h].crease >= 0) c = std::max(c, least[bends_[h].crease]);
    const Eigen::RowVector3d n = (normal.row(t[0]) + normal.row(t[1])).normalized();
    const double curved =
        0.5 * (curvature.row(v[0]) + curvature.row(v[1])).dot(bends_[h].of_curvature);
    result.row(h) = (1 - c) * curved * n;
    if (c > 0)
      result.row(h) +=
          c * (k[0] * y.row(v[0]) + k[1] * y.row(v[1]) + k[2] * y.row(v[2]) + k[3] * y.row(v[3]));
  }
  return result;
}

void ShapeFit::move(Points3& x, const Points3& pull, const ColumnCholesky& factor) const {
  Points3 right(free_.size(), 3);
  for (std::size_t k = 0; k < free_.size(); ++k) right.row(k) = pull.row(free_[k]);
  const Points3 correction = factor.solve(right);
  for (std::size_t k = 0; k < free_.size(); ++k) x.row(free_[k]) += correction.row(k);
}

Points3 ShapeFit::operator()(const Points3& y, const Points3& curvature,
                             const std::vector<double>& least) const {
  Points3 x = y;
  if (free_.empty()) return x;
  move(x, bend_pull(y, bend(y, curvature, least)), *smooth_factor_);
  for (int step = 0; step < options_.steps; ++step)
    move(x, (step + 1 < options_.steps ? 1 : options_.beyond) * stretch_pull(x), *stiff_factor_);
  return x;
}

}  // namespace paperbake
