#include "core/step2_crumple/lone_cone.h"

#include "core/geometry/curvature.h"
#include "core/geometry/hinges.h"
#include "core/geometry/measure.h"
#include "core/step2_crumple/cone_fit.h"

#include <algorithm>
#include <cmath>

namespace paperbake {

std::optional<Vector2d> apex_of_lone_cone(const Sheet& sheet, const Pattern& pattern,
                                          const Points3& curvature) {
  constexpr double most_off = 0.25;  // [1] half of what random rulings have
  // [1] where the paper bends in one narrow band, any point of it could be the apex: it is then at
  // infinity
  constexpr double cylinder_regularization = 0.02;
  const SecondTurn vertices = second_turn(sheet, find_hinges(sheet.triangles), curvature);
  std::vector<RulingSample> samples;
  double bend = 0;
  for (int v = 0; v < sheet.pattern.rows(); ++v) {
    const Principal p = principal_curvature(curvature.row(v));
    samples.push_back({sheet.pattern.row(v), p.across, vertices.area[v] * std::abs(p.k1)});
    bend += samples.back().weight;
  }
  const Cone cone = fit_cone(samples, std::sqrt(area(pattern)), cylinder_regularization);
  if (!(bend > 0) || cone.apex.z() == 0) return std::nullopt;
  const Vector2d apex = cone.centre + cone.scale * cone.apex.head<2>() / cone.apex.z();
  if (!contains(pattern, apex)) return std::nullopt;
  double off = 0;
  for (const RulingSample& s : samples) {
    const double r = (s.p - apex).norm();
    if (r > 0) off += s.weight * std::pow(s.across.dot(s.p - apex) / r, 2);
  }
  if (off > most_off * bend) return std::nullopt;
  return apex;
}

bool is_apex_taken(const Sheet& sheet, const std::vector<char>& held, const Vector2d& apex) {
  const double near = mean_edge(sheet.pattern, sheet.triangles);
  for (std::size_t v = 0; v < held.size(); ++v)
    if (held[v] && (sheet.pattern.row(v).transpose() - apex).norm() <= near) return true;
  return std::any_of(sheet.singular.begin(), sheet.singular.end(),
                     [&](const SingularPoint& s) { return (s.pattern - apex).norm() <= near; });
}

}  // namespace paperbake
