#pragma once

#include "core/geometry/collider.h"
#include "core/geometry/pattern_mesh.h"
#include "core/model/fold_line.h"
#include "core/model/frame.h"
#include "core/model/local_energies.h"
#include "core/model/pattern.h"
#include "core/model/plastic_grid.h"
#include "core/model/sheet.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace paperbake {

class Serializer;

/// What a method is told about a sheet whose mesh it may change.
struct RemeshContext {
  explicit RemeshContext(const std::vector<char>& fixed_vertices) : fixed(fixed_vertices) {}

  // |V| vertices of the first mesh, which keep their place on the pattern and their number
  const std::vector<char>& fixed;
  const PlasticGrid* plastic_grid = nullptr;  // plastic curvature of the paper; null: elastic paper
  std::vector<int> isolated_moving_handles;   // vertices that isolated handles are about to move
  FrameTime now;
  bool moving = false;  // handles or sheet moved since the frame before
  // the sheet is snapping through from an unstable shape, so its present shape is not to be trusted
  bool snap_in_progress = false;
  bool at_minimum = false;        // the last step reached a minimum
  bool yielding = false;          // the paper yielded in the last step
  bool rests_on_contact = false;  // the last step ended on a collider or another sheet
  // [1] of the longer side: how far handles are about to move relative to each other
  double relative_handle_motion = 0;
  // [1] of the longer side: how far its points went in the last step, apart from a rigid motion;
  // root mean square
  double deformation = 0;
  // [1] of the longer side: how far colliders are about to squeeze a sheet that no handle holds
  double squeeze = 0;
  // colliders cannot squeeze it any farther, unless a finer mesh lets it fold
  bool jammed = false;
  std::function<LocalEnergies()> local_energies;  // of the sheet as it is
};

/// What a method did to the mesh of a sheet.
enum class MeshChange {
  none,
  local,  // there are vertices or edges that were not there before
  moved,  // vertices have other numbers or other places on the pattern
};

/// Everything in which methods differ: the first mesh, and what happens to the mesh between elastic
/// steps. The elastic solver, handles, time step, tolerances and timers are the same for all and
/// live in `animate`. An object belongs to one sheet in one run of one shot, because it may keep
/// state from frame to frame; what is not overridden does nothing.
class Method {
 public:
  virtual ~Method() = default;

  /// Mesh of the pattern in which every given point is a vertex: points[i] is vertex
  /// point_vertex[i].
  /// Called once, before all others.
  virtual PatternMesh first_mesh(const Pattern&, const std::vector<Vector2d>& points) = 0;

  /// Whether the sheet is crumpled: more than a sheet that is smooth around a few singular points.
  virtual bool is_crumpled(const Sheet&) const { return false; }
  /// Whether lines are looked for along which the sheet is being folded.
  virtual bool finds_folds(const Sheet&) const { return false; }
  /// Lines along which the sheet is being folded although its mesh has no edges there. Called when
  /// its paper has yielded in the last step.
  virtual std::vector<FoldLine> fold_lines(const Sheet&, const PlasticMemory&) const { return {}; }
  /// Lines along which colliders fold the sheet, where they are. Called when some touch it and
  /// there are no fold_lines. memory: of the triangles, to be asked for when it is needed
  virtual std::vector<FoldLine> pressed_lines(const Sheet&, const std::function<PlasticMemory()>&,
                                              const ColliderShapes&) const {
    return {};
  }
  /// Another mesh like the first one, for a pattern that has more creases than it had then: the
  /// sheet is being folded there, or it begins bent there. The points get the numbers that they
  /// have in the first mesh. Nothing if the method cannot take creases up, or no sound mesh has
  /// them.
  /// refinement  how many times as many triangles as the first mesh it has
  virtual std::optional<PatternMesh> mesh_with_creases(const Pattern&,
                                                       const std::vector<Vector2d>& /*points*/,
                                                       int /*refinement*/) const {
    return std::nullopt;
  }

  /// A finer mesh like the first one, with the same points under the same numbers, for a smooth
  /// sheet that is held back by its mesh. Nothing if the method has none, or none that is finer
  /// still.
  virtual std::optional<PatternMesh> finer_mesh() { return std::nullopt; }
  /// How often finer_mesh() has returned one.
  virtual int doublings() const { return 0; }
  /// Whether finer_mesh() would return a mesh.
  virtual bool has_finer_mesh() const { return false; }

  /// Called before `remesh`. May propose another mesh, with positions carried over from the old
  /// one; vertices that are fixed in the first mesh keep their numbers. The loop relaxes the
  /// proposal with the handles where they were and accepts or rejects it (mesh_swap.h). After an
  /// accepted proposal `remesh` is not called.
  virtual std::optional<Sheet> propose(const Sheet&, const RemeshContext&) { return std::nullopt; }
  /// Called after every proposal with its result.
  virtual void on_proposal_result(bool /*accepted*/, const FrameTime&) {}

  /// Called before the elastic step of a frame. May change the mesh of the sheet as the last step
  /// left it; so every frame that is handed on is a minimum on its own mesh.
  virtual MeshChange remesh(Sheet&, const RemeshContext&) { return MeshChange::none; }

  /// Into how many parts of equal length the frame is divided in which handles make this motion
  /// relative to each other, or colliders squeeze the sheet by it [1, of the longer side]. `remesh`
  /// is called before each of them.
  virtual int load_parts(const Sheet&, double /*motion*/) const { return 1; }

  /// Called after the elastic step of a frame, on the copy of the sheet that is handed on; the next
  /// frame starts from the equilibrium itself.
  /// held     vertices that keep their position
  /// returns  whether the copy may have changed
  virtual bool finish(Sheet&, const std::vector<int>& /*held*/) const { return false; }

  /// Rulings and regions of the sheet on its present mesh, if the method has any.
  virtual BentParts parts(const Sheet&) const { return {}; }

  /// Writes or reads the state that is kept from frame to frame, after first_mesh.
  virtual void archive(Serializer&) {}
};

/// The lattice of near-equilateral triangles from which a method cuts its first mesh
/// (pattern_mesh.h).
struct FirstLattice {
  // NOLINTNEXTLINE(google-explicit-constructor): a number of triangles is all that most callers say
  FirstLattice(int triangles, double turn = 0) : triangles(triangles), turn(turn) {}
  int triangles;  // about so many on the whole pattern
  double turn;    // [rad] rotation against the longest side; no result should depend on it
};

/// A method with its settings. Every run makes an object of its own for each sheet, so that a
/// choice can be used for any number of runs, and all give the same frames.
struct MethodChoice {
  std::string name;
  std::function<std::unique_ptr<Method>()> make;
};

}  // namespace paperbake
