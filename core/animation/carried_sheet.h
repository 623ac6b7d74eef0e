#pragma once

#include "core/animation/simulated_sheet.h"

#include <optional>

namespace paperbake {

/// The sheet of the frame before, carried to the mesh of this one: what a change of mesh moves by
/// itself, which is not motion of the paper.
class CarriedSheet {
 public:
  /// Keeps the sheet as it is at the time of the frame before.
  /// at  the input of that frame, with the colliders standing still
  void begin(const Sheet&, const StepInput& at);
  void forget() { sheet_.reset(); }

  /// Carries it to a mesh that the sheet has just been given: without inertia, to equilibrium
  /// there. Leaves no other trace.
  /// start  |V|x3 [m] where it is on the new mesh before that
  /// dt     [s] of a frame
  void carry(SimulatedSheet&, const Method&, const Points3& start, double dt);

  /// Where it is on the mesh that the sheet has now, finished as the method does it. |V|x3 [m];
  /// empty if the sheet has kept its mesh, or if nothing is known
  Points3 positions(const Sheet& now, const Method&) const;

 private:
  std::optional<Sheet> sheet_;
  bool is_carried_ = false;
  StepInput at_;
};

}  // namespace paperbake
