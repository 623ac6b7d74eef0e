#pragma once

#include "core/animation/animate.h"
#include "core/animation/initial_sheet.h"
#include "core/animation/snapshot.h"

#include <optional>
#include <vector>

namespace paperbake {

/// A sheet as it is simulated: on its mesh, with its solver and with what the paper remembers of
/// how it was bent. Whoever changes the mesh does so through a function of this struct, or calls
/// one afterwards, so that all parts stay on one mesh.
struct SimulatedSheet {
  /// number  of the sheet among those of the shot
  SimulatedSheet(const Shot&, InitialSheet&&, const AnimateOptions&, std::size_t number);
  SimulatedSheet(const SimulatedSheet&) = delete;  // the solver points to the plastic grid
  SimulatedSheet& operator=(const SimulatedSheet&) = delete;

  /// Everything needed to take a change of mesh back, too. A sheet in contact with itself may lock
  /// after one: an edge that was flipped or moved across a fold is too short, and the barriers
  /// around it keep it from regaining its length.
  struct MeshSnapshot : Snapshot {
    std::vector<char> fixed;  // as below, and the two after it
    bool has_bends;
    Points3 positions_before;
  };
  MeshSnapshot snapshot() const { return {{sheet, elastic}, fixed, has_bends, positions_before}; }
  void restore(const MeshSnapshot&);

  /// Gives the solver the present mesh, which has the vertices of the mesh before it where they
  /// were, and perhaps others besides.
  void update_solver();
  /// Gives the solver the present mesh, on which vertices may have other places on the pattern, and
  /// carries over what it knows from the mesh before it.
  void carry_over(const Sheet& before);
  /// Puts the sheet onto a mesh that a method made, where all points that are fixed are vertices.
  /// throws  what the change of mesh throws, such as find_hinges(): the sheet and its solver are as
  ///         before then
  void put_on(PatternMesh&&);

  bool has_inertia() const { return elastic.inertia() == Inertia::dynamic; }
  /// Positions of its vertices at the start of the shot, on its present mesh. |V|x3 [m]
  Points3 initial_positions() const;
  /// Without points or lines that the mesh has to keep.
  bool is_smooth() const;

  const Shot& shot;
  const double side;  // [m] longer side of the pattern
  Sheet sheet;
  std::vector<int> handle_vertex;  // as in InitialSheet, and the two after it
  std::vector<char> fixed;
  bool has_bends;
  Elastic elastic;
  std::optional<PlasticGrid> plastic_grid;  // none: paper that always springs back
  Points3 positions_before;  // |V|x3 [m] positions one frame ago; empty before the first frame
};

}  // namespace paperbake
