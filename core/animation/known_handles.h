#pragma once

#include "core/model/handles.h"

#include <vector>

namespace paperbake {

/// The handles, with those relative ones made absolute of which it is known before the first frame
/// where they take hold: the sheet still lies as it began, because no handle that holds it has
/// moved until then. The others stay relative.
///
/// start        the sheet at the first frame
/// first_frame  frame of row 0 of Handle::keyed
std::vector<Handle> with_known_places(std::vector<Handle>, const Sheet& start, int first_frame);

}  // namespace paperbake
