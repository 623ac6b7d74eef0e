#include "core/step1_elastic/energies/apex_stiffness.h"

#include "core/geometry/hinges.h"
#include "core/geometry/singular_vertices.h"
#include "core/model/segment2.h"

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

constexpr double min_log = 0.5;

/// Distance on the pattern from a singular point to the nearest other one, or to the border.
double size_of_cone(const Sheet& sheet, const Hinges& hinges, std::size_t k) {
  const Vector2d apex = sheet.singular[k].pattern;
  double size = 1e300;
  for (std::size_t j = 0; j < sheet.singular.size(); ++j)
    if (j != k) size = std::min(size, (sheet.singular[j].pattern - apex).norm());
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i)
      if (hinges.of_triangle[t][i] < 0)
        size = std::min(
            size, distance_to_segment(apex, sheet.pattern.row(sheet.triangles(t, (i + 1) % 3)),
                                      sheet.pattern.row(sheet.triangles(t, (i + 2) % 3))));
  return size;
}

/// Mean of ln r over the angle between two spokes, where r reaches to the line between their ends:
/// Simpson's rule over both spokes and their bisector.
double mean_log(const Vector2d& u, const Vector2d& v) {
  const double a = u.norm(), b = v.norm(),
               half_cosine = std::sqrt(std::max(0.0, 0.5 * (1 + u.dot(v) / (a * b))));
  const double bisector = 2 * a * b * half_cosine / (a + b);
  return (std::log(a) + 4 * std::log(bisector) + std::log(b)) / 6;
}

}  // namespace

double core_radius(const Paper& paper, double R) {
  return 0.3 * std::cbrt(paper.thickness) * std::pow(R, 2.0 / 3);
}

std::vector<double> apex_stiffness_factors(const Sheet& sheet, const Paper& paper) {
  if (sheet.singular.empty()) return {};
  const Hinges hinges = find_hinges(sheet.triangles);
  // [m] core radius of the vertices that are apices; 0 for the others
  std::vector<double> core(sheet.pattern.rows(), 0.0);
  for (std::size_t k = 0; k < sheet.singular.size(); ++k)
    for (int v = 0; v < sheet.pattern.rows(); ++v)
      if (is_at_vertex(sheet.singular[k], sheet, v))
        core[v] = core_radius(paper, size_of_cone(sheet, hinges, k));

  std::vector<double> factors(sheet.triangles.rows(), 1.0);
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    double sum = 0;
    int apices = 0;
    for (int i = 0; i < 3; ++i) {
      const int apex = sheet.triangles(t, i);
      if (core[apex] <= 0) continue;
      const Vector2d u =
          (sheet.pattern.row(sheet.triangles(t, (i + 1) % 3)) - sheet.pattern.row(apex))
              .transpose();
      const Vector2d v =
          (sheet.pattern.row(sheet.triangles(t, (i + 2) % 3)) - sheet.pattern.row(apex))
              .transpose();
      sum += 0.5 * std::max(min_log, mean_log(u, v) - std::log(core[apex]));
      ++apices;
    }
    if (apices > 0) factors[t] = sum / apices;
  }
  return factors;
}

}  // namespace paperbake
