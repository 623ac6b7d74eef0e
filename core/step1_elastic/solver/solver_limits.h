#pragma once

namespace paperbake {

// How long an elastic step is tried, and when it is tried another way.

// A step that needs more iterations than this leaves an unstable shape, and the nearest minimum may
// be a poor one.
inline constexpr int restless = 15;

// A sheet that pushes itself has no end of small moves: what is not finished goes on in the next
// frame.
inline constexpr int most_iterations_in_touch = 20, most_in_touch_coarse = 40;

inline constexpr int most_strides_on_colliders = 12;

// A coarse mesh is animated to be looked at while one works: a snap goes on in the next frames.
// [triangles]
inline constexpr int coarse = 400;
struct Patience {
  int in_all, on_the_first;  // [1] iterations of a step; of them, on the first way
};
// of three steps: a flat sheet that chooses a side is to be done with it
inline constexpr Patience at_first{70, 30};
inline constexpr Patience later{42, 36}, beside_another{42, 15};
// ... beyond these, when they end in no shape of paper: an edge is stretched by
inline constexpr int most_more = 40;
inline constexpr double on_the_way = 0.006;   // [1] more than this
inline constexpr int usual_iterations = 60;   // of the options, for which these hold
inline constexpr int worth_a_try = 10;        // [1] iterations
inline constexpr double worth_having = 0.02;  // [1] of the potential
// [1] steps of a fine mesh that was changed, after a second way that found less
inline constexpr int content_for = 8;
inline constexpr int most_tries = 4;  // of a leg of the second way
// of the membrane on it: its landscape has few valleys
inline constexpr double softening = 100;
enum class SecondWays { where_restless, none };

// Paper tears, or is torn out of a hand, before: what holds it gives way.
inline constexpr double jam_stretch = 0.01;  // [1] of an edge
inline constexpr double jam_inside = 1e-4;   // [m] of a collider

}  // namespace paperbake
