#pragma once

#include "core/model/sheet.h"

namespace paperbake {

/// Number of pairs of triangles of a sheet that intersect. Touching in a shared vertex or edge does
/// not count.
int crossings(const Sheet&);
/// The same for two sheets: pairs with one triangle from each.
int crossings_between(const Sheet&, const Sheet&);

}  // namespace paperbake
