#pragma once

#include "core/hands/expected_creases.h"

#include <vector>

namespace paperbake {

/// Whether a fold is shut before the hands of another line begin to turn.
bool is_shut_before(const ExpectedCrease& fold, const ExpectedCrease& hands);

/// Leads lines on through paper that lies double. Where the line of two hands meets another fold
/// that was more shut than open when they began, it does not go straight on: the layer beyond that
/// fold lies upside down on the one that the hands turn, and is folded along the mirror image of
/// the line. So the line ends there, and its mirror image from there to the border is another
/// expected crease of the same hands, as where both layers of a doubled sheet get one corner turned
/// down. Lines that cross at right angles are their own mirror image.
/// returns  the mirror images
/// source   this project
std::vector<ExpectedCrease> lead_through_layers(std::vector<ExpectedCrease>&, const Pattern&);

}  // namespace paperbake
