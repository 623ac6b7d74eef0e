#pragma once

#include "core/geometry/random.h"
#include "core/model/paper.h"
#include "core/model/pattern.h"
#include "core/model/sheet.h"
#include "core/step2_crumple/crumple_options.h"

#include <optional>

namespace paperbake {

/// Least distance between singular points. The ridges that end in one are half as wide as a ridge
/// across the whole sheet, and there is as much of a facet between them. Thus heavier paper has
/// larger facets, and a large sheet has larger ones than a small sheet. [m]
double min_spacing(const Pattern&, const Paper&, const CrumpleOptions&);

/// Where a singular point is to be born.
struct SingularPointAim {
  Vector2d middle;  // [m] middle_of_conflict()
  double spacing;   // [m] least distance from other points
};

/// Draws the place of a new singular point by the law of [Schreck 2015]: from a Gaussian around the
/// middle of the conflict with the standard deviation of the paper grade, within the sheet, not
/// where it is forbidden and not too close to the border or to other points. After 20 rejected
/// draws it is the middle itself.
/// birth    its number is that of the birth on this sheet
/// returns  [m] nothing when even the middle is forbidden or too close to another singular point
std::optional<Vector2d> draw_singular_point(const Sheet&, const Pattern&, const Paper&,
                                            const SingularPointAim&, const CrumpleOptions&,
                                            const RandomEvent& birth);

}  // namespace paperbake
