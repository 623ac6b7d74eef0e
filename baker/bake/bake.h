#pragma once

#include "baker/bake/bake_outcome.h"
#include "baker/job/plan.h"
#include "baker/output/progress.h"

#include <functional>

namespace paperbake {

/// Whether the settings ask for rendered frames.
Passes passes_of(const BakeSettings&);

/// Simulates a plan and writes its output folder: caches, maps, certificate, report. Files that the
/// previous bake of the folder wrote and this one does not are deleted, unless they were edited.
/// Frames that an earlier bake simulated from the same input are loaded from its checkpoints; if
/// everything that is asked for was written already, nothing is done and the outcome is the same.
/// stop    asked after every frame of both passes: shall it end? Within half a second what there is
///         is handed on: files end with the last frame that was rendered in time, everything else
///         that was simulated or rendered is kept for the next bake
/// throws  Error(ErrorCode::folder): the folder is in use or not writable, or a file could not be
///         written; Error(ErrorCode::simulation): a sheet could not follow its handles;
///         Error(ErrorCode::stopped). What was simulated until then is written all the same, as far
///         as that is possible.
BakeOutcome bake(const BakeSettings&, const BakePlan&, Progress&,
                 const std::function<bool()>& stop = {});

void print_warnings(const BakePlan&, Progress&);

/// The same with warnings, progress and missed gates on stderr.
BakeOutcome bake_with_progress(const BakeSettings&, const BakePlan&,
                               const std::function<bool()>& stop = {});

}  // namespace paperbake
