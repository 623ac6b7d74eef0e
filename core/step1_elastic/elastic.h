#pragma once

#include "core/geometry/collider.h"
#include "core/model/paper.h"
#include "core/model/plastic_grid.h"
#include "core/model/sheet.h"
#include "core/step1_elastic/energies/ridge_yield.h"

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace paperbake {

enum class Inertia { quasi_static, dynamic };
// automatic: in the steps in which the sheet comes near itself
enum class SelfContact { automatic, off };

struct ElasticOptions {
  // [m]    Newton ends when no vertex is farther than this from the minimum, as far as it can tell
  double stop = 1e-5;
  int max_iterations = 60;  // [1]    an unfinished minimisation goes on in the next step
  double gravity = 0;       // [m/s2] along -z
  Inertia inertia = Inertia::quasi_static;
  SelfContact contact = SelfContact::automatic;
  // what the sheet may not pass; null: nothing
  std::shared_ptr<const Colliders> colliders = nullptr;
};

/// Where colliders are as a step begins and ends. Empty where there are none.
struct ColliderMotion {
  Poses from, to;
};

/// Vertices that are held, and where; and what else is given of a step.
struct PositionConstraints {
  std::vector<int> vertices;  // each at most once
  Points3 targets;            // |vertices|x3 [m]
  // |vertices| [N/m] of soft handles, 0: hard; empty: all are hard
  std::vector<double> stiffness = {};
  ColliderMotion colliders = {};
};

struct ElasticReport {
  int iterations = 0;  // factorisations of the second derivative
  bool converged = true;
  double energy = 0;             // [J] membrane + bending
  double potential = 0;          // [J] energy + weight x height
  double membrane = 0;           // [J] its membrane part
  double plastic_increment = 0;  // [m rad] by how much the plastic integral grew in this step
  // it is on its way down from an unstable shape: what it looks like is not to be relied on
  bool snap_in_progress = false;
  // [1] by how much of the potential a second start was lower, when it was taken
  double energy_gain = 0;
  bool contact = false;  // the sheet came near itself: the step was taken with contact
  // pairs of vertex and triangle, or edge and edge, that push each other at its end
  int touching = 0;
  int touching_others = 0;  // ... of which one is of another sheet
  int yielding = 0;         // hard handles that the paper does not follow
  int on_colliders = 0;     // vertices, edges and triangles that colliders push at its end
  double inside = 0;        // [m] how deep the deepest is inside a collider
};

/// briefly: the first way alone, to ten times `stop`, 20 iterations; what needs more has landed
/// somewhere else, and so has what leaves its place by 3 % of the longer side. fully: both ways, to
/// `stop`.
enum class Relaxation { coarse, full };

/// A second way down from an unstable shape, gone beside the first: with a softened membrane, then
/// with the paper's own.
struct BranchDescent {
  Points3 x;  // |V|x3 [m] how far it got
  enum Phase { softened_phase, true_stiffness, finished } phase = softened_phase;
  int attempts = 0;  // of this leg, that got nowhere near its end
  bool converged = false;
};

/// What the solver knows of the steps before, and all that a step changes besides its sheet.
struct SolverState {
  std::deque<Points3> positions;  // |V|x3 [m] before the last step, before the one before that
  int steps = 0;                  // so far
  bool remeshed = true;           // the mesh has changed since the last step
  // the last step ended with parts touching, or with handles that the paper does not follow
  bool had_contact = false;
  // steps: a second way found nothing much lower, none is begun before
  int branch_cooldown_until = 0;
  bool descending = false;              // ... on its way down to a minimum
  std::optional<BranchDescent> second;  // not yet at its end
  RidgeField ridges;                    // in a copy: of the last step, and
  std::optional<PlasticGrid> grid;      // the plastic memory; none: nothing had flowed
};
void archive(Serializer&, SolverState&);  // all but the grid, which is the sheet's
void archive(Serializer&, PositionConstraints&);

struct JointStepSheet;
struct SweptSheet;

/// Step 1 of [Schreck 2015]: the elastic deformation of the sheet while handles move.
///
/// A step is the minimum over the free vertices of the incremental potential of backward Euler
///
///   W(x) = sum_i m_i/(2 dt^2) |x_i - xhat_i|^2 + E_membrane(x) + E_bending(x) + sum_i m_i g z_i
///
/// dynamic:      xhat = x + dt v, m the mass of the paper
/// quasi-static: xhat = x and a hundredth of the mass: just enough that a sheet that swings freely
/// has one answer
///
/// found by Newton's method with handles eliminated. Two ways, one after the other where the first
/// does not arrive: - the stress of the membrane as an unknown of its own [Magisano 2017]: 2-4
/// iterations where plain Newton takes 3-15, because
///   the stiff membrane does not hold it to tiny steps;
/// - the exact second derivative (projected where that is not positive definite) with a
/// backtracking line search. A step that takes many iterations leaves an unstable shape (a snap):
/// it is started a second time with a softened membrane, and the lower end is kept.
///
/// With a memory, E_bending yields inside the step (bending.h), and what has flowed at its end is
/// remembered. A step that brings parts of the sheet near each other is taken with self-contact
/// (self_contact.h): the barrier is part of W, no iteration passes through anything, and handles
/// pull with springs that give way where the paper is jammed (handle_springs.h); it has no second
/// start. A step in which nothing comes near is the same to the last bit as without contact.
/// Colliders (collider_contact.h), where there are any, are part of W in every step. Handles that
/// are to go behind their surface slide along it.
///
/// source [Martin 2011]; damping of the velocity to 0.98 in 1/24 s
class Elastic {
 public:
  Elastic(const Paper&, const ElasticOptions&);
  ~Elastic();
  Elastic(Elastic&&);
  Elastic& operator=(Elastic&&);

  /// To be called for the first mesh and after every change of pattern or connectivity. As long as
  /// the number of vertices stays, so does what the next guess knows of their past positions.
  /// stiffening  |T| factors on the bending stiffness; empty: 1 everywhere
  void set_mesh(const Sheet&, const std::vector<double>& stiffening = {});

  /// Moves sheet.x to the minimum with the held vertices at their targets, and sheet.v to (x_new -
  /// x_old)/dt. The positions need not be near the minimum. On a coarse mesh (400 triangles) no
  /// frame waits for a snap: after the first three a step ends with 42 iterations, or 82 where an
  /// edge is still stretched by .6 %, and both its ways down go on in the next one. throws
  /// Error(Fault::simulation) when the energy is not finite.
  ElasticReport step(Sheet&, const PositionConstraints&, double dt);

  /// One step of several sheets that come within reach of each other: to the minimum of the sum of
  /// their potentials over the vertices of all, with one contact between and within them, so that a
  /// push goes through to the last of them. All handles pull with springs.
  /// reach  |sheets|x|sheets| [m] d^ between two, on the diagonal reach() of each
  /// throws Error(Fault::simulation) when the energy is not finite
  static std::vector<ElasticReport> step_together(const std::vector<JointStepSheet>&,
                                                  const Eigen::MatrixXd& dhat, double dt);

  /// d^ of the sheet (self_contact.h); 0: it feels nothing. [m]
  double dhat() const;

  /// True when nothing of one meets the other on their ways, and no pair is within reach at the end
  /// of any part of them: then a step together would have taken them there, too.
  static bool clear(const SweptSheet& a, const SweptSheet& b, double dhat);

  /// Moves sheet.x to the minimum near by with the held vertices at their targets, and nothing
  /// else: no second start, no change of sheet.v, nothing flows and nothing is remembered. For a
  /// sheet that was put where it is. report.contact: it came near itself, which a sheet that
  /// settles does not feel.
  ElasticReport relax(Sheet&, const PositionConstraints&, double dt, Relaxation);

  /// Another one, of the same paper, options and memory.
  Elastic on_mesh(const Sheet&, const std::vector<double>& stiffening = {}) const;

  /// Takes over what another one, on another mesh, knows of past positions.
  /// carried  maps |V|x3 of the other mesh to this one
  void continue_from(const Elastic& other, const std::function<Points3(const Points3&)>& carried);

  /// What is stored in the sheet as it is. `iterations` 0.
  ElasticReport evaluate_energies(const Sheet&) const;

  /// How deep the deepest vertex, edge or triangle of a sheet of this mesh is inside a collider; 0:
  /// none. [m]
  double inside(const Sheet&, const Poses&) const;

  /// A copy, the plastic grid with it, and the way back to it while the mesh is the same: the steps
  /// in between leave no trace.
  SolverState state() const;
  void restore(const SolverState&);

  /// Lets the paper yield: the memory is read here and by set_mesh, and every step that returns
  /// writes to it. To be called again when the grid was changed by others. It must outlive this
  /// object or its replacement. Null, as at first: paper that springs back whatever is done to it.
  void set_plastic_grid(PlasticGrid*);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A sheet that takes a step with others.
struct JointStepSheet {
  Elastic& elastic;
  Sheet& sheet;
  const PositionConstraints& held;
  // |V|x3 [m] where its points were at the begin of the shot, when one of the sheets began on
  // another; or empty, of all
  const Points3& begun;
};

/// Where a sheet went.
struct SweptSheet {
  const Sheet& sheet;               // its mesh
  const PositionConstraints& held;  // at the end
  // |V|x3 [m], straight ways in between; the other's at the same times
  const std::vector<Points3>& places;
  const Points3& begun;  // as in Together
};

}  // namespace paperbake
