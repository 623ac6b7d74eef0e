#pragma once

#include <algorithm>

namespace paperbake {

// Limits on the iterations of an elastic step, and when a second branch is searched.

// [1] A step that needs more iterations than this leaves an unstable shape, and the nearest minimum
// may be a poor one.
inline constexpr int slow_convergence_iterations = 15;

// [1] A sheet in contact with itself can make small moves without end: what is unfinished continues
// in the next frame.
inline constexpr int max_contact_iterations_fine = 40, max_contact_iterations_interactive = 100;

// [1] How many of a step's iterations may be mixed Newton, in which the potential may rise: the
// rest is for line-search Newton, which only descends. Assumed: two thirds, and no more than 25.
// further  [1] iterations beyond these two thirds
inline int mixed_newton_limit(int max_iterations, int further = 0) {
  return std::min({25, max_iterations, 2 * max_iterations / 3 + further});
}
// [1] the same for a sheet that rests on a collider, which needs few; assumed
inline constexpr int max_mixed_newton_on_colliders = 12;

// Relaxation::coarse, all assumed
inline constexpr double coarse_stop = 10;         // [1] times `stop`: the next step continues there
inline constexpr int max_coarse_iterations = 20;  // [1]
// [1] of the longer side: a vertex that moves farther is on another branch
inline constexpr double max_coarse_move = 0.03;

// [triangles] A mesh of at most this size is animated interactively: a snap-through may go on over
// several frames.
inline constexpr int interactive_triangle_limit = 400;
// Iterations that a step on such a mesh may take.
struct IterationBudget {
  int total, first_phase;  // [1] iterations of a step; of these on the first branch
};
// the first three steps: a flat sheet that buckles to one side should arrive there
inline constexpr IterationBudget initial_steps{70, 30};
inline constexpr IterationBudget default_steps{42, 36}, with_pending_branch{42, 15};
// [1] further iterations beyond these, when the result is no shape that paper can have
inline constexpr int extra_iterations = 40;
// [1] stretch of an edge beyond which a step gets these extra iterations
inline constexpr double unfinished_stretch = 0.006;
// max_iterations of the options that these budgets hold for
inline constexpr int default_iterations = 60;
inline constexpr int min_iterations_to_start = 10;  // [1] iterations that must be left
inline constexpr double min_relative_gain = 0.02;   // [1] decrease of the potential, relative to it
// [1] steps without a search on a fine mesh that was changed, after a second branch that gained
// less
inline constexpr int branch_cooldown_steps = 8;
inline constexpr int max_tries = 4;  // in one phase of the descent on the second branch
// factor by which the membrane is softened in the first phase: its energy then has few valleys
inline constexpr double softening = 100;

// A smooth sheet that is locked in waves stretches where paper would bend, and the more its handles
// move, the more. With coarse triangles it may be the mesh that locks it.
// [1] of the bending stiffness: a square sheet that is bent by one radian stores half of it
inline constexpr double least_locked_bend = 0.5;
// [1] growth of the energy of a locked sheet until it searches again
inline constexpr double growth_until_search = 2;
// [1] of the potential, that it then has to gain: what is a little lower is another wave
inline constexpr double locked_gain = 1.0 / 3;

// when_slow                after a step that takes many iterations, or of a sheet that is locked
// when_locked_on_collider  only in the second case: the sheet rests on a collider
// none                     never
enum class BranchSearchMode { when_slow, when_locked_on_collider, none };
// Where the minimum is sought from: the initial guess of least potential, or where that leads with
// the softened membrane.
enum class StepStart { guess, softened };
enum class BranchSearchReason { slow, locked, locked_on_collider, none };

// [1] stretch of an edge; paper would tear, or slip out of a hand, before it gets here: as at
// give_way_depth (collider_distances.h), the handles give way
inline constexpr double give_way_stretch = 0.01;

}  // namespace paperbake
