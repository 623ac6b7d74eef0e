#include "core/animation/release_trial.h"

#include "core/geometry/measure.h"
#include "core/model/formatted.h"

#include <algorithm>
#include <cmath>

namespace paperbake {

void ReleaseTrial::begin(SimulatedSheet& simulated, LetGo let_go) {
  is_on_ = false;
  let_go_ = let_go;
  if (!simulated.has_inertia()) {
    is_on_ = let_go != LetGo::no;
    if (is_on_ && let_go != LetGo::by_balance)
      potential_at_start_ = simulated.elastic.evaluate_energies(simulated.sheet).potential;
  } else if (damping_ > 0 && let_go == LetGo::by_handles) {
    damping_ = 0;  // from here on it may swing
    give_inertia(simulated);
  } else if (was_let_go() && quiet_ >= quarter_period(swing_)) {
    is_on_ = true;
    simulated.elastic.set_inertia(Inertia::quasi_static);
  }
}

/// The swing about the equilibrium that the step on trial leads to. On the way down from an
/// unstable shape that takes several steps, which leave no trace.
Swing ReleaseTrial::swing(SimulatedSheet& simulated, const Snapshot& start,
                          const FrameStepResult& step, const StepInput& at) const {
  constexpr int max_steps = 32;  // small stiff sheets snap several times on their way
  Sheet& sheet = simulated.sheet;
  const Snapshot now(sheet, simulated.elastic);
  ElasticReport last = step.last;
  // a step that has converged may still end far from equilibrium, because a share of the mass holds
  // the sheet back (SheetPotential)
  const auto has_arrived = [&](bool converged, const Points3& before) {
    return converged && !last.snap_in_progress &&
           max_row_norm(sheet.x - before) <= still(simulated.side);
  };
  bool arrived = has_arrived(step.converged, start.sheet.x);
  for (int k = 0; k < max_steps && !arrived; ++k) try {
      const Points3 before = sheet.x;
      last = simulated.elastic.step(sheet, at, 1 / fps_);
      arrived = has_arrived(last.converged, before);
    } catch (const EnergyNotFinite&) {
      break;
    }
  Swing swing = swing_to(sheet, start.sheet.x, vertices_of(at.constraints),
                         potential_at_start_ - last.potential, simulated.shot.paper.area_density);
  now.restore(sheet, simulated.elastic);
  // on the first part of its way a sheet frees its energy faster: it may be a slow swing
  if (!arrived) swing.rate = std::min(swing.rate, 0.5 * fastest_swing);
  return swing;
}

std::optional<double> ReleaseTrial::potential_before_drop(SimulatedSheet& simulated,
                                                          const Snapshot& start,
                                                          const FrameStepResult& step,
                                                          const FastestDrive& drive) const {
  const double dt = 1 / fps_, moved = max_row_norm(simulated.sheet.x - start.sheet.x);
  const double fallen = (max_row_norm(start.sheet.v) + std::abs(gravity_) * dt) * dt;
  if (moved <= fallen || moved <= fallen + drive(0) * dt) return std::nullopt;
  const SolverState now = simulated.elastic.state();
  simulated.elastic.restore(start.state);  // the paper may have yielded since then
  const ElasticReport before = simulated.elastic.evaluate_energies(start.sheet);
  simulated.elastic.restore(now);
  const double by_paper = before.energy - step.last.energy,
               by_weight = before.potential - step.last.potential - by_paper;
  if (by_weight <= std::max(by_paper, 0.0)) return std::nullopt;
  return before.potential;
}

std::string ReleaseTrial::note_of(const Swing& swing) const {
  return formatted(let_go_ == LetGo::by_balance
                       ? "it loses its balance and falls by %.1f mm: it moves with inertia now"
                   : let_go_ == LetGo::as_modelled
                       ? "the shape in which it was modelled does not bear its weight: it gives "
                         "way by %.1f mm, with inertia and much damping, until it is at rest"
                       : "let go, it springs by %.1f mm: it moves with inertia now",
                   1e3 * swing.amplitude);
}

ReleaseTrial::Verdict ReleaseTrial::end(SimulatedSheet& simulated, Snapshot& start,
                                        const FrameStepResult& step, const StepInput& at,
                                        const FastestDrive& drive) {
  if (!is_on_) return {};
  if (!was_let_go() && let_go_ == LetGo::by_balance) {
    if (!step.failure_reason.empty() || step.followed < 1) return {};
    const std::optional<double> before = potential_before_drop(simulated, start, step, drive);
    if (!before) return {};
    potential_at_start_ = *before;
  }
  is_on_ = false;
  Verdict verdict;
  if (was_let_go()) {
    const Points3 left = simulated.sheet.x - start.sheet.x - start.sheet.v / fps_;
    if (step.converged && max_row_norm(left) <= still(simulated.side)) {
      swing_ = {};
      return {false, "it has come to rest and goes on without inertia"};
    }
  } else {
    if (!step.failure_reason.empty()) return {};
    const Swing swing = this->swing(simulated, start, step, at);
    if (!needs_inertia(swing, simulated.side)) return {};
    swing_ = swing;
    damping_ = let_go_ == LetGo::as_modelled ? critical_damping(swing, gravity_) : 0;
    // A sheet at equilibrium is moved by what drives it and goes no faster than that, whatever its
    // last step was.
    Points3& v = start.sheet.v;
    const double fastest = max_row_norm(v);
    if (const double hand = drive(1); fastest > hand) v *= hand / fastest;
    verdict.note = note_of(swing);
  }
  quiet_ = 0;
  give_inertia(simulated);
  verdict.needs_inertia = true;
  return verdict;
}

void ReleaseTrial::give_inertia(SimulatedSheet& simulated) const {
  simulated.elastic.set_inertia(Inertia::dynamic, damping_);
}

void ReleaseTrial::observe(SimulatedSheet& simulated, const StepInput& at, double fastest_drive) {
  if (damping_ > 0) {  // it may sink farther than the trial did
    const Swing sunk = swing_to(simulated.sheet, simulated.initial_positions(),
                                vertices_of(at.constraints), 0, simulated.shot.paper.area_density);
    swing_.amplitude = std::max(swing_.amplitude, sunk.amplitude);
    damping_ = critical_damping(swing_, gravity_);
    give_inertia(simulated);
  }
  const Points3 &x = simulated.sheet.x, &before = simulated.positions_before;
  double fastest = max_row_norm(simulated.sheet.v);
  if (before.rows() == x.rows()) fastest = std::max(fastest, fps_ * max_row_norm(x - before));
  const double allowed = still(simulated.side) * swing_.rate + fastest_drive;
  quiet_ = fastest <= allowed ? quiet_ + 1 / fps_ : 0;
}

void ReleaseTrial::archive(Serializer& a) {
  a(swing_.amplitude, swing_.rate, damping_, quiet_);
  if (a.reads())
    a.require(swing_.rate >= 0 && std::isfinite(swing_.rate) && damping_ >= 0 &&
              std::isfinite(damping_) && quiet_ >= 0);
}

}  // namespace paperbake
