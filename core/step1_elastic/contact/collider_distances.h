#pragma once

namespace paperbake {

inline constexpr double collider_dhat = 5e-4;  // [m] within which a collider pushes the sheet
// [m] inside a collider; paper would tear, or slip out of a hand, before it gets so deep
inline constexpr double give_way_depth = 1e-4;

}  // namespace paperbake
