#pragma once

#include "core/hands/handle_feasibility.h"

#include <vector>

namespace paperbake {

/// Pairs of handles that have paper enough for the straight path between them, but not for the path
/// round a flat part of the sheet that other handles hold between them; the worst first, each with
/// the worst frame.
///
/// Handles that are as far apart as the straight line between them on the pattern is long hold the
/// paper taut. Three or more of which each two do, not all in one line, hold the convex polygon
/// that they span flat, and no paper passes through it. Where the straight line between two points
/// a and b of the pattern does not meet that polygon, it becomes a curve in space that goes round
/// it, and the shortest such curve over an edge is
///
///   min over t on the edges of  |a - t| + |t - b|
///
/// if the straight line from a to b in space passes through the polygon. a and b are handles, or
/// points on the sides of other parts that are held taut, whose places are known as well. This is a
/// lower bound: paper that is too short for it cannot be where its handles are, whatever it does.
/// It says nothing of several parts that are in the way together, and nothing of colliders.
///
/// Paths that are too long by less than 1 mm are left out: handles that are off by so much are
/// accepted.
///
/// first_frame  frame of row 0 of Handle::keyed
/// last_frame   the last frame that is checked
/// source       this project
std::vector<UnreachablePair> obstructed_paths(const Pattern&, const std::vector<Handle>&,
                                              int first_frame, int last_frame);

/// All pairs of handles that ask for more than paper can reach, along the pattern or round what is
/// in the way: HandleFeasibility::impossible_pairs, then obstructed_paths.
std::vector<UnreachablePair> all_impossible_pairs(const Pattern&, const std::vector<Handle>&,
                                                  int first_frame, int last_frame);

}  // namespace paperbake
