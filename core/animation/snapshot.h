#pragma once

#include "core/step1_elastic/elastic.h"

namespace paperbake {

/// Everything needed to take steps back: the sheet and what its solver knows, as long as the mesh
/// stays the same.
struct Snapshot {
  Snapshot(const Sheet& now, const Elastic& elastic) : sheet(now), state(elastic.state()) {}
  void restore(Sheet& to, Elastic& elastic) const {
    to = sheet;
    elastic.restore(state);
  }

  Sheet sheet;
  SolverState state;
};

}  // namespace paperbake
