#pragma once

#include "core/model/sheet.h"

namespace paperbake {

/// Least distance of two sheets, 0 where they pass through each other; `within` when it is more.
/// [m]
double distance_between(const Sheet&, const Sheet&, double within);

/// Share of the vertices of both that are nearer than that to the other. [1]
double share_within(const Sheet&, const Sheet&, double distance);

}  // namespace paperbake
