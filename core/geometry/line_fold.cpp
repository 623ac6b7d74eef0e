#include "core/geometry/line_fold.h"

#include "core/geometry/measure.h"
#include "core/geometry/point_location.h"

namespace paperbake {

double fold_of_line(const Sheet& sheet, const std::vector<Vector2d>& line, double beside) {
  const PointLocator locator(sheet.pattern, sheet.triangles);
  const auto normal_at = [&](const Vector2d& p) {
    const Eigen::RowVector3i t = sheet.triangles.row(locator.locate(p).triangle);
    const Vector3d a = sheet.x.row(t[0]), b = sheet.x.row(t[1]), c = sheet.x.row(t[2]);
    return triangle_normal(a, b, c);
  };
  const auto on_sheet = [&](const Vector2d& p) {
    return interpolate(locator.locate(p), sheet.triangles, sheet.x);
  };
  double sum = 0, length = 0;
  for (std::size_t k = 0; k + 1 < line.size(); ++k) {
    const Vector2d along = line[k + 1] - line[k], middle = 0.5 * (line[k] + line[k + 1]),
                   off = beside * Vector2d(-along.y(), along.x()).normalized();
    const Vector3d left = normal_at(middle + off), right = normal_at(middle - off);
    const Vector3d axis = (on_sheet(line[k + 1]) - on_sheet(line[k])).normalized();
    sum += along.norm() * angle_about(axis, left, right);
    length += along.norm();
  }
  return length > 0 ? sum / length : 0;
}

}  // namespace paperbake
