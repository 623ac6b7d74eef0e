#pragma once

#include "core/animation/animate.h"
#include "formats/files/raster_image.h"

#include <string>

namespace paperbake {

/// A frame as a developer of the core wants to see it, 1600 x 860 px.
///
/// left   the pattern: triangles coloured by k1 of their vertex tensors (red: bulges to the normal,
///        blue: away from it; full where the grade yields), a stroke along the ruling of each
///        vertex with |k1| > 3 1/m, rulings and curved regions of the method, handles with their
///        stiff discs, singular points with their numbers
/// right  the sheet from the front left above, flat facets: white its front, grey its back; handles
///        and singular points
///
/// Handles: green held, orange jammed, grey free. Singular points: magenta, numbered in order of
/// birth from 1. On the right what the sheet hides is a small dot.
/// title  first line
Image debug_picture(const Shot&, const AnimatedFrame&, const std::string& title);

}  // namespace paperbake
