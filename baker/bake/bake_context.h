#pragma once

#include "baker/bake/bake_certificate.h"
#include "baker/bake/stage_clock.h"
#include "baker/bake/task_queue.h"
#include "baker/job/plan.h"
#include "baker/output/bake_files.h"
#include "baker/output/cache_writers.h"
#include "baker/output/progress.h"

namespace paperbake {

/// What the stages of a bake share.
struct BakeContext {
  const BakeSettings& settings;
  const BakePlan& plan;
  BakeFiles& files;
  BakeCertificate& certificate;
  CacheWriters& caches;
  Progress& progress;
  TaskQueue& tasks;
  StageClock* clock = nullptr;  // null: nobody asks for times
};

}  // namespace paperbake
