#pragma once

#include "core/model/shot.h"

#include <vector>

namespace paperbake {

/// Lets the hands fold the sheet: fingers press the creases on a line along its whole length to the
/// angle between the hands. Where it crosses another fold that was more shut than open when they
/// began, it turns the other way beyond it: the paper lies upside down there. From an angle of 3
/// degrees on the crease is folded. What the paper makes of it is for the next elastic step to
/// find.
/// row  frame - first frame of the scene
void fold_by_hands(Sheet&, const std::vector<FoldingHands>&, int row);

/// The element of FoldingHands::turn that holds in a row: the last one after the end.
double turn_at(const std::vector<double>& turn, int row);
/// The row in which hands began the turn that they have in this one.
int begin_of_turn(const std::vector<double>& turn, int row);

}  // namespace paperbake
