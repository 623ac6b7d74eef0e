#include "core/animation/imperfection.h"

#include "core/geometry/principal_axes.h"
#include "core/geometry/random.h"

#include <cmath>

namespace paperbake {
namespace {

struct Plane {
  Vector3d normal;
  double off;  // [m] largest distance of a point
};

Plane plane_of(const Points3& x) {
  const Eigen::RowVector3d centre = x.colwise().mean();
  const Vector3d normal = principal_axes(x).vectors.col(0);
  return {normal, ((x.rowwise() - centre) * normal).cwiseAbs().maxCoeff()};
}

}  // namespace

double imperfection(const Vector2d& p, double side, unsigned seed) {
  constexpr int waves = 6;
  double sum = 0;
  for (int k = 0; k < waves; ++k) {
    const Vector2d direction(uniform(seed, 3 * k), uniform(seed, 3 * k + 1));
    sum += std::sin(2 * M_PI * (1.5 * direction.dot(p) / side + uniform(seed, 3 * k + 2))) / waves;
  }
  return sum;
}

double off_plane(const Points3& x) { return plane_of(x).off; }

void add_geometric_imperfection(Sheet& sheet, double side, unsigned seed) {
  constexpr double height = 1e-6;  // [m]
  const Plane plane = plane_of(sheet.x);
  if (plane.off > 1e-7 * side) return;
  // the sign of an eigenvector is arbitrary
  const Vector3d up = plane.normal.z() < 0 ? Vector3d(-plane.normal) : plane.normal;
  for (int v = 0; v < sheet.x.rows(); ++v)
    sheet.x.row(v) += height * imperfection(sheet.pattern.row(v), side, seed) * up.transpose();
}

}  // namespace paperbake
