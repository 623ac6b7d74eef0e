#pragma once

#include "core/animation/sheet_simulation.h"

#include <memory>
#include <vector>

namespace paperbake {

/// Simulation islands: which sheets of a scene come so close to each other in a frame that they are
/// solved together, and how close they may come.
class SheetIslands {
 public:
  using Sheets = std::vector<std::unique_ptr<SheetSimulation>>;

  /// fresh: the contact distances follow from where the sheets begin (animate_together); resumed:
  /// every SheetSimulation already has its own.
  enum class Start { fresh, resumed };
  SheetIslands(Sheets&, Start);

  /// True if sheet s may go from `here` to `there`, on another mesh or branch: no new intersection
  /// with another sheet, no chance to have passed through one on the way, and no sheet within dhat
  /// comes closer than half its distance.
  /// moved  [m] largest displacement of the sheet
  bool is_admissible(std::size_t s, const Sheet& here, const Sheet& there, double moved) const;

  /// Numbers of the sheets that are solved together; every sheet is in one island.
  using Island = std::vector<std::size_t>;

  /// The islands at the start of a frame: sheets closer than dhat to each other are in one, unless
  /// both of them skip the step.
  std::vector<Island> build_islands() const;

  /// Merges islands whose sheets collide on their trajectories through the frame.
  std::vector<Island> merge_colliding(const std::vector<Island>&) const;

  /// The elastic step of one island.
  void step(const Island&) const;

  /// Chooses which sheets of an island are handed on: as their methods finish them, or as simulated
  /// where the finished ones would intersect each other more often.
  void finalize(const Island&) const;

  /// After a frame: gives sheets that have moved apart their contact distance back.
  void restore_contact_distances();

 private:
  double dhat_between(std::size_t a, std::size_t b) const {
    return sheets_[std::max(a, b)]->dhat[std::min(a, b)];
  }
  double full_dhat(std::size_t a, std::size_t b) const;
  double initial_dhat(std::size_t a, std::size_t b) const;
  SheetSimulation::InitialGap initial_gap(const Island&) const;
  bool collide(std::size_t a, std::size_t b) const;

  Sheets& sheets_;
};

}  // namespace paperbake
