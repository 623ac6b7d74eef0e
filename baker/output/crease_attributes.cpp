#include "baker/output/crease_attributes.h"

#include "core/geometry/curvature.h"
#include "core/model/segment2.h"
#include "formats/maps/fold_width.h"

#include <cmath>
#include <limits>

namespace paperbake {
namespace {

Eigen::VectorXd rounded(const Eigen::VectorXd& values, double steps) {
  return (values * steps).array().round() / steps;
}

}  // namespace

CreaseAttributes::CreaseAttributes(const Shot& shot, double fold_width, double fps)
    : diagonal_(extent(shot.pattern).norm()), fold_width_(fold_width), fps_(fps) {}

void CreaseAttributes::add(const AnimatedFrame& frame) {
  const Sheet& sheet = *frame.sheet;
  const Hinges hinges = find_hinges(sheet.triangles);
  const Points3 curvature = vertex_curvature(sheet);
  const Eigen::VectorXd width = fold_widths(sheet, hinges, fold_width_);
  folds_.push_back(
      {fold_tensors(curvature, width),
       frame.plastic_curvature.rows() > 0 ? fold_tensors(frame.plastic_curvature, width)
                                          : Points3(),
       sharp_edges(sheet, hinges, curvature, frame.plastic_curvature), sheet.singular.size()});
  singular_ = sheet.singular;  // it only grows
}

CreaseAttributes::SharpEdges CreaseAttributes::sharp_edges(const Sheet& sheet, const Hinges& hinges,
                                                           const Points3& curvature,
                                                           const Points3& plastic) {
  SharpEdges edges;
  edges.now.assign(hinges.of_triangle.size(), {0, 0, 0});
  edges.plastic = edges.now;
  for (const SharpFold& fold : sharp_folds(sheet, hinges, curvature, plastic))
    for (const int t : hinges.hinges[fold.hinge].triangles)
      for (int i = 0; i < 3; ++i)
        if (hinges.of_triangle[t][i] == fold.hinge) {
          edges.now[t][i] = static_cast<float>(fold.angle);
          edges.plastic[t][i] = static_cast<float>(fold.plastic);
        }
  return edges;
}

/// Signed turn at the places of the rendered vertices. |places_| [rad]
Eigen::VectorXd CreaseAttributes::turns(const ShotRecord::Mesh& mesh, const Points3& smooth,
                                        const std::vector<std::array<float, 3>>& sharp) const {
  Eigen::VectorXd turns(places_.size());
  for (std::size_t v = 0; v < places_.size(); ++v) {
    const MeshPoint& place = places_[v];
    const Vector3d t = interpolate(place, mesh.triangles, smooth);
    turns[v] = larger_principal(t[0], t[1], t[2]);
    for (int i = 0; i < 3; ++i) {
      const Vector2d a = mesh.pattern.row(mesh.triangles(place.triangle, (i + 1) % 3)),
                     b = mesh.pattern.row(mesh.triangles(place.triangle, (i + 2) % 3)),
                     c = mesh.pattern.row(mesh.triangles(place.triangle, i));
      const double height = std::abs(cross(b - a, c - a)) / (b - a).norm();
      if (place.weights[i] * height <= 0.5 * fold_width_)
        turns[v] = larger_turn<double>(turns[v], sharp[place.triangle][i]);
    }
  }
  return turns;
}

CreaseAttributes::CreaseAngles CreaseAttributes::angles(std::size_t k, const ShotRecord& record,
                                                        const Points2& pattern) {
  const RecordedFrame& frame = record.frames()[k];
  const ShotRecord::Mesh& mesh = record.meshes()[frame.mesh];
  if (frame.mesh != mesh_) {
    const PointLocator locator(mesh.pattern, mesh.triangles);
    places_.clear();
    for (Eigen::Index v = 0; v < pattern.rows(); ++v)
      places_.push_back(locator.locate(pattern.row(v)));
    mesh_ = frame.mesh;
  }
  CreaseAngles found;
  found.now = turns(mesh, folds_[k].now, folds_[k].sharp.now);
  if (folds_[k].plastic.rows() > 0)
    found.plastic = turns(mesh, folds_[k].plastic, folds_[k].sharp.plastic);
  return found;
}

std::vector<CacheLayer> CreaseAttributes::at(std::size_t k, const ShotRecord& record,
                                             const Points2& pattern) {
  if (next_ == 0) peak_ = Eigen::VectorXd::Zero(pattern.rows());
  CreaseAngles shown;
  for (; next_ <= k; ++next_) {
    shown = angles(next_, record, pattern);
    peak_ = (shown.now.array().abs() > peak_.array().abs()).select(shown.now, peak_);
  }
  Eigen::VectorXd distance = Eigen::VectorXd::Constant(pattern.rows(), diagonal_),
                  age = Eigen::VectorXd::Constant(pattern.rows(), -1);
  for (Eigen::Index v = 0; v < pattern.rows(); ++v) {
    double nearest = std::numeric_limits<double>::max();
    for (std::size_t s = 0; s < folds_[k].singular; ++s) {
      const double d = (singular_[s].pattern - pattern.row(v).transpose()).squaredNorm();
      if (d >= nearest) continue;
      nearest = d;
      distance[v] = std::sqrt(d);
      age[v] = (record.frames()[k].frame - singular_[s].frame_of_birth) / fps_;
    }
  }
  std::vector<CacheLayer> layers{{"foldAngle", rounded(shown.now, 1e4)},
                                 {"foldPeak", rounded(peak_, 1e4)},
                                 {"apexDistance", rounded(distance, 1e5)},
                                 {"apexAge", rounded(age, 1e4)}};
  if (shown.plastic.size() > 0)
    layers.insert(layers.begin() + 1, {"foldPlastic", rounded(shown.plastic, 1e4)});
  return layers;
}

}  // namespace paperbake
