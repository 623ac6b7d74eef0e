#pragma once

#include "core/animation/sheet_simulation.h"

#include <memory>
#include <vector>

namespace paperbake {

/// Simulation islands: which sheets of a scene come so close to each other in a frame that they are
/// solved together, and how close they may come.
class SheetsBeside {
 public:
  using Sheets = std::vector<std::unique_ptr<Animation>>;

  /// fresh: the contact distances follow from where the sheets begin (animate_together); resumed:
  /// every SheetSimulation already has its own.
  enum class Begin { anew, as_kept };
  SheetsBeside(Sheets&, Begin);

  /// True if sheet s may go from `here` to `there`, on another mesh or branch: no new intersection
  /// with another sheet, no chance to have passed through one on the way, and no sheet within dhat
  /// comes closer than half its distance.
  /// moved  [m] largest displacement of the sheet
  bool fits(std::size_t s, const Sheet& here, const Sheet& there, double moved) const;

  /// Numbers of the sheets that are solved together; every sheet is in one island.
  using Party = std::vector<std::size_t>;

  /// The islands at the start of a frame: sheets closer than dhat to each other are in one, unless
  /// both of them skip the step.
  std::vector<Party> within_reach() const;

  /// Merges islands whose sheets collide on their trajectories through the frame.
  std::vector<Party> where_ways_meet(const std::vector<Party>&) const;

  /// The elastic step of one island.
  void step(const Party&) const;

  /// Chooses which sheets of an island are handed on: as their methods finish them, or as simulated
  /// where the finished ones would intersect each other more often.
  void show(const Party&) const;

  /// After a frame: gives sheets that have moved apart their contact distance back.
  void part();

 private:
  double between(std::size_t a, std::size_t b) const {
    return sheets_[std::max(a, b)]->reach[std::min(a, b)];
  }
  double whole(std::size_t a, std::size_t b) const;
  double begun(std::size_t a, std::size_t b) const;
  Animation::Begun began(const Party&) const;
  bool meet(std::size_t a, std::size_t b) const;

  Sheets& sheets_;
};

}  // namespace paperbake
