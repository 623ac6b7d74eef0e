#pragma once

namespace paperbake {

inline constexpr double collider_dhat = 5e-4;  // [m] within which a collider pushes the sheet
// [m] inside a collider; paper would tear, or slip out of a hand, before it gets so deep
inline constexpr double give_way_depth = 1e-4;
// [m] inside a collider, where a step may end: assumed, half of what jams a sheet. What is deeper
// is pushed out as far as that.
inline constexpr double tolerated_depth = 5e-5;
// [m] inside a collider, to which a change of mesh or a fold may bring a sheet that was outside:
// assumed, far less than a step may, because nothing pushes it out before the next one
inline constexpr double tolerated_depth_of_change = 2e-5;

}  // namespace paperbake
