#pragma once

#include "baker/studies/chart.h"

#include <string>

namespace paperbake {

/// The chart as an SVG of two panels, both over the time of a frame on logarithmic axes: the
/// distance to the reference (of a chaotic scene: the stored energy over the reference's) and c_m.
/// Every method has its colour; seeds of one size are joined by a bar and labelled once; the Pareto
/// front is a line; what did not finish is a hollow point with a cross.
std::string chart_svg(const Chart&);

}  // namespace paperbake
