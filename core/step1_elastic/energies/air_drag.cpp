#include "core/step1_elastic/energies/air_drag.h"

#include "core/geometry/measure.h"
#include "core/model/segment2.h"

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

constexpr double still = 1e-9;          // [m/s]
constexpr double viscosity = 1.81e-5;   // [Pa s] of air at 20 C
constexpr double least_reynolds = 100;  // [1] for smaller ones the boundary layer is not thin

/// Integral of sqrt((1 - c)/c) from 0 to c.
double pressure_up_to(double c) { return std::sqrt(c * (1 - c)) + std::asin(std::sqrt(c)); }

/// A triangle in the air at the beginning of a step.
struct Plate {
  std::array<int, 3> vertices;
  double area;                          // [m2] on the pattern
  Vector3d centre, normal, wind, slip;  // slip: velocity against the air
  double leading = 1;                   // [1] pressure of a plate at a small angle, of the mean
  double sine() const {
    const double speed = slip.norm();
    return speed > still ? std::min(1.0, std::abs(slip.dot(normal)) / speed) : 1;
  }
};

std::vector<Plate> plates_of(const Air& air, const Sheet& sheet, double time) {
  std::vector<Plate> plates;
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    const std::array<int, 3> v{sheet.triangles(t, 0), sheet.triangles(t, 1), sheet.triangles(t, 2)};
    const Vector2d e = sheet.pattern.row(v[1]) - sheet.pattern.row(v[0]),
                   f = sheet.pattern.row(v[2]) - sheet.pattern.row(v[0]);
    const Vector3d a = sheet.x.row(v[0]), b = sheet.x.row(v[1]), c = sheet.x.row(v[2]);
    Plate plate{v, 0.5 * std::abs(cross(e, f)), (a + b + c) / 3, triangle_normal(a, b, c), {}, {}};
    plate.wind = air_velocity(air, time, plate.centre);
    plate.slip = -plate.wind;
    if (sheet.v.rows() == sheet.x.rows())
      for (const int i : v) plate.slip += sheet.v.row(i).transpose() / 3;
    plates.push_back(plate);
  }
  return plates;
}

/// Friction coefficient of a plate, both sides, by its Reynolds number.
double friction_along(double reynolds) {
  return 2 * 1.328 / std::sqrt(std::max(reynolds, least_reynolds));
}

/// Sets the pressure of the plates by how far behind the leading edge of the sheet they are.
/// returns  [m] the length of the sheet in the direction of the air along it; 0: there is none
double find_leading_edge(std::vector<Plate>& plates, const Points3& x) {
  Vector3d along_sheet = Vector3d::Zero();
  for (const Plate& p : plates) along_sheet += p.area * (p.slip - p.normal * p.normal.dot(p.slip));
  const double length = along_sheet.norm();
  double area = 0;
  for (const Plate& p : plates) area += p.area;
  if (!(length > still * area)) return 0;
  // the sheet moves forward through the air: what is foremost is at the leading edge
  const Eigen::VectorXd behind = -(x * (along_sheet / length));
  const double first = behind.minCoeff(), depth = behind.maxCoeff() - first;
  if (!(depth > 0)) return 0;
  double sum = 0;
  for (Plate& p : plates) {
    double low = 1, high = 0;
    for (const int v : p.vertices) {
      const double c = std::clamp((behind[v] - first) / depth, 0.0, 1.0);
      low = std::min(low, c);
      high = std::max(high, c);
    }
    const double wide = std::max(high - low, 1e-6);
    high = std::min(1.0, low + wide);
    low = high - wide;
    p.leading = (pressure_up_to(high) - pressure_up_to(low)) / wide;
    sum += p.leading * p.area;
  }
  for (Plate& p : plates) p.leading *= area / sum;
  return depth;
}

}  // namespace

AirDrag::AirDrag(const Air& air, const Sheet& sheet, double dt, double time) {
  std::vector<Plate> plates = plates_of(air, sheet, time);
  const double depth = find_leading_edge(plates, sheet.x);
  double area = 0, swept = 0;  // [m2], [m3/s]
  for (const Plate& p : plates) {
    area += p.area;
    swept += p.area * p.slip.norm();
  }
  const double length = depth > 0 ? depth : std::sqrt(area);
  const double along = friction_along(air.density * swept / area * length / viscosity);
  for (const Plate& p : plates) {
    const double s = p.sine(), pressure = s + (1 - s) * p.leading;
    const Eigen::Matrix3d normal = p.normal * p.normal.transpose();
    panels_.push_back(
        {p.vertices, p.centre + dt * p.wind,
         0.5 * air.density * p.area * p.slip.norm() / dt *
             (drag_across * pressure * normal + along * (Eigen::Matrix3d::Identity() - normal))});
  }
}

Vector3d AirDrag::through_air(const Panel& p, const Points3& x) const {
  return (x.row(p.vertices[0]) + x.row(p.vertices[1]) + x.row(p.vertices[2])).transpose() / 3 -
         p.from;
}

double AirDrag::energy(const Points3& x) const {
  double sum = 0;
  for (const Panel& p : panels_) {
    const Vector3d u = through_air(p, x);
    sum += 0.5 * u.dot(p.per_step * u);
  }
  return sum;
}

double AirDrag::differentiate(const Points3& x, const std::vector<int>& block_of, Points3& gradient,
                              BlockCholesky& matrix) const {
  for (const Panel& p : panels_) {
    const Vector3d force = p.per_step * through_air(p, x) / 3;
    const Eigen::Matrix3d second = p.per_step / 9;
    for (int i = 0; i < 3; ++i) {
      gradient.row(p.vertices[i]) += force.transpose();
      for (int j = i; j < 3; ++j)
        matrix.add(matrix.slot(block_of[p.vertices[i]], block_of[p.vertices[j]]), second);
    }
  }
  return energy(x);
}

}  // namespace paperbake
