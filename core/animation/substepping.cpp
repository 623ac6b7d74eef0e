#include "core/animation/substepping.h"

#include "core/animation/imperfection.h"
#include "core/geometry/measure.h"
#include "core/model/error.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace paperbake {
namespace {

constexpr int max_halvings = 8;
constexpr double max_motion = 0.03;  // [1] of the longer side, in one step
constexpr int max_halvings_for_motion = 5;
// A flat sheet buckles to one side when it is compressed. Its steps are so short there that neither
// their length nor the mesh decides on the side.
constexpr double flatness = 0.01, max_motion_of_flat_sheet = 2e-3;  // [1] of the longer side
constexpr int max_halvings_for_buckling = 3;
// [1] |l - L|/L of an edge, beyond which a step that has not converged is rejected
constexpr double max_trusted_stretch = 0.5;

bool needs_buckling_substeps(const SubstepTarget& f, int halvings) {
  return f.relative_motion > max_motion_of_flat_sheet && halvings < max_halvings_for_buckling &&
         off_plane(f.sheet.x) < flatness * f.side;
}
bool exceeds_max_motion(const SubstepTarget& f, int halvings) {
  return f.relative_motion > max_motion && halvings < max_halvings_for_motion;
}

std::vector<ElasticReport> step(const std::vector<SubstepTarget>& sheets,
                                const Eigen::MatrixXd& dhat, double dt) {
  if (sheets.size() == 1)
    return {sheets.front().elastic.step(sheets.front().sheet, sheets.front().input, dt)};
  std::vector<JointStepSheet> all;
  for (const SubstepTarget& f : sheets)
    all.push_back({f.elastic, f.sheet, f.input, f.initial_positions});
  return Elastic::step_together(all, dhat, dt);
}

LengthDistortion worst_of(const std::vector<SubstepTarget>& sheets) {
  LengthDistortion worst;
  for (const SubstepTarget& f : sheets)
    if (const LengthDistortion d = length_distortion(f.sheet); d.largest >= worst.largest)
      worst = d;
  return worst;
}

/// Solves the part of the frame that ends at time `end` and is 1/2^halvings of a frame long.
std::vector<FrameStepResult> advance_frame(const std::vector<SubstepTarget>& sheets,
                                           const FrameInterval& frame, int halvings, double end) {
  std::vector<Sheet> before;
  std::vector<SolverState> state;
  for (const SubstepTarget& f : sheets)
    before.push_back(f.sheet), state.push_back(f.elastic.state());
  std::vector<FrameStepResult> result(sheets.size());
  std::string failure;
  LengthDistortion distortion;
  const double share = std::ldexp(1, -halvings);
  const bool is_long = std::any_of(sheets.begin(), sheets.end(), [&](const SubstepTarget& f) {
    return exceeds_max_motion(f, halvings) || needs_buckling_substeps(f, halvings);
  });
  if (!is_long && halvings >= frame.min_halvings) {
    bool converged = false;
    try {
      const std::vector<ElasticReport> reports = step(sheets, frame.dhat, share * frame.dt);
      for (std::size_t k = 0; k < sheets.size(); ++k)
        result[k] = {1, reports[k].iterations, reports[k].converged, reports[k]};
      converged = std::all_of(reports.begin(), reports.end(),
                              [](const ElasticReport& r) { return r.converged; });
    } catch (const Error& error) {
      failure = error.cause;
    }
    if (!converged) distortion = worst_of(sheets);
    if (failure.empty() && (converged || distortion.largest < max_trusted_stretch)) {
      for (const SubstepTarget& f : sheets)
        if (f.trajectory) f.trajectory->push_back({end, f.sheet.x});
      return result;
    }
  }
  const auto roll_back = [&] {
    for (std::size_t k = 0; k < sheets.size(); ++k) {
      sheets[k].sheet = before[k];
      sheets[k].elastic.restore(state[k]);
    }
  };
  roll_back();
  if (halvings == max_halvings) {
    if (!failure.empty())
      throw Error(Fault::simulation, frame.where, failure,
                  "Move the handles more slowly before this frame.");
    char cause[200];
    std::snprintf(cause, sizeof cause,
                  "The sheet cannot follow the handles: %d halvings of the time step, worst "
                  "stretch %.0f %% at pattern (%.1f cm, %.1f cm).",
                  halvings, 100 * distortion.largest, 100 * distortion.where.x(),
                  100 * distortion.where.y());
    for (FrameStepResult& r : result) r.failure_reason = cause;
    return result;
  }
  std::vector<SubstepTarget> first, rest;
  for (std::size_t k = 0; k < sheets.size(); ++k) {
    const SubstepTarget& f = sheets[k];
    StepInput half = f.input, other = f.input;
    for (PositionConstraint& c : half.constraints)
      c.target = 0.5 * (before[k].x.row(c.vertex).transpose() + c.target);
    half.colliders.to = between(f.input.colliders.from, f.input.colliders.to);
    other.colliders.from = half.colliders.to;
    first.push_back({f.elastic, f.sheet, std::move(half), 0.5 * f.relative_motion, f.side,
                     f.trajectory, f.initial_positions});
    rest.push_back({f.elastic, f.sheet, std::move(other), 0.5 * f.relative_motion, f.side,
                    f.trajectory, f.initial_positions});
  }
  const std::vector<FrameStepResult> initial_positions =
      advance_frame(first, frame, halvings + 1, end - 0.5 * share);
  if (!initial_positions.front().failure_reason.empty()) return initial_positions;
  std::vector<FrameStepResult> all = advance_frame(rest, frame, halvings + 1, end);
  if (!all.front().failure_reason.empty()) roll_back();
  for (std::size_t k = 0; k < sheets.size(); ++k) {
    all[k].substeps += initial_positions[k].substeps;
    all[k].iterations += initial_positions[k].iterations + result[k].iterations;
    all[k].converged &= initial_positions[k].converged;
  }
  return all;
}

}  // namespace

std::vector<FrameStepResult> advance_frame(const std::vector<SubstepTarget>& sheets,
                                           const FrameInterval& frame) {
  return advance_frame(sheets, frame, 0, 1);
}

}  // namespace paperbake
