#pragma once

#include "core/geometry/collider_motion.h"
#include "core/model/air.h"
#include "core/model/local_energies.h"
#include "core/model/paper.h"
#include "core/model/plastic_grid.h"
#include "core/model/sheet.h"
#include "core/step1_elastic/collider_clearance.h"
#include "core/step1_elastic/contact/collider_distances.h"
#include "core/step1_elastic/contact/friction_history.h"
#include "core/step1_elastic/energies/external_forces.h"
#include "core/step1_elastic/energies/handle_springs.h"
#include "core/step1_elastic/energies/ridge_yield.h"
#include "core/step1_elastic/energy_not_finite.h"
#include "core/step1_elastic/position_constraints.h"

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace paperbake {

enum class Inertia { quasi_static, dynamic };
// automatic: self-contact is used in the steps in which the sheet comes near itself
enum class SelfContact { automatic, off };

/// Options of the elastic solver.
struct ElasticOptions {
  // [m] Newton's method stops when every vertex is estimated to be within this distance of the
  // minimum
  double stop = 1e-5;
  int max_iterations = 60;  // [1] an unfinished minimisation continues in the next step
  ExternalForces forces;
  Air air;  // slows a sheet with inertia, and carries it along (air_drag.h)
  Inertia inertia = Inertia::quasi_static;
  // [1/s] c of a drag -c m (v - v_r) on each vertex of a sheet with inertia, where v_r is the rigid
  // motion that is nearest to its own and goes with the held vertices. 2 w damps an oscillation of
  // rate w critically.
  double damping = 0;
  SelfContact contact = SelfContact::automatic;
  // obstacles that the sheet must not pass through; null: there are none
  std::shared_ptr<const Colliders> colliders = nullptr;
  int sheet_number = 0;  // among the sheets of the shot, by which contacts remember each other
};

/// What moves the sheet in a step.
struct StepInput {
  PositionConstraints constraints;  // at the end of the step
  ColliderMotion colliders = {};
  double time = 0;  // [s] at the end of the step, since the first frame
  // [1] share of the way to the angles that hands press creases to, which this step goes
  double pressing = 1;
};

/// What a step did, and the energies and contacts of the sheet at its end.
struct ElasticReport {
  int iterations = 0;  // number of Newton iterations
  bool converged = true;
  double energy = 0;             // [J] membrane + bending
  double potential = 0;          // [J] energy + potential of the external forces
  double membrane = 0;           // [J] membrane part of the energy
  double plastic_increment = 0;  // [m rad] growth of PlasticGrid::integral() in this step
  // a snap-through is in progress: the sheet is on its way down from an unstable shape, and the
  // shape it has now is not to be relied on
  bool snap_in_progress = false;
  // [1] how much lower the potential of the second branch is, relative to the first; 0 if it was
  // not taken
  double energy_gain = 0;
  bool contact = false;  // the sheet came near itself: the step was solved with self-contact
  // active contacts at the end of the step: pairs of a vertex and a triangle, or of two edges, that
  // push each other
  int touching = 0;
  int touching_others = 0;  // the same for pairs with one feature on another sheet
  int giving_way = 0;       // hard handles that the paper does not follow
  int on_colliders = 0;  // vertices, edges and triangles that colliders push at the end of the step
  double inside = 0;     // [m] depth of the deepest point inside a collider

  double membrane_share() const { return energy > 0 ? membrane / energy : 0; }  // [1]
  /// Active contacts, or handles that give way to what the sheet touches. They hold again as soon
  /// as nothing is in their way.
  bool has_contact() const {
    return touching > 0 || (giving_way > 0 && on_colliders + touching_others > 0);
  }
};

/// How far relax() goes.
/// coarse  only mixed Newton (newton.h), to ten times `stop`. It gives up after 20 iterations, or
///         when a vertex has moved more than 3 % of the longer side: the shape then belongs to
///         another branch.
/// softened_first
///         coarse, twice: first with the softened membrane, whose energy has few valleys, so that
///         the sheet loses dents in which a coarse mesh has held it
/// full    both variants of Newton's method, to `stop`
enum class Relaxation { coarse, softened_first, full };

/// A descent along a second branch from an unstable shape, computed beside the main solution: first
/// with a softened membrane, then with the true stiffness of the membrane. A sheet that is locked
/// while it rests on a collider is lifted meanwhile: its weight is what keeps its middle down, so
/// in the first phase it pulls the other way.
struct BranchDescent {
  Points3 x;  // |V|x3 [m] where it has got to
  enum Phase { softened, true_stiffness, finished } phase = softened;
  int tries = 0;  // in this phase that did not converge
  bool converged = false;
  bool is_lifted = false;
};

/// What the solver knows from earlier steps: everything that a step changes besides its sheet.
struct SolverState {
  // |V|x3 [m] before the last step, then before the step preceding it
  std::deque<Points3> positions;
  int steps = 0;         // number of steps so far
  bool remeshed = true;  // the mesh has changed since the last step
  // the last step ended with ElasticReport::has_contact()
  bool had_contact = false;
  // index of the step before which no new search for a second branch begins
  int branch_cooldown_until = 0;
  // [J] energy with which a locked sheet last searched; 0: it is not locked (solver_limits.h)
  double locked_energy = 0;
  bool descending = false;              // line-search Newton was still on its way down to a minimum
  std::optional<BranchDescent> second;  // a descent that is not finished yet
  FrictionHistory friction;             // of contacts at the end of the last step
  RidgeField ridges;                    // filled in only by state(): the ridges of the last step
  // filled in only by state(): the plastic grid; none: the paper has never yielded
  std::optional<PlasticGrid> grid;
};
void archive(Serializer&, SolverState&);  // all but the grid, which belongs to the sheet

struct JointStepSheet;
struct SweptSheet;

/// Step 1 of [Schreck 2015]: the elastic deformation of the sheet while handles move.
///
/// A step minimises the incremental potential of backward Euler over the free vertices:
///
///   W(x) = sum_i m_i (|x_i - xhat_i|^2/(2 dt^2) + phi(x_i)) + E_membrane(x) + E_bending(x)
///
/// phi           potential of the external forces per unit of mass (external_forces.h)
///
/// dynamic:       xhat = x + dt v, and m is the mass of the paper
/// quasi-static:  xhat = x, and m is a hundredth of the mass: just enough to make the answer unique
///                for a sheet that can swing freely
///
/// The minimum is found by Newton's method with the constrained vertices eliminated. There are two
/// variants (newton.h); the second is used where the first does not converge:
/// - mixed Newton, with the stress of the membrane as an unknown of its own [Magisano 2017]: it
///   takes 2-4 iterations where plain Newton takes 3-15, because the stiff membrane does not
///   confine it to tiny steps;
/// - line-search Newton, with the exact Hessian (projected where it is not positive definite) and a
///   backtracking line search.
/// A step that takes many iterations is leaving an unstable shape (a snap-through), and a smooth
/// sheet that stores a sixth of its energy by stretching is locked in waves that paper would leave.
/// Such a step is solved a second time, starting with a softened membrane, and the lower of the two
/// minima is kept.
///
/// With a plastic grid, E_bending yields within the step (bending.h), and the plastic increment at
/// its end is written to the grid.
///
/// A step that brings parts of the sheet near each other is solved with self-contact
/// (sheet_contact.h): the barrier is part of W, no iteration passes through anything, and handles
/// pull with springs that give way where the paper is jammed (handle_springs.h). No second branch
/// is searched in such a step. A step in which nothing comes near gives the same result to the last
/// bit as without contact.
///
/// Colliders (collider_contact.h), if there are any, are part of W in every step. Handles whose
/// targets lie behind the surface of a collider slide along it.
///
/// In air, air_drag.h adds its drag to W. In a vacuum, the velocity is damped by the factor
/// velocity_kept (air.h) per 1/24 s instead.
///
/// source [Martin 2011]
class Elastic {
 public:
  Elastic(const Paper&, const ElasticOptions&);
  ~Elastic();
  Elastic(Elastic&&);
  Elastic& operator=(Elastic&&);

  const Paper& paper() const;

  /// Whether steps from now on have inertia, and with which damping, as in ElasticOptions; at
  /// first, what the options say.
  void set_inertia(Inertia, double damping = 0);
  Inertia inertia() const;

  /// To be called for the first mesh and after every change of the pattern or the connectivity. As
  /// long as the number of vertices stays the same, the past positions that the next initial guess
  /// is made from are kept.
  /// stiffening  |T| factors on the bending stiffness; empty: 1 everywhere
  void set_mesh(const Sheet&, const std::vector<double>& stiffening = {});

  /// Moves sheet.x to the minimum with the constrained vertices at their targets, and sets sheet.v
  /// to (x_new - x_old)/dt. The positions need not be near the minimum.
  /// On meshes of at most 400 triangles a snap-through may span several frames. After the first
  /// three steps a step ends after at most 42 iterations, or 82 as long as an edge is stretched by
  /// more than 0.6 %; the descents on both branches continue in the next step.
  /// throws EnergyNotFinite
  ElasticReport step(Sheet&, const StepInput&, double dt);

  /// The constraints half way from where the sheet is to their targets. Those that hold a panel of
  /// a folded sheet go there on arcs (panel_motion.h), and so do all if they carry it as one body.
  PositionConstraints half_way(const Sheet&, const PositionConstraints&) const;

  /// One step of several sheets that come closer than dhat to each other. It minimises the sum of
  /// their potentials over the vertices of all of them, with one contact between and within the
  /// sheets, so that a push is passed on to the last of them. All handles pull with springs.
  /// dhat    |sheets|x|sheets| [m] dhat between two sheets; on the diagonal dhat() of each
  /// throws  EnergyNotFinite
  static std::vector<ElasticReport> step_together(const std::vector<JointStepSheet>&,
                                                  const Eigen::MatrixXd& dhat, double dt);

  /// [m] dhat of the sheet (sheet_contact.h); 0 if self-contact is off.
  double dhat() const;

  /// True if the two sheets do not collide along their trajectories, and no pair of features is
  /// closer than dhat at the end of any segment of these: a joint step would then have taken the
  /// sheets to the same places.
  static bool are_collision_free(const SweptSheet& a, const SweptSheet& b, double dhat);

  /// Moves sheet.x to a nearby minimum with the constrained vertices at their targets, and does
  /// nothing else: no second branch is searched, sheet.v does not change, and no plastic increment
  /// is written. This is for a sheet that was placed where it is, not moved there. report.contact:
  /// the sheet came near itself; relaxation does not prevent that.
  ElasticReport relax(Sheet&, const StepInput&, double dt, Relaxation);

  /// Another solver for the same paper, options and plastic grid, on another mesh.
  Elastic on_mesh(const Sheet&, const std::vector<double>& stiffening = {}) const;

  /// Takes over what a solver on another mesh knows of earlier steps: the past positions, the
  /// number of steps and an unfinished descent on a second branch.
  /// carried  maps |V|x3 positions of the other mesh to this one
  void continue_from(const Elastic& other, const std::function<Points3(const Points3&)>& carried);

  /// Energies stored in the sheet as it is, whose creases are read. `iterations` is 0.
  ElasticReport evaluate_energies(const Sheet&);

  /// The same by triangle, with the configurational forces on the vertices.
  LocalEnergies local_energies(const Sheet&);

  /// [m] Depth of the deepest vertex, edge or triangle of a sheet on this mesh inside a collider; 0
  /// if none is inside.
  double inside(const Sheet&, const ColliderShapes&) const;
  /// The same for a sheet on another mesh.
  double inside_on_mesh_of(const Sheet&, const ColliderShapes&) const;
  /// Pushes a sheet out of colliders into which edges and triangles of its mesh cut, because those
  /// of the mesh that it was on before went round them elsewhere. Its vertices are outside.
  /// held     vertices that stay
  /// returns  whether it is outside then, but for give_way_depth
  bool leave_colliders(Sheet&, const ColliderShapes&, const PositionConstraints& held) const;

  /// A copy of the state, including the plastic grid, and the rollback to such a copy. As long as
  /// the mesh is the same, the steps in between leave no trace.
  SolverState state() const;
  void restore(const SolverState&);

  /// Lets the paper yield. The grid is read here and by set_mesh, and every step that returns
  /// writes to it. Call this again when something else has changed the grid. The grid must outlive
  /// this object and those made from it by on_mesh, unless they are given another one. Null, as in
  /// the beginning: paper that always springs back.
  void set_plastic_grid(PlasticGrid*);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// One of the sheets that take a step together.
struct JointStepSheet {
  Elastic& elastic;
  Sheet& sheet;
  const StepInput& input;
  // |V|x3 [m] positions of its vertices at the beginning of the shot, if one of the sheets began on
  // another one; else empty for all sheets
  const Points3& initial_positions;
};

/// The trajectory of a sheet.
struct SweptSheet {
  const Sheet& sheet;                      // its mesh
  const PositionConstraints& constraints;  // at the end
  // |V|x3 [m] positions with straight motion in between, at the same times as those of the other
  // sheet
  const std::vector<Points3>& places;
  const Points3& initial_positions;  // as in JointStepSheet
};

}  // namespace paperbake
