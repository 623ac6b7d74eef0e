#pragma once

#include "core/hands/clamps.h"
#include "core/hands/expected_creases.h"

#include <optional>
#include <vector>

namespace paperbake {

/// The corners of a sheet that is wrapped round a box. Where two lines cross along which hands fold
/// the sheet at the same time, paper cannot be folded straight on beyond the crossing, because
/// straight lines through a point fold one after the other only. Three of the sectors around the
/// crossing are held flat by hands. The fourth one folds once more, and is drawn out like the
/// gusset of a bag.
///
/// One hand holds the first sector, and folds the sheet along both lines with two others. Where the
/// lines enclose the angle g, and hands turn about them by a and b, the borders of the fourth
/// sector are d apart,
///
///   cos d - cos g = 4 sin^2 g  s_a s_b (c_a c_b - cos g  s_a s_b),
///
/// with the sines s and cosines c of half the turns. If d < g, the sector can follow by a fold
/// along its bisector, down to d = 0, where it lies shut. Its two flat halves are then isosceles
/// spherical triangles, which say by how much the paper turns at the bisector and at the parts of
/// the two lines beyond the crossing. The bisector bulges to the same side as the two lines,
/// outwards, unless handles in the sector lead it inwards.
///
/// expected  lines between hands, with their turns
/// returns   the gusset crease of each crossing that needs one; it ends at the border, or at the
///           next line
/// source    this project; spherical trigonometry
std::vector<ExpectedCrease> gussets(const Shot&, const Clamps&,
                                    const std::vector<ExpectedCrease>& expected);

/// Whether a fold can go straight on beyond a line about which other hands turn the paper: one of
/// the two folds has to be nearly open or nearly shut.
/// turn, turn_of_others  [rad]
bool goes_straight_on(double turn, double turn_of_others);

/// The fourth sector around the point where two lines cross, when it has folded. The first sector
/// lies in the plane z = 0, the first line on the x axis; the parts beyond the crossing begin along
/// it, and at the given angle from it towards y.
struct GussetShape {
  Vector3d borders[2], bisector;  // [1] where those parts and the bisector between them have gone
  double beyond[2], turn;         // [rad] by how much the paper turns there
};

/// How hands that turn the second and the third sector against the first one move the fourth; none
/// if it cannot follow.
/// angle     [rad] between the two lines, in the first sector and in the fourth
/// turn      [rad] about the first line, and about the second one
/// outwards  its bisector bulges to the same side as the first line
std::optional<GussetShape> gusset_shape(double angle, double turn, double turn_of_others,
                                        bool outwards);

}  // namespace paperbake
