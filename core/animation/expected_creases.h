#pragma once

#include "core/model/shot.h"

#include <vector>

namespace paperbake {

/// A line along which the handles of a shot are going to fold its sheet.
struct ExpectedCrease {
  PrescribedCrease crease;  // not folded yet

  std::vector<double> turn;  // [rad] and a point between the hands, as in FoldingHands
  Vector2d between;          // [m]

  std::vector<int> plate, other;  // the handles on its two sides
  bool by_row = false;            // the other handles stand in a row
};

/// [rad] The turn of the hands, with its sign, in the frame in which they turn most.
double largest_turn(const ExpectedCrease&);

/// The lines along which the handles of a shot are going to fold its sheet. They are known before
/// the first frame, because all keys are.
///
/// A clamp is a set of at least three absolute handles, not all in one line, whose distances stay
/// those of the pattern for as long as they hold: the paper between them moves as a rigid plate,
/// p -> R p + t. Two clamps whose poses differ by a turn of at least 60 degrees fold the paper
/// where both poses agree,
///
///   (R_a - R_b) p + t_a - t_b = 0,
///
/// if that is a line to within 2 % of the longer side at the frame of the largest turn, with the
/// two clamps on different sides of it and no clamp on both. Handles that are on the line within
/// 0.5 % of the longer side are taken as points of it. Lines end at the border.
///
/// Two or more handles in a row are enough on one side, if they are lifted out of the plane of the
/// clamp on the other: the crease is where their distance from the clamp stays that of the pattern.
///
/// The turn of the hands is known while the flat paper on both sides would meet at the line. Where
/// it would not, the paper is bowed, and nothing presses the crease.
///
/// first_frame  frame of row 0 of Handle::keyed
/// source       this project
std::vector<ExpectedCrease> expected_creases(const Shot&, int first_frame);

/// Adds expected creases to the pattern of the shot, and the hands that fold along them.
void add_expected_creases(Shot&, std::vector<ExpectedCrease>);

}  // namespace paperbake
