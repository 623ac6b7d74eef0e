#pragma once

#include "baker/job/plan.h"

#include <string>

namespace paperbake {

/// Finds the handles of a plan that ask for more than paper can reach: BakePlan::impossible. Where
/// they ask for as little more as gates let pass (tolerances.h), as noise in keys does, there is
/// one warning for each sheet instead, but for --strict.
/// throws  Error(ErrorCode::scene) with --strict when there are some
void find_impossible_handles(const BakeSettings&, BakePlan&);

/// One sentence: names, frames, overshoot.
std::string describe(const UnreachablePairOfSheet&);

/// Warns of sheets that begin inside a collider. throws Error(ErrorCode::scene) with --strict
void warn_of_sheets_inside_colliders(const BakeSettings&, BakePlan&);

/// Warns of sheets that pass through each other where they begin.
void warn_of_sheets_in_each_other(BakePlan&);

/// Warns of what single keys of the job say of the paper, for all sheets or for some, where a
/// preset on the command line replaces it.
void warn_of_replaced_paper(const BakeSettings&, BakePlan&);

/// Warns of a mesh that is too coarse to bend.
void warn_of_coarse_mesh(const BakeSettings&, BakePlan&);

/// Warns of frames of --map-frames that are not baked.
void warn_of_map_frames(const BakeSettings&, BakePlan&);

/// Warns of values that are likely to be meant in another unit, and of releases that come too late.
void warn_of_doubtful_values(BakePlan&);

}  // namespace paperbake
