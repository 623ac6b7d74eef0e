#include "core/step2_crumple/singular_points.h"

#include <algorithm>
#include <cmath>

namespace paperbake {

double min_spacing(const Pattern& pattern, const Paper& paper, const CrumpleOptions& options) {
  return options.spacing * ridge_width(paper, std::sqrt(area(pattern)));
}

std::optional<Vector2d> draw_singular_point(const Sheet& sheet, const Pattern& pattern,
                                            const Paper& paper, const SingularPointAim& aim,
                                            const CrumpleOptions& options,
                                            const RandomEvent& birth) {
  constexpr int max_draws = 20;
  const auto clear = [&](const Vector2d& p) {
    return !options.singular_point_rules.forbids(p) &&
           std::none_of(sheet.singular.begin(), sheet.singular.end(), [&](const SingularPoint& s) {
             return (s.pattern - p).norm() < aim.spacing;
           });
  };
  const double margin = options.border_share * longer_side(pattern);
  for (std::uint32_t draw = 0; draw < max_draws; ++draw) {
    const Vector2d p = aim.middle + paper.apex_scatter * gaussian(birth, draw);
    if (contains(pattern, p) && (nearest_border_point(pattern, p) - p).norm() >= margin && clear(p))
      return p;
  }
  if (!clear(aim.middle)) return std::nullopt;
  return aim.middle;
}

}  // namespace paperbake
