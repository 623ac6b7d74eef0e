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
  ElasticPast past;  // positions are emptied when the number of vertices changes
  PlasticGrid* grid = nullptr;
  Points2 pattern;
  Triangles triangles;
  // of the grid by the triangles, when it was first needed
  std::optional<PlasticGrid::Cover> found_cover;

  std::optional<Contact> contact;
  std::optional<ColliderContact> colliders;

  // belongs to the mesh and the set of held vertices
  std::vector<int> held;    // left out of the solve
  std::vector<int> guided;  // taken along by the predictor
  std::vector<int> block_of;
  std::unique_ptr<BlockCholesky> matrix;
  bool matrix_of_contact = false;
  std::unique_ptr<Predictor> predictor;

  const PlasticGrid::Cover& cover();
  void recall();
  void recall_on_new_mesh();

  /// Where the sheet bends in two directions as a step begins, it yields as ridges do.
  void look_for_ridges(const Sheet&, const std::vector<int>& vertices);

  /// Paper in which nothing has flowed so far most often stays so: where it has not yielded at a
  /// minimum of paper that cannot, that is one of paper that can. Only where it has is it solved
  /// for again. What a collider bends hooks sharply: it is taken as it is.
  /// find   what is to be known, of the sheet as it was, of where it yields
  /// solve  a step or a settling of the sheet as it is, with what is known of the paper
  template <class Find, class Solve>
  ElasticReport elastic_first(Sheet&, Find, Solve);

  /// What has flowed goes to the grid and comes back as the past of the next step. returns the
  /// growth of the integral [m rad]
  double remember(const std::vector<double>& fold_angles);

  /// What is stored in the sheet goes to the report.
  void tell_stored(const Points3& x, const std::vector<double>& fold_angles, ElasticReport&) const;

  /// The predictor takes these vertices along.
  void guide(const Sheet&, const std::vector<int>& hard);
  /// touching: pairs of vertices that contact couples
  void hold(const Sheet&, const std::vector<int>& fixed, const std::vector<int>& hard,
            const std::vector<std::pair<int, int>>& touching);

  bool is_coarse() const { return triangles.rows() <= coarse; }
  Patience patience() const {
    return past.second ? beside_another : past.steps < 3 ? at_first : later;
  }
  int most_iterations() const {
    return is_coarse()
               ? std::max(1, patience().on_the_first * options.max_iterations / usual_iterations)
               : options.max_iterations;
  }
  int most_in_touch() const {
    return std::min(options.max_iterations,
                    is_coarse() ? most_in_touch_coarse : most_iterations_in_touch);
  }

  /// stress  of the membrane where x came from
  NewtonReport minimise(const IncrementalPotential& W, const NewtonOptions& how,
                        const MembraneStress& stress, Points3& x) {
    return paperbake::minimise({W, *matrix, block_of, mean_edge, paper.membrane_stiffness}, how,
                               stress, x);
  }

  /// The next leg of the second way, as far as `most` iterations take it. On a coarse mesh it is
  /// one of the two ways down.
  void go_on(SecondWay&, const IncrementalPotential& W, int most, ElasticReport&);

  /// A second way down from an unstable shape, first with the softened membrane; taken when it ends
  /// lower.
  /// before  where this step began
  /// start   the guess from there
  void second_way(const IncrementalPotential& W, const Points3& before, const Points3& start,
                  const Gripped& hard, Points3& x, ElasticReport&);

  /// Handles as far as colliders let them go.
  Held reachable(const Sheet&, const Held&, double dt);

  /// Of a step of a sheet from where it is.
  SheetPotential potential(const Sheet&, double dt, std::vector<HandleSpring> springs);
  /// Where the sheet may be at the end of it. feels: it need not jump where handles lag behind
  std::vector<Points3> guesses(const Points3& before, const Gripped& hard, bool feels);

  /// One step; `feels` is null for a sheet that does not feel itself.
  ElasticReport solve(Sheet&, const Held&, const Gripped& hard, double dt, Contact* feels,
                      const NewtonOptions& how, SecondWays second);

  /// By itself, or with self-contact where it turns out that it is needed.
  ElasticReport go(Sheet&, const Held&, const Gripped& hard, double dt);

  /// What colliders and handles say at its end.
  void tell_held(const Points3& x, const std::vector<HandleSpring>& springs, ElasticReport&);

  /// The end of a step that began at `before`: what flowed is kept, and the past is one step
  /// longer.
  void conclude(Sheet&, const Points3& before, const Held&, double dt, ElasticReport&);
};

/// Moves x to the guess of least potential, none of which passes through anything on its way from
/// `before`. throws Error(Fault::simulation) when none is finite
void begin_at_best(const IncrementalPotential& W, const Points3& before,
                   std::vector<Points3>& guesses, Points3& x);

}  // namespace paperbake
