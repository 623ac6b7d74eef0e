#pragma once

#include "core/model/shot.h"

#include <vector>

namespace paperbake {

/// The part of a line beyond its crossing with another one, where paper that no hand holds has to
/// turn in some other way than between the hands.
struct TurnBeyond {
  int line, across;          // indices into the expected creases
  std::vector<double> turn;  // |F| [rad] not a number where the line goes straight on
  Vector2d at{0, 0};         // [m] a point of this part
};

/// A line along which the handles of a shot are going to fold its sheet.
struct ExpectedCrease {
  enum class By {
    two_plates,       // two clamps turn against each other
    plate_and_row,    // handles in a row turn against a clamp
    folds_that_cross  // a gusset crease: paper beyond their crossing folds once more (gussets.h)
  };

  Segment2 line;  // [m] from border to border
  // [m] its parts along which the artist has drawn creases, and those where there is none: the
  // sheet gets a crease there, which is not folded yet
  std::vector<Segment2> drawn, missing;
  std::vector<int> creases;  // those that are drawn: indices into Pattern::prescribed_creases
  By by = By::two_plates;

  std::vector<double> turn;   // [rad] and a point between the hands, as in FoldingHands
  Vector2d between{0, 0};     // [m]
  TurnBeyond beyond[2] = {};  // of a gusset crease: of the two lines that cross

  std::vector<int> plate, other;  // the handles on its two sides
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
/// two clamps on different sides of it and no clamp on both that holds while it is folded, and no
/// other line between one of them and it. Handles that are on the line within 0.5 % of the longer
/// side, those of the two clamps within 0.03 %, are taken as points of it. Lines end at the border,
/// and those that end within 0.5 % of each other at one point.
///
/// Plates whose handles keep their distances for the first part of a shot only fold the paper in
/// that part. For each row in which two handles part, the latest first, lines are looked for as if
/// all handles let go then; they count where one of the two plates has no handle of hands that are
/// known by then.
///
/// Other clamps that fold along the same line add their turn in the frames in which the first ones
/// do not hold.
///
/// Two or more handles in a row are enough on one side, if they are lifted out of the plane of the
/// clamp on the other: the crease is where their distance from the clamp stays that of the pattern.
///
/// The turn of the hands is known while the flat paper on both sides would meet at the line. Where
/// it would not, the paper is bowed, and nothing presses the crease. Hands fold only if it is known
/// in three quarters of the frames on the way to the largest turn, from 20 degrees on; others carry
/// the paper along a curve, and bend it or roll it up.
///
/// Of a line that holes or slits divide, hands do not fold the parts at which the sheet begins
/// folded otherwise than they are turned in the first frame: by more than 5 degrees, where they are
/// turned by as much.
///
/// Where two lines cross that hands fold at once, there is a gusset crease (gussets.h).
///
/// Creases that the artist has drawn along a line, to within 1 % of the longer side, are what hands
/// fold there. They are moved onto the line (drawn_creases): a fold beside it would ask for paper
/// that is not there. Where two are drawn beside each other, as on both sides of the spine of a
/// book, hands that turn about one and then about the other agree on a line between them in the
/// end, but fold the paper along neither that line nor any other alone: there is none then, and the
/// creases stay where they are drawn.
///
/// Relative handles count as the absolute ones that they are while the sheet lies as it began
/// (known_handles.h).
///
/// first_frame  frame of row 0 of Handle::keyed
/// source       this project
std::vector<ExpectedCrease> expected_creases(const Shot&, int first_frame);

/// The creases that the artist has drawn. Those along which hands fold the sheet are moved onto
/// their lines, and with them the corners of others that lie on them.
std::vector<PrescribedCrease> drawn_creases(const Pattern&, const std::vector<ExpectedCrease>&);

/// Moves the drawn creases of the shot onto the lines along which hands fold them, adds the missing
/// parts of these lines to its pattern, and the hands that fold along them to the shot.
void add_expected_creases(Shot&, std::vector<ExpectedCrease>);

}  // namespace paperbake
