#pragma once

#include "core/model/sheet.h"

namespace paperbake {

/// Pairs of triangles that pass through each other (touching in a shared vertex or edge does not
/// count).
int crossings(const Sheet&);
/// The same of two sheets: pairs of one of each.
int crossings_between(const Sheet&, const Sheet&);

}  // namespace paperbake
