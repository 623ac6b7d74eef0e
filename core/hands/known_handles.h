#pragma once

#include "core/model/handles.h"

#include <vector>

namespace paperbake {

/// The handles, with those relative ones made absolute that take hold while no handle has moved the
/// sheet yet: it is taken to lie as it began. The others stay relative. A sheet that falls, or that
/// a collider moves, may have gone elsewhere before: this is good enough to expect a fold, and not
/// to say what is impossible.
///
/// start        the sheet at the first frame
/// first_frame  frame of row 0 of Handle::keyed
std::vector<Handle> with_known_places(std::vector<Handle>, const Sheet& start, int first_frame);

}  // namespace paperbake
