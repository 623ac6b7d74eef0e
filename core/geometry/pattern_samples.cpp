#include "core/geometry/pattern_samples.h"

#include "core/geometry/measure.h"
#include "core/geometry/point_location.h"

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

Points3 PatternSamples::operator()(const Sheet& sheet) const {
  return interpolated(sheet, sheet.x);
}

Points3 PatternSamples::normals(const Sheet& sheet) const {
  Points3 normals = interpolated(sheet, vertex_normals(sheet.x, sheet.triangles));
  for (int k = 0; k < normals.rows(); ++k) normals.row(k).normalize();
  return normals;
}

Points3 PatternSamples::interpolated(const Sheet& sheet, const Points3& per_vertex) const {
  const PointLocator locator(sheet.pattern, sheet.triangles);
  Points3 values(points_.size(), 3);
  for (std::size_t k = 0; k < points_.size(); ++k)
    values.row(k) = interpolate(locator.locate(points_[k]), sheet.triangles, per_vertex);
  return values;
}

}  // namespace paperbake
