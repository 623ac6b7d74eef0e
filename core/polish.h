#pragma once

#include "core/animate.h"

#include <vector>

namespace paperbake {

/// A frame brought to the minimum of a fine mesh.
struct Polished {
  Sheet sheet;
  double moved = 0;                          // [m] root mean square over the vertices, from where they were put
  double energy_before = 0, energy = 0;      // [J] stored: as it was put there, and at the end
  bool converged = true;
  bool near_itself = false;                  // parts came near each other, which this does not feel
};

/// Fine finite elements (step 1 on a fixed mesh) that start from a shape which another method found: the minimum near by, on the
/// branch that the shape is on. Every frame stands for itself, so frames may be polished in any order and side by side, by one
/// object each; a fem that marches is as fast, but must come all the way, and may be on another branch by then.
/// How far the sheet moves estimates the error of the given shape within its branch (algorithm E2.2).
class Polisher {
 public:
  /// Handle points, the rims of their discs and `points` are vertices of the mesh.
  Polisher(const Shot&, const ElasticOptions&, int triangles, const std::vector<Vector2d>& points = {});

  /// rough    the shape, on any mesh of the pattern; one coarser than this is taken as the curved surface it stands for
  /// held     handles that hold the sheet, and where they have it [m]
  /// memory   the plastic curvature at that frame; null: elastic paper. Nothing flows.
  Polished operator()(const Sheet& rough, const std::vector<int>& held, const Points3& held_at, const PlasticGrid* memory = nullptr) const;

  const StartedSheet& mesh() const { return started_; }

  /// The vertices of these handles, each once, at these places.
  Held grip(const std::vector<int>& held, const Points3& held_at) const;

 private:
  Paper paper_;
  ElasticOptions options_;
  StartedSheet started_;
};

}  // namespace paperbake
