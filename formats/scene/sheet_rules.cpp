#include "formats/scene/sheet_rules.h"

#include "core/model/error.h"
#include "core/model/segment2.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace paperbake {
namespace {

/// Leads a crease through the handles and singular points that it would pass at less than
/// `tolerance` [m]: a mesh with both would have slivers between them.
PrescribedCrease snapped_to_points(const PrescribedCrease& crease,
                                   const std::vector<Vector2d>& points, double tolerance) {
  PrescribedCrease snapped{{}, crease.angle};
  for (std::size_t k = 0; k + 1 < crease.line.size(); ++k) {
    const Vector2d from = crease.line[k], along = crease.line[k + 1] - from;
    std::vector<std::pair<double, Vector2d>> passed{{0, from}};
    for (const Vector2d& p : points) {
      const double t = nearest_share(p, from, crease.line[k + 1]);
      if ((from + t * along - p).norm() < tolerance) passed.emplace_back(t, p);
    }
    std::stable_sort(passed.begin(), passed.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [t, p] : passed) {
      // a point at the end of a segment replaces that end
      if (!snapped.line.empty() && (p - snapped.line.back()).norm() < tolerance)
        snapped.line.back() = p;
      else
        snapped.line.push_back(p);
    }
  }
  if (const Vector2d end = crease.line.back(); (end - snapped.line.back()).norm() >= tolerance)
    snapped.line.push_back(end);
  return snapped;
}

}  // namespace

std::string metres(const Vector2d& size) {
  return fmt::format("{:.4g} x {:.4g} m", size.x(), size.y());
}

std::vector<PrescribedCrease> with_ends_on_border(std::vector<PrescribedCrease> creases,
                                                  const Pattern& pattern) {
  constexpr double near = 1e-4;  // of the longer side
  for (PrescribedCrease& crease : creases)
    for (Vector2d& p : crease.line)
      if (const Vector2d border = nearest_border_point(pattern, p);
          (border - p).norm() <= near * longer_side(pattern))
        p = border;
  return creases;
}

void snap_creases_to_points(SceneSheet& sheet) {
  std::vector<Vector2d> points = sheet.singular_point_rules.fixed;
  for (const Handle& handle : sheet.handles) points.push_back(handle.pattern);
  for (PrescribedCrease& crease : sheet.pattern.prescribed_creases)
    crease = snapped_to_points(crease, points, 2e-3 * longer_side(sheet.pattern));
}

void check_rules(const SingularPointRules& rules, const Pattern& pattern, const std::string& place,
                 const std::string& name) {
  constexpr int samples = 64;  // of each segment of a crease
  const double rounding = 1e-6 * longer_side(pattern);
  const auto check = [&](const char* key, const Vector2d& p) {
    if (contains(pattern, p, rounding)) return;
    throw Error(ErrorCode::command, place,
                fmt::format("The {} at ({:g}, {:g}) m is not on the sheet \"{}\".", key, p.x(),
                            p.y(), name),
                fmt::format("Its pattern is {}, from (0, 0).", metres(extent(pattern))));
  };
  for (const Vector2d& p : rules.fixed) check("singular_keep", p);
  for (const PrescribedCrease& crease : pattern.prescribed_creases)
    for (std::size_t k = 0; k + 1 < crease.line.size(); ++k) {
      if ((crease.line[k + 1] - crease.line[k]).norm() < 1e-3 * longer_side(pattern))
        throw Error(
            ErrorCode::command, place,
            fmt::format(
                "A segment of a crease of the sheet \"{}\" is shorter than 0.1 % of the sheet.",
                name),
            "Leave out one of its points.");
      for (int i = 0; i <= samples; ++i)
        check("crease",
              crease.line[k] + i / double(samples) * (crease.line[k + 1] - crease.line[k]));
    }
}

}  // namespace paperbake
