#include "baker/output/sheet_guides.h"

#include "core/geometry/measure.h"
#include "core/model/segment2.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace paperbake {
namespace {

/// Is `inner` within `near` of the other crease, along its whole length, in the same direction?
bool lies_along(const DetectedCrease& inner, const DetectedCrease& outer, double near) {
  constexpr double aligned = 0.35;  // sin 20 degrees
  const Vector2d u = (inner.to - inner.from).normalized(), w = (outer.to - outer.from).normalized();
  return std::abs(cross(u, w)) < aligned &&
         distance_to_segment(inner.from, outer.from, outer.to) <= near &&
         distance_to_segment(inner.to, outer.from, outer.to) <= near;
}

Points3 face_normals(const CacheFrame& mesh) {
  Points3 normals(mesh.triangles.rows(), 3);
  for (Eigen::Index t = 0; t < normals.rows(); ++t) {
    const Vector3d a = mesh.x.row(mesh.triangles(t, 0)), b = mesh.x.row(mesh.triangles(t, 1)),
                   c = mesh.x.row(mesh.triangles(t, 2));
    normals.row(t) = triangle_normal(a, b, c).transpose();
  }
  return normals;
}

}  // namespace

SheetGuides::SheetGuides(const Shot& shot)
    : shot_(shot),
      width_(ridge_width(shot.paper, shorter_side(shot.pattern))),
      thresholds_(crease_thresholds(shot.paper)) {}

void SheetGuides::add(const AnimatedFrame& frame) {
  merge_creases(history_,
                detect_creases(*frame.sheet, frame.plastic_curvature, shot_.pattern, thresholds_),
                frame.frame, width_);
  singular_ = frame.sheet->singular;  // it only grows
  laid_ = false;
}

/// All creases of the history, in its order; those that run along a sharper one have strength 0.
std::vector<DetectedCrease> SheetGuides::sharpest() const {
  std::vector<std::size_t> order(history_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return history_[a].strength > history_[b].strength;
  });
  std::vector<DetectedCrease> all = history_;
  std::vector<std::size_t> kept;
  for (const std::size_t k : order) {
    if (std::any_of(kept.begin(), kept.end(), [&](std::size_t sharper) {
          return lies_along(history_[k], history_[sharper], width_);
        }))
      all[k].strength = 0;
    else
      kept.push_back(k);
  }
  return all;
}

void SheetGuides::lay_on(const CacheFrame& mesh) {
  if (laid_ && same_entries(mesh.triangles, triangles_) && same_entries(mesh.uv, uv_)) return;
  const Points2 pattern = longer_side(shot_.pattern) * mesh.uv;
  const PointLocator locator(pattern, mesh.triangles);
  const double spacing = mean_edge(pattern, mesh.triangles);
  lines_.clear();
  points_.clear();
  const std::vector<DetectedCrease> creases = sharpest();
  for (std::size_t k = 0; k < creases.size(); ++k) {
    if (creases[k].strength == 0) continue;
    const Vector2d along = creases[k].to - creases[k].from;
    Line line;
    line.id = static_cast<int>(k) + 1;
    line.birth = creases[k].frame_of_birth;
    const Vector2d to_side = 0.5 * width_ * Vector2d(-along.y(), along.x()).normalized();
    const int parts = std::max(1, static_cast<int>(std::ceil(along.norm() / spacing)));
    for (int i = 0; i <= parts; ++i) {
      const Vector2d p = creases[k].from + along * (double(i) / parts);
      line.places.push_back(locator.locate(p));
      line.beside[0].push_back(locator.locate(p - to_side));
      line.beside[1].push_back(locator.locate(p + to_side));
    }
    lines_.push_back(std::move(line));
  }
  for (const SingularPoint& point : singular_) points_.push_back(locator.locate(point.pattern));
  triangles_ = mesh.triangles;
  uv_ = mesh.uv;
  laid_ = true;
}

/// [rad] Turn from one side of the line to the other, > 0 where it bulges towards the normals.
double SheetGuides::fold_angle(const Line& line, std::size_t point, const CacheFrame& mesh,
                               const Points3& normals) const {
  const MeshPoint &a = line.beside[0][point], &b = line.beside[1][point];
  const Vector3d m = normals.row(a.triangle), n = normals.row(b.triangle),
                 way = interpolate(b, mesh.triangles, mesh.x) -
                       interpolate(a, mesh.triangles, mesh.x);
  const double turn = angle_between(m, n);
  return (n - m).dot(way) < 0 ? -turn : turn;
}

CacheGuides SheetGuides::at(int frame, const CacheFrame& mesh) {
  lay_on(mesh);
  CacheGuides guides;
  std::vector<Vector3d> points, folds;
  for (std::size_t s = 0; s < singular_.size() && singular_[s].frame_of_birth <= frame; ++s) {
    points.push_back(interpolate(points_[s], mesh.triangles, mesh.x));
    guides.point_id.push_back(static_cast<int>(s) + 1);
    guides.point_birth.push_back(singular_[s].frame_of_birth);
  }
  const Points3 normals = face_normals(mesh);
  std::vector<double> angles;
  for (const Line& line : lines_) {
    if (line.birth > frame) continue;
    guides.fold_id.push_back(line.id);
    guides.fold_birth.push_back(line.birth);
    guides.fold_size.push_back(static_cast<int>(line.places.size()));
    for (std::size_t i = 0; i < line.places.size(); ++i) {
      folds.push_back(interpolate(line.places[i], mesh.triangles, mesh.x));
      angles.push_back(fold_angle(line, i, mesh, normals));
    }
  }
  const auto rows = [](const std::vector<Vector3d>& all) {
    Points3 matrix(static_cast<Eigen::Index>(all.size()), 3);
    for (std::size_t i = 0; i < all.size(); ++i)
      matrix.row(static_cast<Eigen::Index>(i)) = all[i].transpose();
    return matrix;
  };
  guides.points = rows(points);
  guides.folds = rows(folds);
  guides.angle =
      Eigen::Map<const Eigen::VectorXd>(angles.data(), static_cast<Eigen::Index>(angles.size()));
  return guides;
}

}  // namespace paperbake
