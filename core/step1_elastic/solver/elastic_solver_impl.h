#pragma once

#include "core/step1_elastic/contact/collider_contact.h"
#include "core/step1_elastic/contact/sheet_contact.h"
#include "core/step1_elastic/elastic.h"
#include "core/step1_elastic/energies/air_drag.h"
#include "core/step1_elastic/energies/elastic_energy.h"
#include "core/step1_elastic/energies/handle_springs.h"
#include "core/step1_elastic/solver/newton.h"
#include "core/step1_elastic/solver/panel_motion.h"
#include "core/step1_elastic/solver/predictor.h"
#include "core/step1_elastic/solver/solver_limits.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace paperbake {

/// A step as the solver takes it.
struct StepProblem {
  PositionConstraints constraints;  // with targets as far as colliders let the vertices go
  PositionConstraints hard;         // those of them that are hard
  ColliderMotion colliders;
  double dt;    // [s]
  double time;  // [s] at its end, since the first frame
};

/// What a search for a second branch begins with, after a step.
struct SecondBranchSearch {
  const Points3& before;  // |V|x3 [m] where the step began
  const Points3& start;   // |V|x3 [m] the initial guess from there
  const PositionConstraints& hard;
  BranchSearchReason reason;
};

/// The solver's data for one sheet, and the parts of a step.
struct Elastic::Impl {
  class JointStep;  // joint_step.cpp

  Paper paper;
  ElasticOptions options;

  std::optional<ElasticEnergy> energy, softened;
  Eigen::VectorXd mass;
  double mean_edge = 0;
  SolverState state;  // positions are cleared when the number of vertices changes
  PlasticGrid* grid = nullptr;
  Points2 pattern;
  Triangles triangles;
  // which cells of the grid the triangles cover, computed when it is first needed
  std::optional<PlasticGrid::Cover> found_cover;

  std::optional<SheetContact> contact;
  std::optional<ColliderContact> colliders;
  // [m] of the step: where its panels move rigidly, as they are and flat (panel_motion.h); or empty
  std::vector<Points3> panels;
  std::optional<AirDrag> air;       // of the step; none in a vacuum and without inertia
  FrictionHistory friction_at_end;  // of the step, if it is accepted

  // these belong to the mesh and to the set of constrained vertices
  std::vector<int> held;       // eliminated from the system
  std::vector<int> predicted;  // vertices that the predictor takes to their targets
  std::vector<int> block_of;
  std::unique_ptr<BlockCholesky> matrix;
  bool matrix_of_contact = false;
  std::unique_ptr<Predictor> predictor;

  const PlasticGrid::Cover& cover();
  void load_plastic_state();
  void load_plastic_state_on_new_mesh();

  /// Finds the ridges: where the sheet bends in two directions at the beginning of a step, it
  /// yields as ridges do (ridge_yield.h).
  void find_ridges_of_step(const Sheet&, const std::vector<int>& vertices);

  /// Solves without plasticity first, if the paper has never yielded: most often it does not yield
  /// in this step either. If no triangle exceeds its yield curvature at that minimum, it is also a
  /// minimum of paper that can yield. If one does, or if the minimum was not reached, the sheet is
  /// solved for again with plasticity. Colliders bend paper sharply, so with colliders it is solved
  /// with plasticity at once.
  /// find   finds where the given sheet yields; called with the sheet as it was at the beginning
  /// solve  a step or a relaxation of the sheet as it is, with the plastic state that is loaded
  template <class Find, class Solve>
  ElasticReport try_without_plasticity(Sheet&, Find, Solve);

  /// Writes the plastic increment to the grid and loads it as the state before the next step.
  /// returns  [m rad] growth of the integral
  double commit_plastic_state(const std::vector<double>& dihedral_angles);

  /// Reads the state of the creases from the sheet: at the beginning of each step, because the
  /// sheet may have been set back or folded since the last one.
  /// curl  removed: the plastic curvature of triangles at edges that are folded now, and were not
  ///       before, is taken out of the grid. It has become the rest angle of the crease; left in
  ///       the triangles beside it, it would keep them curled.
  /// returns  [m rad] growth of the integral of the grid
  enum class Curl { removed, stays };
  double load_creases(const Sheet&, Curl);
  /// Writes the state of the creases at the end of a step to the sheet. Where the paper has folded
  /// in this step, the edge is a hinge from now on.
  /// returns  [m rad] growth of the integral of the grid
  double commit_creases(Sheet&, const std::vector<double>& dihedral_angles);

  /// Writes the energies stored in the sheet to the report.
  void report_energies(const Points3& x, const std::vector<double>& dihedral_angles,
                       ElasticReport&) const;

