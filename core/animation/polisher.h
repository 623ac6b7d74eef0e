#pragma once

#include "core/animation/animate.h"
#include "core/animation/initial_sheet.h"
#include "core/render/render_mesh.h"

#include <vector>

namespace paperbake {

/// A frame that was refined to equilibrium on a fine mesh.
struct Polished {
  Sheet sheet;
  // [m] RMS displacement of the vertices from where the given shape has them
  double moved = 0;
  double energy_before = 0, energy = 0;  // [J] stored in the given shape, and at the end
  double membrane_energy = 0;            // [J] the stretching part of `energy`
  int iterations = 0;                    // of Newton's method
  bool converged = true;
  bool near_itself = false;  // parts came near each other; there is no self-contact here
};

/// A handle that holds the sheet in a frame.
struct HeldHandle {
  int handle;   // index in the shot
  Vector3d at;  // [m] where it holds the sheet
};

/// Refines frames to equilibrium. Fine finite elements (step 1 on a fixed mesh) start from a shape
/// that another method found, and end at the nearest minimum, on the branch of that shape. Frames
/// are independent: they may be polished in any order and in parallel, with one object for each
/// thread. A full run of fem takes as long for a frame, but it has to simulate all frames before
/// it, and may be on another branch by then. How far the sheet moves estimates the error of the
/// given shape within its branch.
class Polisher {
 public:
  /// Handle points, the rims of their discs and the points of `features` are vertices of the mesh;
  /// the creases of `features` run along its edges.
  /// triangles  the mesh has about so many, and no more
  Polisher(const Shot&, const ElasticOptions&, int triangles, const RenderFeatures& features = {});

  /// rough         the shape, on any mesh of the pattern; a mesh coarser than this one stands for a
  ///               curved surface (curved_surface.h). Singular points that are vertices of this
  ///               mesh are apices.
  /// held          handles that hold the sheet
  /// plastic_grid  the plastic curvature at that frame; null: elastic paper. Nothing yields.
  Polished operator()(const Sheet& rough, const std::vector<HeldHandle>& held,
                      const PlasticGrid* plastic_grid = nullptr);

  const InitialSheet& mesh() const { return started_; }

  /// Constraints that hold the vertices of these handles, each once, where they hold the sheet.
  PositionConstraints constraints_of(const std::vector<HeldHandle>& held) const;

 private:
  InitialSheet started_;  // with the singular points of the last frame
  // keeps from frame to frame the structure of its matrix and nothing else
  Elastic elastic_;
};

}  // namespace paperbake
