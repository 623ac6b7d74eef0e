#pragma once

namespace paperbake {

// Limits on the iterations of an elastic step, and when a second branch is searched.

// [1] A step that needs more iterations than this leaves an unstable shape, and the nearest minimum
// may be a poor one.
inline constexpr int restless = 15;

// [1] A sheet in contact with itself can make small moves without end: what is unfinished continues
// in the next frame.
inline constexpr int most_iterations_in_touch = 20, most_in_touch_coarse = 40;

inline constexpr int most_strides_on_colliders = 12;

// [triangles] A mesh of at most this size is animated interactively: a snap-through may go on over
// several frames.
inline constexpr int coarse = 400;
// Iterations that a step on such a mesh may take.
struct Patience {
  int in_all, on_the_first;  // [1] iterations of a step; of these on the first branch
};
// the first three steps: a flat sheet that buckles to one side should arrive there
inline constexpr Patience at_first{70, 30};
inline constexpr Patience later{42, 36}, beside_another{42, 15};
// [1] further iterations beyond these, when the result is no shape that paper can have
inline constexpr int most_more = 40;
inline constexpr double on_the_way = 0.006;  // [1] because an edge is stretched by more than this
// max_iterations of the options that these budgets hold for
inline constexpr int usual_iterations = 60;
inline constexpr int worth_a_try = 10;        // [1] iterations that must be left
inline constexpr double worth_having = 0.02;  // [1] decrease of the potential, relative to it
// [1] steps without a search on a fine mesh that was changed, after a second branch that gained
// less
inline constexpr int content_for = 8;
inline constexpr int most_tries = 4;  // in one phase of the descent on the second branch
// factor by which the membrane is softened in the first phase: its energy then has few valleys
inline constexpr double softening = 100;
enum class SecondWays { where_restless, none };

// Paper would tear, or slip out of a hand, before it gets here: the handles give way.
inline constexpr double jam_stretch = 0.01;  // [1] stretch of an edge
inline constexpr double jam_inside = 1e-4;   // [m] depth inside a collider

}  // namespace paperbake
