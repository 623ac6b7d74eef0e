#pragma once

#include "core/animation/sheet_simulation.h"

#include <memory>
#include <vector>

namespace paperbake {

/// What is between the sheets of a scene while they are animated: how near they may come, and which
/// of them take a frame together.
class SheetsBeside {
 public:
  using Sheets = std::vector<std::unique_ptr<Animation>>;

  /// Where sheets begin near each other, so near they may be (animate_together); as_kept:
  /// Animation::reach is known.
  enum class Begin { anew, as_kept };
  SheetsBeside(Sheets&, Begin);

  /// May sheet s go there, on another mesh or branch? Not where it would pass through another
  /// sheet, or have passed through it on its way, or where it is less than half as far from it as
  /// it was, within reach.
  bool fits(std::size_t s, const Sheet& here, const Sheet& there, double moved) const;

  /// Sheets that take the frame together, by number; every sheet is in one.
  using Party = std::vector<std::size_t>;

  /// As a frame begins: what is within reach of each other goes together, unless all of it stays.
  std::vector<Party> within_reach() const;

  /// Joins those of which two meet on their ways through the frame.
  std::vector<Party> where_ways_meet(const std::vector<Party>&) const;

  /// The elastic step of one.
  void step(const Party&) const;

  /// The sheets of one as they are handed on: as the methods finish them, or as they were simulated
  /// where they would pass through each other.
  void show(const Party&) const;

  /// After a frame: what parts has its reach back.
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
