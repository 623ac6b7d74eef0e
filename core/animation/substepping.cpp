#include "core/animation/substepping.h"

#include "core/animation/imperfection.h"
#include "core/animation/snapshot.h"
#include "core/geometry/box_of.h"
#include "core/geometry/measure.h"
#include "core/geometry/proximity.h"
#include "core/model/formatted.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

namespace paperbake {
namespace {

constexpr int max_halvings = 8;
constexpr int max_halvings_for_motion = 5;
// Paper that whips round turns so far in a step with inertia that Newton's method does not find its
// shape at the end; in half the time it turns half as far.
constexpr int further_halvings_for_inertia = 3;
// A flat sheet buckles to one side when it is compressed. Its steps are so short there that neither
// their length nor the mesh decides on the side.
constexpr double flatness = 0.01, max_motion_of_flat_sheet = 2e-3;  // [1] of the longer side
constexpr int max_halvings_for_buckling = 3;
// [1] |l - L|/L of an edge, beyond which a step that has not converged is rejected
constexpr double max_trusted_stretch = 0.5;
// [1] the same for a step that has converged, if no edge was off by half as much before it: the
// membrane also has minima with triangles that are turned over, in which paper would be torn
constexpr double max_sudden_stretch = 0.05;
// [1] the same for any step in which a collider moves, if no edge was off by more before it
constexpr double max_jammed_stretch = 0.02;

// 1/1024 of a frame: a blade of 3 mm at 10 m/s moves by half a millimetre in it
constexpr int max_halvings_for_colliders = 10;
constexpr double collider_reach = 2e-3;  // [m] from the sheet, within which a collider is divided
// [m] of a collider, in one step that does not converge
constexpr double max_squeeze = 0.3 * collider_dhat;

/// Whether a collider comes within `reach` [m] of a sheet on its way.
bool comes_near(const Sheet& sheet, const Collider& from, const Collider& to, double reach) {
  const Eigen::AlignedBox3d swept = box_of(from.mesh().x).merged(box_of(to.mesh().x));
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    if (box_of(corners_of(sheet.x, sheet.triangles, t)).squaredExteriorDistance(swept) <=
        reach * reach)
      return true;
  return false;
}

bool needs_buckling_substeps(const DrivenSheet& f, int halvings) {
  return f.relative_motion > max_motion_of_flat_sheet && halvings < max_halvings_for_buckling &&
         off_plane(f.sheet.x) < flatness * f.side;
}
bool exceeds_max_motion(const DrivenSheet& f, int halvings) {
  return f.relative_motion > max_handle_motion && halvings < max_halvings_for_motion;
}

/// The motion of the handles; none: they do not carry the whole sheet as one body.
std::optional<RigidMotion> carrying_motion(const DrivenSheet& f) {
  return rigid_motion_of(f.sheet.x, f.input.constraints, rounding_of_handles);
}

/// How far a collider moves, at most: by itself, or against handles that carry the sheet, if that
/// is less. [m]
double move_against(const std::optional<RigidMotion>& carrying, const Collider& from,
                    const Collider& to) {
  const double most = farthest_move(from, to);
  if (most == 0 || !carrying) return most;
  return std::min(most, max_row_norm(to.mesh().x - moved(*carrying, from.mesh().x)));
}

/// Whether a collider that comes near the sheet in a part of the frame moves farther than `most`
/// [m].
bool is_swept_farther(const DrivenSheet& f, double most) {
  const ColliderMotion& moving = f.input.colliders;
  if (moving.from == moving.to) return false;
  const std::optional<RigidMotion> carrying = carrying_motion(f);
  double reach = collider_reach;
  for (const PositionConstraint& c : f.input.constraints)
    reach = std::max(reach, (f.sheet.x.row(c.vertex).transpose() - c.target).norm());
  const auto passes = [&](const Collider& from, const Collider& to) {
    return move_against(carrying, from, to) > std::min(0.5 * to.depth(), most) &&
           comes_near(f.sheet, from, to, reach);
  };
  for (std::size_t c = 0; c < moving.to.size(); ++c)
    if (passes(*moving.from[c], *moving.to[c])) return true;
  return false;
}

/// Whether a collider near the sheet moves farther than it may in one step: what it takes along is
/// stretched by that against the rest of the sheet.
bool is_swept_too_far(const DrivenSheet& f, int halvings) {
  return halvings < max_halvings_for_colliders &&
         is_swept_farther(f, 0.1 * mean_edge(f.sheet.pattern, f.sheet.triangles));
}

bool are_swept_farther(const std::vector<DrivenSheet>& sheets, double most) {
  return std::any_of(sheets.begin(), sheets.end(),
                     [&](const DrivenSheet& f) { return is_swept_farther(f, most); });
}

/// Whether colliders move on where the sheets are: these jam where they cannot give way.
bool may_jam(const std::vector<DrivenSheet>& sheets) { return are_swept_farther(sheets, 0); }

/// Whether a collider moves farther than a squeezed sheet follows it in one step that does not
/// converge, and the step can be shorter. Where it pushes layers against each other, they begin the
/// step inside of it by what they do not let each other give way, and the force there would crush
/// them.
bool are_squeezed_too_far(const std::vector<DrivenSheet>& sheets, int halvings) {
  return halvings < max_halvings_for_colliders && are_swept_farther(sheets, max_squeeze);
}

WorstEdge worst_edge_of(const std::vector<DrivenSheet>& sheets) {
  WorstEdge worst;
  for (const DrivenSheet& f : sheets)
    if (const WorstEdge edge = worst_edge(f.sheet); edge.error >= worst.error) worst = edge;
  return worst;
}

/// A part of the frame that is 1/2^halvings of it long and ends at time `end`.
struct FramePart {
  int halvings;
  double end;  // [1] of the frame
  double length() const { return std::ldexp(1, -halvings); }
  /// [1] Of what is left of the frame when the part begins.
  double share_of_rest() const { return length() / (1 - end + length()); }
};

std::vector<ElasticReport> step(const std::vector<DrivenSheet>& sheets, const FrameInterval& frame,
                                const FramePart& part) {
  const double dt = part.length() * frame.dt;
  std::vector<StepInput> inputs;
  for (const DrivenSheet& f : sheets) {
    inputs.push_back(f.input);
    inputs.back().pressing = part.share_of_rest();
  }
  if (sheets.size() == 1)
    return {sheets.front().elastic.step(sheets.front().sheet, inputs.front(), dt)};
  std::vector<JointStepSheet> all;
  for (std::size_t k = 0; k < sheets.size(); ++k)
    all.push_back({sheets[k].elastic, sheets[k].sheet, inputs[k], sheets[k].initial_positions});
  return Elastic::step_together(all, frame.dhat, dt);
}

/// Why a step was rejected.
struct Rejection {
  bool not_finite = false;  // the energy: the solver could not go on
  WorstEdge worst;
  bool jammed = false;
  // a collider moves farther in this part than a squeezed sheet follows: a shorter one may do
  bool squeezed_too_far = false;
};

/// Whether a step has left sheets in a state in which paper cannot be.
bool are_crushed(const WorstEdge& now, double stretch_before,
                 const std::vector<FrameStepResult>& steps) {
  return now.error > std::max(max_jammed_stretch, stretch_before) ||
         std::any_of(steps.begin(), steps.end(),
                     [](const FrameStepResult& step) { return step.last.inside > give_way_depth; });
}

/// Whether a step is taken again in halves because sheets with inertia have not converged: their
/// shapes at its end are those from which the next step gets its velocities. As long as there are
/// halves: what has not converged is no reason to give up a frame. Not for sheets with creases:
/// there a panel snaps through, and shorter steps only stretch it for longer.
bool converge_in_halves(const std::vector<DrivenSheet>& sheets, const FrameInterval& frame,
                        const FramePart& part, const std::vector<FrameStepResult>& steps) {
  if (part.halvings >= std::min(frame.min_halvings + further_halvings_for_inertia,
                                std::max(max_halvings, frame.min_halvings)))
    return false;
  for (std::size_t k = 0; k < sheets.size(); ++k)
    if (!steps[k].converged && sheets[k].elastic.inertia() == Inertia::dynamic &&
        sheets[k].sheet.prescribed_creases.empty())
      return true;
  return false;
}

/// Takes a part of the frame in one step.
/// returns  nothing if the step was accepted
std::optional<Rejection> try_step(const std::vector<DrivenSheet>& sheets,
                                  const FrameInterval& frame, const FramePart& part,
                                  std::vector<FrameStepResult>& result) {
  Rejection rejection;
  const double stretch_before = worst_edge_of(sheets).error;
  bool converged = false;
  try {
    const std::vector<ElasticReport> reports = step(sheets, frame, part);
    for (std::size_t k = 0; k < sheets.size(); ++k)
      result[k] = {1, reports[k].iterations, reports[k].converged, reports[k]};
    converged = std::all_of(reports.begin(), reports.end(),
                            [](const ElasticReport& r) { return r.converged; });
  } catch (const EnergyNotFinite&) {
    rejection.not_finite = true;
  }
  rejection.worst = worst_edge_of(sheets);
  const double trusted =
      converged ? std::max(max_sudden_stretch, 2 * stretch_before) : max_trusted_stretch;
  bool unfinished = converge_in_halves(sheets, frame, part, result);
  if (may_jam(sheets)) {
    const bool far = are_squeezed_too_far(sheets, part.halvings);
    rejection.squeezed_too_far = far;
    const bool crushed =
        rejection.not_finite || are_crushed(rejection.worst, stretch_before, result);
    rejection.jammed = crushed && !far;
    unfinished |= crushed || (far && !converged);
  }
  if (rejection.not_finite || !(rejection.worst.error < trusted) || unfinished) return rejection;
  for (const DrivenSheet& f : sheets)
    if (f.trajectory) f.trajectory->push_back({part.end, f.sheet.x});
  return std::nullopt;
}

/// The message of a part of the frame that cannot be halved once more.
/// throws  EnergyNotFinite when it was not
std::string reason_of(const Rejection& rejection, int halvings, const FrameInterval& frame,
                      const std::vector<DrivenSheet>& sheets) {
  const auto any = [&](const auto& leads) {
    return std::any_of(sheets.begin(), sheets.end(), leads);
  };
  const char* leading =
      any([](const DrivenSheet& f) { return !f.input.constraints.empty(); })    ? "handles"
      : any([](const DrivenSheet& f) { return !f.input.colliders.to.empty(); }) ? "colliders"
                                                                                : "other sheets";
  if (rejection.not_finite)
    throw EnergyNotFinite(frame.where,
                          std::string("Move the ") + leading + " more slowly before this frame.");
  return formatted(
      "The sheet cannot follow the %s: %d halvings of the time step, worst "
      "stretch %.0f %% at pattern (%.1f cm, %.1f cm).",
      leading, halvings, 100 * rejection.worst.error, 100 * rejection.worst.where.x(),
      100 * rejection.worst.where.y());
}

/// The colliders half way. Those that move with the handles go on their arcs.
ColliderShapes half_way(const DrivenSheet& f) {
  const ColliderMotion& moving = f.input.colliders;
  ColliderShapes half = between(moving.from, moving.to);
  const std::optional<RigidMotion> carrying = carrying_motion(f);
  if (!carrying) return half;
  for (std::size_t c = 0; c < half.size(); ++c) {
    const Collider &from = *moving.from[c], &to = *moving.to[c];
    if (&from != &to && move_against(carrying, from, to) <= rounding_of_handles)
      half[c] = std::make_shared<const Collider>(to, moved(half_of(*carrying), from.mesh().x));
  }
  return half;
}

/// What a sheet is to follow in the two halves of a part of the frame.
/// dt  [s] length of each half
std::pair<DrivenSheet, DrivenSheet> halves_of(const DrivenSheet& whole, double dt) {
  StepInput half = whole.input, other = whole.input;
  half.constraints = whole.elastic.half_way(whole.sheet, whole.input.constraints);
  half.colliders.to = half_way(whole);
  other.colliders.from = half.colliders.to;
  half.time -= dt;
  const auto with = [&](StepInput input) -> DrivenSheet {
    return {whole.elastic, whole.sheet,      std::move(input),       0.5 * whole.relative_motion,
            whole.side,    whole.trajectory, whole.initial_positions};
  };
  return {with(std::move(half)), with(std::move(other))};
}

std::vector<FrameStepResult> advance_part(const std::vector<DrivenSheet>& sheets,
                                          const FrameInterval& frame, const FramePart& part) {
  std::vector<Snapshot> beginning;
  for (const DrivenSheet& f : sheets) beginning.emplace_back(f.sheet, f.elastic);
  const auto go_back = [&] {
    for (std::size_t k = 0; k < sheets.size(); ++k)
      beginning[k].restore(sheets[k].sheet, sheets[k].elastic);
  };
  std::vector<FrameStepResult> result(sheets.size());
  std::optional<Rejection> rejection = Rejection{};
  const bool is_long = std::any_of(sheets.begin(), sheets.end(), [&](const DrivenSheet& f) {
    return exceeds_max_motion(f, part.halvings) || needs_buckling_substeps(f, part.halvings) ||
           is_swept_too_far(f, part.halvings);
  });
  if (!is_long && part.halvings >= frame.min_halvings)
    rejection = try_step(sheets, frame, part, result);
  if (!rejection) return result;
  go_back();
  if (rejection->jammed) {
    for (FrameStepResult& r : result) {
      r.substeps = 0;
      r.converged = false;
      r.followed = part.end - part.length();
    }
    return result;
  }
  if (part.halvings >= std::max(max_halvings, frame.min_halvings) && !is_long &&
      !rejection->squeezed_too_far) {
    const std::string reason = reason_of(*rejection, part.halvings, frame, sheets);
    for (FrameStepResult& r : result) r.failure_reason = reason;
    return result;
  }
  std::vector<DrivenSheet> first, rest;
  for (const DrivenSheet& f : sheets) {
    auto [half, other] = halves_of(f, 0.5 * part.length() * frame.dt);
    first.push_back(std::move(half));
    rest.push_back(std::move(other));
  }
  const int halvings = part.halvings + 1;
  const std::vector<FrameStepResult> half =
      advance_part(first, frame, {halvings, part.end - 0.5 * part.length()});
  const auto is_over = [](const FrameStepResult& r) {
    return !r.failure_reason.empty() || r.followed < 1;
  };
  if (is_over(half.front())) return half;
  std::vector<FrameStepResult> all = advance_part(rest, frame, {halvings, part.end});
  if (!all.front().failure_reason.empty()) go_back();
  for (std::size_t k = 0; k < sheets.size(); ++k) {
    if (all[k].followed <= part.end - 0.5 * part.length()) all[k].last = half[k].last;
    all[k].substeps += half[k].substeps;
    all[k].iterations += half[k].iterations + result[k].iterations;
    all[k].converged &= half[k].converged;
  }
  return all;
}

}  // namespace

int halvings_of_squeeze(const ColliderMotion& moving) {
  const double travel = farthest_move(moving.from, moving.to);
  int halvings = 0;
  while (std::ldexp(travel, -halvings) > max_squeeze && halvings < max_halvings_for_colliders)
    ++halvings;
  return halvings;
}

std::vector<FrameStepResult> advance_frame(const std::vector<DrivenSheet>& sheets,
                                           const FrameInterval& frame) {
  return advance_part(sheets, frame, {0, 1});
}

}  // namespace paperbake
