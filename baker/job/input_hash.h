#pragma once

#include "baker/job/plan.h"

#include <string>
#include <vector>

namespace paperbake {

/// Sets start_hash of every sheet, and simulation_hash, frame_hash and job_hash of a plan, from
/// everything else in it: what the frames depend on, and what the simulated frames alone do.
void hash_inputs(BakePlan&);
/// Sets frame_hash alone.
void hash_frames(BakePlan&);

/// Hash of all inputs up to a frame.
/// before  the hash of the frame before it; of the first one: PlannedSheet::start_hash
std::string frame_input_hash(const std::string& before, const BakePlan&, int frame);

/// Hash of what the whole scene asks for: of the input of all frames, those after the last one that
/// is baked included, because it may look ahead to them.
std::string scene_input_hash(const BakePlan&);

}  // namespace paperbake
