#pragma once

namespace paperbake {

// How long an elastic step is tried, and when it is tried another way.

// A step that needs more iterations than this leaves an unstable shape, and the nearest minimum may
// be a poor one.
inline constexpr int slow_convergence_iterations = 15;

// A sheet that pushes itself has no end of small moves: what is not finished goes on in the next
// frame.
inline constexpr int max_contact_iterations_fine = 20, max_contact_iterations_interactive = 40;

inline constexpr int max_mixed_newton_on_colliders = 12;

// A coarse mesh is animated to be looked at while one works: a snap goes on in the next frames.
// [triangles]
inline constexpr int interactive_triangle_limit = 400;
struct IterationBudget {
  int total, first_phase;  // [1] iterations of a step; of them, on the first way
};
// of three steps: a flat sheet that chooses a side is to be done with it
inline constexpr IterationBudget initial_steps{70, 30};
inline constexpr IterationBudget default_steps{42, 36}, with_pending_branch{42, 15};
// ... beyond these, when they end in no shape of paper: an edge is stretched by
inline constexpr int extra_iterations = 40;
inline constexpr double unfinished_stretch = 0.006;  // [1] more than this
inline constexpr int default_iterations = 60;        // of the options, for which these hold
inline constexpr int min_iterations_to_start = 10;   // [1] iterations
inline constexpr double min_relative_gain = 0.02;    // [1] of the potential
// [1] steps of a fine mesh that was changed, after a second way that found less
inline constexpr int branch_cooldown_steps = 8;
inline constexpr int max_attempts = 4;  // of a leg of the second way
// of the membrane on it: its landscape has few valleys
inline constexpr double softening = 100;
enum class BranchSearchMode { when_slow, none };

// Paper tears, or is torn out of a hand, before: what holds it gives way.
inline constexpr double yield_stretch = 0.01;  // [1] of an edge
inline constexpr double yield_depth = 1e-4;    // [m] of a collider

}  // namespace paperbake