  /// Makes a new predictor if these are not the vertices that the present one takes along.
  void update_predictor(const Sheet&, const std::vector<int>& hard);
  /// Makes a new matrix of the free vertices where the present one does not fit, and updates the
  /// predictor.
  /// fixed     vertices that are eliminated
  /// hard      vertices that the predictor takes to their targets
  /// touching  pairs of vertices that contact couples
  void build_linear_system(const Sheet&, const std::vector<int>& fixed,
                           const std::vector<int>& hard,
                           const std::vector<std::pair<int, int>>& touching);

  bool is_interactive() const { return triangles.rows() <= interactive_triangle_limit; }
  IterationBudget iteration_budget() const {
    return state.second ? with_pending_branch : state.steps < 3 ? initial_steps : default_steps;
  }
  int max_iterations_of_step() const {
    return is_interactive() ? std::max(1, iteration_budget().first_phase * options.max_iterations /
                                              default_iterations)
                            : options.max_iterations;
  }
  int max_contact_iterations() const {
    const int most = is_interactive() || (colliders && options.inertia == Inertia::quasi_static)
                         ? max_contact_iterations_interactive
                         : max_contact_iterations_fine;
    return std::max(1, most * options.max_iterations / default_iterations);
  }

  /// stress  of the membrane where x came from
  NewtonReport minimise(const IncrementalPotential& W, const NewtonOptions& how,
                        const MembraneStress& stress, Points3& x) {
    return paperbake::minimise({W, *matrix, block_of, mean_edge, paper.membrane_stiffness}, how,
                               stress, x);
  }

  /// Advances the descent in its present phase by at most this number of iterations. On an
  /// interactive mesh one call uses one variant of Newton's method: mixed Newton at the first
  /// try, line-search Newton later.
  void advance(BranchDescent&, const IncrementalPotential& W, int most, ElasticReport&);

  /// Descends along a second branch from an unstable shape, first with the softened membrane; the
  /// result is taken if it is lower.
  void descend_second_branch(const IncrementalPotential& W, const SecondBranchSearch&, Points3& x,
                             ElasticReport&);
  /// Whether there is reason to search for a second branch after a step to this sheet.
  BranchSearchReason reason_to_search(const Sheet&, BranchSearchMode, const ElasticReport&);
  /// Keeps how much a locked sheet stores. returns  whether it has become locked, or has stretched
  /// far more since a branch was last searched
  bool note_locking(const Sheet&);

  /// The panels of the sheet whose creases were read last; none: it has no creases.
  std::optional<Panels> panels_now() const;
  /// Reads the creases from the sheet at the beginning of a step, and finds where its panels go.
  void begin_creases(const Sheet&, const StepInput&, const StepProblem&);

  /// The step that begins where the sheet is.
  StepProblem problem_of(const Sheet&, const StepInput&, double dt);

  /// Potential of a step of the sheet from where it is. springs  constraints that pull
  SheetPotential potential(const Sheet&, const StepProblem&, PositionConstraints springs);
  /// Initial guesses for the end of the step; on a folded sheet the first ones have moved its
  /// panels. with_contact: then handles may lag behind, and some of the guesses do not make the
  /// sheet jump to them.
  std::vector<Points3> guesses(const Points3& before, const PositionConstraints& hard,
                               bool with_contact);

  /// One solution of the step; `self_contact` is null for a step without self-contact.
  ElasticReport solve(Sheet&, const StepProblem&, SheetContact* self_contact,
                      const NewtonOptions& how, BranchSearchMode second,
                      StepStart = StepStart::guess);

  /// Solves without self-contact. On an interactive mesh, an unfinished step gets further
  /// iterations as long as paper could not have the shape.
  ElasticReport step_without_contact(Sheet&, const StepProblem&);
  ElasticReport step_with_contact(Sheet&, const StepProblem&);
  /// Solves without self-contact, and again with it if that turns out to be needed.
  ElasticReport step_with_contact_fallback(Sheet&, const StepProblem&);

  /// Writes to the report what colliders and handles do at the end of the step.
  /// springs  constraints that may give way
  void report_constraints(const Points3& x, const PositionConstraints& springs, ElasticReport&);

  /// Moves the vertices from x to other places; where the sheet would pass through itself there,
  /// one after the other, each as far as nothing of the sheet is in its way.
  void go_free_of_collisions(const StepProblem&, const Points3& to, Points3& x);

  /// Finishes a step that began at `before`: writes the plastic increment and adds the step to the
  /// past.
  void finish_step(Sheet&, const Points3& before, const StepProblem&, ElasticReport&);
};

/// Moves x to the initial guess of least potential. With contact, each guess is first shortened so
/// that the straight motion from `before` to it is collision-free.
/// throws  EnergyNotFinite when the potential of no guess is finite
void choose_initial_guess(const IncrementalPotential& W, const Points3& before,
                          std::vector<Points3>& guesses, Points3& x);

}  // namespace paperbake
