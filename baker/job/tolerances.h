#pragma once

namespace paperbake {

// What the gates of a bake (baker/output/gates.h) let pass. A scene that asks for no more than that
// beyond what paper can do is not called impossible.
inline constexpr double handle_tolerance = 1e-3;        // [m] of a handle from its key
inline constexpr double mean_stretch_tolerance = 0.02;  // [1] of the edges of a sheet, in the mean

}  // namespace paperbake
