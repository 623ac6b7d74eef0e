#include "core/geometry/pattern_samples.h"

#include "core/geometry/measure.h"
#include "core/geometry/point_location.h"

#include <cmath>

namespace paperbake {

PatternSamples::PatternSamples(const Pattern& pattern, int along) {
  const Vector2d size = extent(pattern);
  const double on_border = 1e-6 * longer_side(pattern);
  for (int i = 0; i < along; ++i)
    for (int j = 0; j < along; ++j) {
      const Vector2d p(size.x() * i / (along - 1), size.y() * j / (along - 1));
      if (contains(pattern, p, on_border)) points_.push_back(p);
    }
}

PatternSamples::Sampled PatternSamples::operator()(const Sheet& sheet) const {
  const PointLocator locator(sheet.pattern, sheet.triangles);
  const Points3 normals = vertex_normals(sheet.x, sheet.triangles);
  Sampled sampled{Points3(points_.size(), 3), Points3(points_.size(), 3)};
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const MeshPoint place = locator.locate(points_[k]);
    sampled.x.row(k) = interpolate(place, sheet.triangles, sheet.x);
    sampled.normals.row(k) = interpolate(place, sheet.triangles, normals).normalized();
  }
  return sampled;
}

double rms_distance(const Points3& a, const Points3& b) {
  return std::sqrt((a - b).rowwise().squaredNorm().mean());
}

}  // namespace paperbake
