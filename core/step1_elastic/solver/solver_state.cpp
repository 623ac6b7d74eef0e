#include "core/model/serializer.h"
#include "core/step1_elastic/elastic.h"

namespace paperbake {

static void archive(Serializer& a, BranchDescent& w) {
  a(w.x, w.phase, w.tries, w.converged, w.is_lifted);
}

void archive(Serializer& a, SolverState& p) {
  a(p.positions, p.steps, p.remeshed, p.had_contact, p.branch_cooldown_until, p.locked_energy,
    p.descending, p.second, p.ridges.share, p.ridges.focus, p.friction);
}

}  // namespace paperbake
