#pragma once

#include "core/methods/adaptive_mesh/sizing_field.h"
#include "core/model/frame.h"
#include "core/model/paper.h"
#include "core/model/pattern.h"
#include "core/model/plastic_grid.h"
#include "core/model/sheet.h"
#include "core/step2_crumple/crumple.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace paperbake {

/// What a method is told about a sheet whose mesh it may change.
struct RemeshContext {
  // |V| vertices of the first mesh, which keep their place on the pattern and their number
  const std::vector<char>& fixed;
  const PlasticGrid* memory;                 // plastic curvature of the paper; null: elastic paper
  std::vector<int> isolated_moving_handles;  // vertices that isolated handles are about to move
  FrameTime now;
  bool moving;  // handles or sheet moved since the frame before
  // the sheet is snapping through from an unstable shape, so its present shape is not to be trusted
  bool snap_in_progress;
  bool at_minimum;        // the last step reached a minimum
  bool yielding;          // the paper yielded in the last step
  bool rests_on_contact;  // the last step ended on a collider or another sheet
  // [1] of the longer side: how far handles are about to move relative to each other
  double relative_handle_motion;
};

/// Everything in which methods differ: the first mesh, and what happens to the mesh between elastic
/// steps. The elastic solver, handles, time step, tolerances and timers are the same for all and
/// live in `animate`. A method belongs to one sheet of one shot, because it may keep state.
struct Method {
  std::string name;

  /// Mesh of the pattern in which every given point is a vertex: points[i] is vertex
  /// point_vertex[i].
  struct FirstMesh {
    Points2 pattern;
    Triangles triangles;
    std::vector<int> point_vertex;
  };
  std::function<FirstMesh(const Pattern&, const std::vector<Vector2d>& points)> first_mesh;

  /// Called before the elastic step of a frame. May change the mesh of the sheet as the last step
  /// left it; so every frame that is handed on is a minimum on its own mesh. Empty: the mesh stays.
  /// returns  whether the mesh changed
  std::function<bool(Sheet&, const RemeshContext&)> remesh;

  /// Called before `remesh`. May propose another mesh, with positions carried over from the old
  /// one; vertices that are fixed in the first mesh keep their numbers. The loop relaxes the
  /// proposal with the handles where they were and accepts or rejects it (mesh_swap.h). After an
  /// accepted proposal `remesh` is not called. Empty: nothing is proposed.
  std::function<std::optional<Sheet>(const Sheet&, const RemeshContext&)> propose;
  // called after every proposal with its result
  std::function<void(bool accepted, const FrameTime&)> on_proposal_result;

  /// Called after the elastic step of a frame, on the copy of the sheet that is handed on; the next
  /// frame starts from the equilibrium itself. Empty: the sheet is handed on as it is.
  std::function<void(Sheet&, const std::vector<int>& held)> finish;

  /// Rulings and regions of the sheet on its present mesh. Empty: the method has none.
  std::function<BentParts(const Sheet&)> parts;

  /// Writes or reads the state that is kept from frame to frame, after first_mesh. Empty: there is
  /// none.
  std::function<void(Serializer&)> archive;
};

/// Standard finite elements: step 1 alone on a fixed mesh of about `triangles` near-equilateral
/// triangles.
/// turn  [rad] rotation of the lattice (pattern_mesh.h), here and below: no result should depend on
///       it
Method fem(int triangles, double turn = 0);

/// The hybrid of [Schreck 2015]: a coarse mesh of about `base_triangles` whose edges follow the
/// rulings and which gets singular points where bending directions conflict, up to
/// options.max_triangles.
/// seed, sheet  what the random draws of singular points depend on
Method hybrid(const Pattern&, const Paper&, int base_triangles, const CrumpleOptions&,
              std::uint32_t seed, std::uint32_t sheet, double turn = 0);

/// Adaptive remeshing: step 1 on a mesh whose edges are split, flipped and collapsed until their
/// lengths follow a sizing field (adaptive_mesh/sizing_field.h). Before every elastic step the
/// sheet is measured as the last step left it, and one pass brings its mesh closer to the field, at
/// most twice as fine; the elastic step then relaxes the sheet, so that remeshing does not show as
/// a jump. The first mesh is coarse.
///
/// An edge is split where its metric length is above 1, and collapsed only if that gives edges
/// shorter than 0.8: a sheet at rest keeps its mesh. Every change costs iterations, so a pass waits
/// until 1 % of the edges are too long, or one of them by a quarter. A sheet that did not reach its
/// minimum keeps its mesh. One whose handles are about to jump by more than a tenth of its longer
/// side is coarsened first, because a jump is followed in up to 32 steps. Fields that ask for more
/// than `max_triangles` are coarsened as a whole.
///
/// The plastic curvature lies on a grid of the pattern that is independent of the mesh
/// (plastic_grid.h): rest angles are read from it after every change, and nothing has to be carried
/// from face to face.
/// source  [Narain 2012], [Narain 2013]
Method adaptive(const Pattern&, int max_triangles, const SizingOptions& = {}, double turn = 0);

}  // namespace paperbake
