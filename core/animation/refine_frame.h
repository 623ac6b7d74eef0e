#pragma once

#include "core/animation/animate.h"
#include "core/animation/initial_sheet.h"
#include "core/render/render_mesh.h"

#include <vector>

namespace paperbake {

/// A frame brought to the minimum of a fine mesh.
struct Polished {
  Sheet sheet;
  // [m] root mean square over the vertices, from where they were put
  double moved = 0;
  double energy_before = 0, energy = 0;  // [J] stored: as it was put there, and at the end
  double membrane_energy = 0;            // [J] of that at the end, the stretching part
  int iterations = 0;                    // of Newton's method
  bool converged = true;
  bool near_itself = false;  // parts came near each other, which this does not feel
};

/// Fine finite elements (step 1 on a fixed mesh) that start from a shape which another method
/// found: the minimum near by, on the branch that the shape is on. Every frame stands for itself,
/// so frames may be polished in any order and side by side, by one object each thread; a fem that
/// marches is as fast, but must come all the way, and may be on another branch by then. How far the
/// sheet moves estimates the error of the given shape within its branch (algorithm E2.2).
class Polisher {
 public:
  /// Handle points and the rims of their discs are vertices of the mesh; so are points and creases
  /// of `features`.
  /// triangles  at most, and about so many
  Polisher(const Shot&, const ElasticOptions&, int triangles, const RenderFeatures& features = {});

  /// rough    the shape, on any mesh of the pattern; one coarser than this is taken as the curved
  ///          surface it stands for. Its singular points among the vertices of this mesh are
  ///          apices.
  /// held     handles that hold the sheet, and where they have it [m]
  /// memory   the plastic curvature at that frame; null: elastic paper. Nothing flows.
  Polished operator()(const Sheet& rough, const std::vector<int>& held, const Points3& held_at,
                      const PlasticGrid* memory = nullptr);

  const InitialSheet& mesh() const { return started_; }

  /// The vertices of these handles, each once, at these places.
  PositionConstraints grip(const std::vector<int>& held, const Points3& held_at) const;

 private:
  InitialSheet started_;  // with the apices of the last frame
  // keeps the structure of its matrix from frame to frame, and nothing else
  Elastic elastic_;
};

}  // namespace paperbake
