#pragma once

#include "core/model/handles.h"
#include "core/model/pattern.h"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace paperbake {

/// Two absolute handles that are asked to be farther apart than paper between them is long: the
/// worst frame of the pair.
struct ImpossiblePair {
  std::string a, b;
  int frame;        // where the overshoot is largest
  int first, last;  // first and last frame with any overshoot
  double apart;     // [m] keyed distance at that frame
  double allowed;   // [m] length of paper between them
};

/// How far paper lets handles be apart.
class HandleFeasibility {
 public:
  /// Paper itself stretches by this much before anyone sees it: what is asked below it is held as
  /// it is.
  static constexpr double tolerance = 5e-4;
  /// So far two handles on one point of the sheet may be apart: their keys come from 32-bit files.
  /// [m]
  static constexpr double rounding = 1e-6;

  HandleFeasibility(const Pattern&, const std::vector<Handle>&);

  /// Absolute handles held at the same time that overshoot by more than the tolerance, by pair.
  /// first_frame: frame of row 0 of Handle::keyed; frames are looked at up to `last_frame`
  std::vector<ImpossiblePair> impossible_pairs(const std::vector<Handle>&, int first_frame,
                                               int last_frame) const;

  /// Moves the targets of the given handles to the nearest places, in the least-square sense, at
  /// which no pair is farther apart than paper allows.
  /// handles  indices into the handles given to the constructor
  /// targets  |handles|x3 [m]
  /// returns  the largest distance that a target was moved [m]
  double project(const std::vector<int>& handles, Points3& targets) const;

 private:
  double limit(int i, int j) const { return (1 + tolerance) * paper_(i, j) + rounding; }

  Eigen::MatrixXd paper_;  // [m] length of paper between handles i, j
};

}  // namespace paperbake
