#pragma once

#include "core/sheet.h"

namespace paperbake {

/// Least distance of two sheets, 0 where they pass through each other; `within` when it is more. [m]
double distance_between(const Sheet&, const Sheet&, double within);

}  // namespace paperbake
