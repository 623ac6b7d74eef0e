#pragma once

#include "core/animation/sheet_simulation.h"

#include <vector>

namespace paperbake {

/// The elastic step that the sheets of an island take in one frame: one sheet alone, or several
/// that come near each other.
class SheetSimulation::IslandStep {
 public:
  struct Conditions {
    Eigen::MatrixXd dhat;  // as in step_together(); empty for one sheet
    InitialGap gap;
    AdmissibilityOfSheet is_admissible;
    RecordTrajectory trace;
  };
  IslandStep(std::vector<SheetSimulation*> sheets, Conditions);

  /// Takes the parts of the frame one after the other. Before each but the first the methods may
  /// change the meshes, after each but the last a sheet that is alone may fold along a line that
  /// nobody announced. Where colliders jam the sheets, they give way, or the step ends there.
  void take();

 private:
  /// Takes a part, or what is left of it, from where the sheets are now.
  void take_part(int part);
  /// The same, again on the meshes before the last change of mesh if that locks.
  void advance_unlocked(int part);
  void advance(int part);
  /// What jammed sheets can do: fold on finer meshes, and come to rest.
  /// returns  whether the rest of the part is to be tried again
  bool give_way_to_jam();
  /// Lets jammed sheets come to rest where the colliders are now.
  /// returns  whether they are pressed less afterwards
  bool settle();
  DrivenSheet with_initial_positions(SheetSimulation&, DrivenSheet) const;
  SheetSimulation& first() const { return *sheets_.front(); }
  bool is_jammed() const { return first().now_.step.followed < 1; }

  std::vector<SheetSimulation*> sheets_;
  Conditions conditions_;
  int refinements_ = 0;  // of jammed meshes, in this frame
};

}  // namespace paperbake
