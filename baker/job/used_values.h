#pragma once

#include "baker/job/plan.h"

#include <string>
#include <vector>

namespace paperbake {

/// Appends the values of scene, bake and handles to BakePlan::used, each with where it came from.
/// The rest of the plan is complete, but for its hashes.
void record_used_values(const BakeSettings&, const Scene&, BakePlan&);

/// Appends the crease lines of a sheet to the values that were used.
void record_creases(const SceneSheet&, const std::vector<CreaseLine>&, std::vector<UsedValue>&);

/// The text of job.lock.toml.
std::string lock_text(const BakePlan&);

}  // namespace paperbake
