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

/// What a method is told of a sheet whose mesh it may change.
struct RemeshContext {
  // |V| vertices of the first mesh that keep their place on the pattern, and their numbers
  const std::vector<char>& fixed;
  const PlasticGrid* memory;                 // what the paper keeps; null: nothing
  std::vector<int> isolated_moving_handles;  // vertices that lone handles are about to move
  FrameTime now;
  bool moving;  // handles or sheet moved since the frame before
  // the sheet is on its way down from an unstable shape: what it looks like is not to be relied on
  bool snap_in_progress;
  bool at_minimum;        // the last step got to one
  bool yielding;          // the paper yielded in it
  bool rests_on_contact;  // ... and it ended on a collider
  // [1] of the longer side: how far handles are about to go against each other
  double relative_handle_motion;
};

/// All that differs between methods: what the first mesh is, and what happens to the mesh between
/// elastic steps. The elastic solver, handles, time step, tolerances and timers are the same for
/// all and live in `animate`. A method belongs to one sheet of one shot: it may remember.
struct Method {
  std::string name;

  /// Mesh of the pattern in which every point is a vertex. point_vertex[i]: the vertex of
  /// points[i].
  struct FirstMesh {
    Points2 pattern;
    Triangles triangles;
    std::vector<int> point_vertex;
  };
  std::function<FirstMesh(const Pattern&, const std::vector<Vector2d>& points)> first_mesh;

  /// Before the elastic step of a frame: may change the mesh of the sheet as the step before left
  /// it, so that every frame that leaves the loop is a minimum on its own mesh. Empty: nothing
  /// happens.
  /// returns  did the mesh change?
  std::function<bool(Sheet&, const RemeshContext&)> remesh;

  /// Before `remesh`: may propose another mesh, with positions carried over from the old one.
  /// Vertices that are fixed in the first mesh keep their numbers. The loop relaxes the proposal
  /// where the handles were and takes it or not; then `remesh` is left out. Empty: nothing is
  /// proposed.
  std::function<std::optional<Sheet>(const Sheet&, const RemeshContext&)> propose;
  // after every proposal: what became of it
  std::function<void(bool accepted, const FrameTime&)> on_proposal_result;

  /// After the elastic step of a frame, on the copy of the sheet that is handed on: the step that
  /// begins the next frame starts from the equilibrium. Empty: the sheet is handed on as it is.
  std::function<void(Sheet&, const std::vector<int>& held)> finish;

  /// Of the sheet as it is, on its mesh. Empty: the method knows of no parts.
  std::function<BentParts(const Sheet&)> parts;

  /// What it remembers from one frame to the next, after first_mesh. Empty: nothing.
  std::function<void(Serializer&)> archive;
};

/// Standard finite elements: step 1 alone on a fixed mesh of about `triangles` near-equilateral
/// triangles.
/// turn  [rad] of the lattice (pattern_mesh.h), here and below: no result should depend on it
Method fem(int triangles, double turn = 0);

/// The hybrid of [Schreck 2015]: a coarse mesh of about `base_triangles` whose edges follow the
/// rulings and which gets singular points where bending directions conflict, up to
/// options.max_triangles.
/// seed, sheet  what the draws of singular points depend on
Method hybrid(const Pattern&, const Paper&, int base_triangles, const CrumpleOptions&,
              std::uint32_t seed, std::uint32_t sheet, double turn = 0);

/// Adaptive remeshing: edges are split, turned and collapsed until their lengths follow a sizing
/// field (adaptive_mesh/sizing_field.h); step 1 on that mesh. Before every elastic step the sheet
/// as the step before left it is measured and its mesh goes towards the field by one pass, at most
/// twice as fine; the step is the relaxation after it, so that no remeshing shows as a kick. An
/// edge is split where it is longer than 1 and collapsed only to edges shorter than 0.8: a sheet at
/// rest keeps its mesh. Every change costs iterations, so a pass waits until 1 % of the edges are
/// too long, or one by a quarter. A sheet that did not reach its minimum keeps its mesh, and one
/// whose handles are about to jump by more than a tenth of it is coarsened first: a jump is
/// followed in up to 32 steps. Fields that ask for more than `max_triangles` are coarsened as a
/// whole. It begins coarse. What the paper keeps lies on a grid of the pattern (plastic_grid.h)
/// that knows no mesh: rest angles are read from it after every change, and there is nothing to
/// carry from face to face.
/// source  [Narain 2012], [Narain 2013]
Method adaptive(const Pattern&, int max_triangles, const SizingOptions& = {}, double turn = 0);

}  // namespace paperbake
