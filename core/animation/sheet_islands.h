#pragma once

#include "core/animation/sheet_simulation.h"

#include <memory>
#include <vector>

namespace paperbake {

/// What is between the sheets of a scene while they are animated: how near they may come, and which
/// of them take a frame together.
class SheetIslands {
 public:
  using Sheets = std::vector<std::unique_ptr<SheetSimulation>>;

  /// Where sheets begin near each other, so near they may be (animate_together); resumed:
  /// Animation::reach is known.
  enum class Start { fresh, resumed };
  SheetIslands(Sheets&, Start);

  /// May sheet s go there, on another mesh or branch? Not where it would pass through another
  /// sheet, or have passed through it on its way, or where it is less than half as far from it as
  /// it was, within reach.
  bool is_admissible(std::size_t s, const Sheet& here, const Sheet& there, double moved) const;

  /// Sheets that take the frame together, by number; every sheet is in one.
  using Island = std::vector<std::size_t>;

  /// As a frame begins: what is within reach of each other goes together, unless all of it stays.
  std::vector<Island> build_islands() const;

  /// Joins those of which two meet on their ways through the frame.
  std::vector<Island> merge_colliding(const std::vector<Island>&) const;

  /// The elastic step of one.
  void step(const Island&) const;

  /// The sheets of one as they are handed on: as the methods finish them, or as they were simulated
  /// where they would pass through each other.
  void finalize(const Island&) const;

  /// After a frame: what parts has its reach back.
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
