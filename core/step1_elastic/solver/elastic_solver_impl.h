#pragma once

#include "core/step1_elastic/contact/collider_contact.h"
#include "core/step1_elastic/contact/self_contact.h"
#include "core/step1_elastic/elastic.h"
#include "core/step1_elastic/energies/elastic_energy.h"
#include "core/step1_elastic/energies/handle_springs.h"
#include "core/step1_elastic/solver/newton.h"
#include "core/step1_elastic/solver/predictor.h"
#include "core/step1_elastic/solver/solver_limits.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace paperbake {

/// One sheet as step 1 knows it, and the parts of its step.
struct Elastic::Impl {
  Paper paper;
  ElasticOptions options;

  std::optional<ElasticEnergy> energy, softened;
  Eigen::VectorXd mass;
  double mean_edge = 0;
  SolverState state;  // positions are emptied when the number of vertices changes
  PlasticGrid* grid = nullptr;
  Points2 pattern;
  Triangles triangles;
  // of the grid by the triangles, when it was first needed
  std::optional<PlasticGrid::Cover> found_cover;

  std::optional<Contact> contact;
  std::optional<ColliderContact> colliders;

  // belongs to the mesh and the set of held vertices
  std::vector<int> held;       // left out of the solve
  std::vector<int> predicted;  // taken along by the predictor
  std::vector<int> block_of;
  std::unique_ptr<BlockCholesky> matrix;
  bool matrix_of_contact = false;
  std::unique_ptr<Predictor> predictor;

  const PlasticGrid::Cover& cover();
  void load_plastic_state();
  void load_plastic_state_on_new_mesh();

  /// Where the sheet bends in two directions as a step begins, it yields as ridges do.
  void find_ridges_of_step(const Sheet&, const std::vector<int>& vertices);

  /// Paper in which nothing has flowed so far most often stays so: where it has not yielded at a
  /// minimum of paper that cannot, that is one of paper that can. Only where it has is it solved
  /// for again. What a collider bends hooks sharply: it is taken as it is.
  /// find   what is to be known, of the sheet as it was, of where it yields
  /// solve  a step or a settling of the sheet as it is, with what is known of the paper
  template <class Find, class Solve>
  ElasticReport try_without_plasticity(Sheet&, Find, Solve);

  /// What has flowed goes to the grid and comes back as the past of the next step. returns the
  /// growth of the integral [m rad]
  double commit_plastic_state(const std::vector<double>& dihedral_angles);

  /// What is stored in the sheet goes to the report.
  void report_energies(const Points3& x, const std::vector<double>& dihedral_angles,
                       ElasticReport&) const;

  /// The predictor takes these vertices along.
  void update_predictor(const Sheet&, const std::vector<int>& hard);
  /// touching: pairs of vertices that contact couples
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
    return std::min(options.max_iterations, is_interactive() ? max_contact_iterations_interactive
                                                             : max_contact_iterations_fine);
  }

  /// stress  of the membrane where x came from
  NewtonReport minimise(const IncrementalPotential& W, const NewtonOptions& how,
                        const MembraneStress& stress, Points3& x) {
    return paperbake::minimise({W, *matrix, block_of, mean_edge, paper.membrane_stiffness}, how,
                               stress, x);
  }

  /// The next leg of the second way, as far as `most` iterations take it. On a coarse mesh it is
  /// one of the two ways down.
  void advance(BranchDescent&, const IncrementalPotential& W, int most, ElasticReport&);

  /// A second way down from an unstable shape, first with the softened membrane; taken when it ends
  /// lower.
  /// before  where this step began
  /// start   the guess from there
  void descend_second_branch(const IncrementalPotential& W, const Points3& before,
                             const Points3& start, const HardConstraints& hard, Points3& x,
                             ElasticReport&);

  /// Handles as far as colliders let them go.
  PositionConstraints reachable_targets(const Sheet&, const PositionConstraints&, double dt);

  /// Of a step of a sheet from where it is.
  SheetPotential potential(const Sheet&, double dt, std::vector<HandleSpring> springs);
  /// Where the sheet may be at the end of it. feels: it need not jump where handles lag behind
  std::vector<Points3> guesses(const Points3& before, const HardConstraints& hard, bool feels);

  /// One step; `feels` is null for a sheet that does not feel itself.
  ElasticReport solve(Sheet&, const PositionConstraints&, const HardConstraints& hard, double dt,
                      Contact* feels, const NewtonOptions& how, BranchSearchMode second);

  /// By itself, or with self-contact where it turns out that it is needed.
  ElasticReport step_with_contact_fallback(Sheet&, const PositionConstraints&,
                                           const HardConstraints& hard, double dt);

  /// What colliders and handles say at its end.
  void report_constraints(const Points3& x, const std::vector<HandleSpring>& springs,
                          ElasticReport&);

  /// The end of a step that began at `before`: what flowed is kept, and the past is one step
  /// longer.
  void finish_step(Sheet&, const Points3& before, const PositionConstraints&, double dt,
                   ElasticReport&);
};

/// Moves x to the guess of least potential, none of which passes through anything on its way from
/// `before`. throws Error(Fault::simulation) when none is finite
void choose_initial_guess(const IncrementalPotential& W, const Points3& before,
                          std::vector<Points3>& guesses, Points3& x);

}  // namespace paperbake
