#pragma once

#include "core/model/frame.h"
#include "core/model/handles.h"
#include "core/model/pattern.h"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace paperbake {

/// Two absolute handles that are asked to be farther apart than the paper between them is long, in
/// a straight line or round what is in the way, and the worst frame of the pair.
struct UnreachablePair {
  std::string a, b;
  int frame;        // in which they are too far apart by most
  int first, last;  // in which they are too far apart at all
  double apart;     // [m] at that frame: distance of their keyed positions, or length of the path
  double allowed;   // [m] length of the paper between them
  // a handle of the flat part of the sheet that is in the way; empty: nothing is
  std::string around = {};
  // [m] where the path begins and ends on the pattern, in the parts that the two handles hold
  Vector2d from = Vector2d::Zero(), to = Vector2d::Zero();
};

/// How far apart paper lets handles be.
class HandleFeasibility {
 public:
  /// [1] Paper stretches by this much before anyone sees it: targets that need no more are used as
  /// they are.
  static constexpr double tolerance = 5e-4;
  /// [m] Two handles on one point of the sheet may be this far apart, because their keys come from
  /// 32-bit files.
  static constexpr double rounding = 1e-6;

  /// [m] Handles that are too far apart by less than that are not told.
  static constexpr double unseen = 1e-5;

  /// How far apart two handles may be. [m]
  /// paper  [m] length of paper between them
  static double reach(double paper) { return (1 + tolerance) * paper + rounding; }

  HandleFeasibility(const Pattern&, const std::vector<Handle>&);

  /// Pairs of absolute handles that are held at the same time and too far apart by more than the
  /// tolerance, the worst first.
  /// first_frame  frame of row 0 of Handle::keyed
  /// last_frame   the last frame that is checked
  std::vector<UnreachablePair> impossible_pairs(const std::vector<Handle>&, int first_frame,
                                                int last_frame) const;

  /// Moves the targets of the given handles to the nearest positions, in the least-squares sense,
  /// at which no pair is farther apart than the paper allows.
  /// handles  indices into the handles given to the constructor
  /// targets  |handles|x3 [m]
  /// returns  the largest distance that a target was moved [m]
  double project(const std::vector<int>& handles, Points3& targets) const;

 private:
  double limit(int i, int j) const { return reach(paper_(i, j)); }

  Eigen::MatrixXd paper_;  // [m] length of paper between handles i, j
};

/// A handle that is keyed farther from another one than the paper between them lets them be. Where
/// a relative handle has its key is known only from the frame on in which it takes hold.
struct Overshoot {
  int of_handle = -1;  // the other one; -1: all are near enough
  double length = 0;   // [m] by which they are too far apart
};

/// The largest overshoot of a handle in a frame, over all others that hold.
Overshoot overshoot(const Pattern&, const std::vector<Handle>&, const std::vector<HandleFrame>&,
                    int handle);

}  // namespace paperbake
