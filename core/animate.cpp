#include "core/animate.h"

#include "core/archive.h"
#include "core/branches.h"
#include "core/cpu_clock.h"
#include "core/error.h"
#include "core/exchange.h"
#include "core/grip.h"
#include "core/hinges.h"
#include "core/measure.h"
#include "core/plastic_grid.h"
#include "core/ripple.h"
#include "core/start_sheet.h"
#include "core/unrest.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>

namespace paperbake {
namespace {

constexpr int max_halvings = 8;
constexpr double most_leap = 0.03;        // [1] of the longer side, in one step
constexpr int most_halvings_of_a_leap = 5;
// A flat sheet chooses a side as it is pushed together: by its way, in steps so short that neither they nor the mesh have a say.
constexpr double flat = 0.01, most_leap_of_flat = 2e-3;  // [1] of the longer side
constexpr int most_halvings_of_a_choice = 3;
constexpr double longest_swing = 1 / 96.0;  // [s] of a step with inertia: backward Euler eats motion, the more the longer it is
constexpr double jammed_stretch = 0.01;  // [1] of an edge
constexpr double torn = 0.5;             // [1] an edge this much too long: the step is not to be trusted

/// The start shape is the first frame as it was modelled, unless a handle is keyed away from it there already. A slight arch
/// that tells which way to buckle would be lost if it were relaxed: handles that were left lying under it are no reason to.
bool in_place(Sheet& sheet, const Held& held, double side) {
  const double same = 5e-4 * side;  // [m]
  for (std::size_t k = 0; k < held.vertices.size(); ++k)
    if ((sheet.x.row(held.vertices[k]) - held.targets.row(k)).norm() > same) return false;
  for (std::size_t k = 0; k < held.vertices.size(); ++k) sheet.x.row(held.vertices[k]) = held.targets.row(k);
  return true;
}

/// Sum over the edges of |fold| x length. [m rad]
double fold_integral(const Sheet& sheet) {
  double sum = 0;
  for (const Hinge& hinge : find_hinges(sheet.triangles).hinges)
    sum += std::abs(fold_angle(sheet.x, hinge)) * (sheet.pattern.row(hinge.vertices[1]) - sheet.pattern.row(hinge.vertices[0])).norm();
  return sum;
}

/// The sheet as the method hands it on. What touches itself is not moved through itself, nor into a collider.
Sheet finished(const Method& method, const Sheet& sheet, const Held& held, const Elastic& elastic, const ElasticReport& step) {
  Sheet shown = sheet;
  if (!method.finish) return shown;
  method.finish(shown, held.vertices);
  if (step.touching > 0 && crossings(shown) > crossings(sheet)) return sheet;
  if (elastic.inside(shown, held.colliders.to) > std::max(step.inside, 5e-5)) return sheet;
  return shown;
}

/// The elastic step of one frame, in halves where a whole one fails.
struct SteppedFrame {
  int substeps = 0, iterations = 0;
  bool converged = true;
  std::string lost;     // why the sheet cannot follow; then it is where it was, and so is all that is known of it
  ElasticReport last;
};

struct FrameToFollow {
  std::string where;    // for errors
  double side;          // [m] longer one of the sheet
  int least_halvings;
};

/// To the mesh that a frame began with. What touches itself may be wedged in a changed one: an edge that was turned or moved across a
/// fold is too short, and between barriers there is no way to its length.
struct WayBack {
  Sheet sheet;
  ElasticPast past;
};

/// leap  [1] how far the handles go against each other; more than a whole step takes: it is halved before it is tried
SteppedFrame follow(Elastic& elastic, Sheet& sheet, const Held& held, double leap, double dt, int halvings, const FrameToFollow& frame) {
  const Sheet before = sheet;
  const ElasticPast past = elastic.past();
  SteppedFrame result;
  std::string failure;
  LengthDistortion distortion;
  const bool chooses = leap > most_leap_of_flat && halvings < most_halvings_of_a_choice && off_plane(sheet.x) < flat * frame.side;
  const bool too_far = leap > most_leap && halvings < most_halvings_of_a_leap;
  if (!too_far && !chooses && halvings >= frame.least_halvings) {
    try {
      result.last = elastic.step(sheet, held, dt);
      result.substeps = 1;
      result.iterations = result.last.iterations;
      result.converged = result.last.converged;
    } catch (const Error& error) {
      failure = error.cause;
    }
    if (failure.empty() && result.converged) return result;
    distortion = length_distortion(sheet);
    if (failure.empty() && distortion.largest < torn) return result;
  }
  sheet = before;
  elastic.take_back(past);
  if (halvings == max_halvings) {
    char cause[200];
    std::snprintf(cause, sizeof cause, "The sheet cannot follow the handles: %d halvings of the time step, worst stretch %.0f %% at pattern (%.1f cm, %.1f cm).",
                  halvings, 100 * distortion.largest, 100 * distortion.where.x(), 100 * distortion.where.y());
    if (!failure.empty()) throw Error(Fault::simulation, frame.where, failure, "Move the handles more slowly before this frame.");
    result.lost = cause;
    return result;
  }
  Held half = held;
  for (std::size_t k = 0; k < held.vertices.size(); ++k)
    half.targets.row(k) = 0.5 * (before.x.row(held.vertices[k]) + held.targets.row(k));
  half.colliders.to = between(held.colliders.from, held.colliders.to);
  Held rest = held;
  rest.colliders.from = half.colliders.to;
  const SteppedFrame first = follow(elastic, sheet, half, 0.5 * leap, 0.5 * dt, halvings + 1, frame);
  if (!first.lost.empty()) return first;
  SteppedFrame second = follow(elastic, sheet, rest, 0.5 * leap, 0.5 * dt, halvings + 1, frame);
  if (!second.lost.empty()) {
    sheet = before;
    elastic.take_back(past);
  }
  second.substeps += first.substeps;
  second.iterations += first.iterations + result.iterations;
  second.converged &= first.converged;
  return second;
}

/// A sheet that cannot follow waits, held where it is, for handles that it can follow.
void stay(Sheet& sheet, const Elastic& elastic, Held& held, SteppedFrame& step) {
  step.last = elastic.look(sheet);
  step.converged = false;
  sheet.v.setZero();
  for (std::size_t k = 0; k < held.vertices.size(); ++k) held.targets.row(k) = sheet.x.row(held.vertices[k]);
}

/// Of a mesh with as many vertices and triangles?
bool belongs(const ElasticPast& p, const Sheet& sheet) {
  const auto there_are = [](const auto& m, Eigen::Index rows) { return m.rows() == 0 || m.rows() == rows; };
  const Eigen::Index vertices = sheet.x.rows(), triangles = sheet.triangles.rows();
  return std::all_of(p.positions.begin(), p.positions.end(), [&](const Points3& x) { return there_are(x, vertices); }) &&
         (!p.second || there_are(p.second->x, vertices)) && there_are(p.ridges.share, triangles) && there_are(p.ridges.focus, triangles);
}

bool belongs(const Held& h, const Sheet& sheet) {
  const std::size_t n = h.vertices.size();
  return static_cast<std::size_t>(h.targets.rows()) == n && (h.stiffness.empty() || h.stiffness.size() == n) &&
         std::all_of(h.vertices.begin(), h.vertices.end(), [&](int v) { return v >= 0 && v < sheet.x.rows(); });
}

}  // namespace

void animate(const Shot& shot, const Method& method, const AnimateOptions& options,
             const std::function<bool(const AnimatedFrame&)>& on_frame) {
  double begun = cpu_ms();
  StartedSheet started = start_sheet(shot, method, options.seed, options.first_frame);
  Sheet& sheet = started.sheet;
  ElasticOptions elastic_options = options.elastic;
  elastic_options.colliders = shot.colliders;
  Elastic elastic(shot.paper, elastic_options);
  const Colliders* colliders = shot.colliders.get();
  std::optional<PlasticGrid> memory;
  if (options.memory == Memory::plastic) elastic.remember_in(&memory.emplace(shot.pattern));
  elastic.set_mesh(sheet, started.stiffening);
  Grip grip(shot, started.handle_vertex, options.first_frame);
  double geometry_ms = cpu_ms() - begun;

  constexpr double still = 2e-4, asleep = 1e-5;  // [1] of the longer side: no method touches the mesh; nothing is solved either
  const double side = longer_side(shot.pattern);
  Points3 before;       // [m] positions one frame ago
  Sheet shown;          // what is handed on
  Held held_before;
  bool at_minimum = false, flowing = false;
  bool leaving = false, lies = false;
  double inside = 0;    // [m] a collider, of what is shown
  int quiet_frames = 0;
  int least_halvings = 0;
  if (options.elastic.inertia == Inertia::dynamic)
    while (std::ldexp(1 / options.fps, -least_halvings) > 1.001 * longest_swing && least_halvings < max_halvings) ++least_halvings;
  int frame = options.first_frame;
  const auto archive_all = [&](Archive& a) {
    ElasticPast past = elastic.past();
    a(frame, sheet, shown, before, held_before, at_minimum, flowing, leaving, lies, quiet_frames, past, grip);
    if (memory) a(*memory);
    if (method.archive) method.archive(a);
    if (!a.reads()) return;
    a.end();
    const auto rows = sheet.x.rows();
    a.demand(frame >= options.first_frame && shown.x.rows() == rows && (before.rows() == 0 || before.rows() == rows));
    a.demand(belongs(held_before, sheet) && belongs(past, sheet));
    a.demand(std::all_of(started.handle_vertex.begin(), started.handle_vertex.end(), [&](int v) { return v < rows; }));
    elastic.set_mesh(sheet, disc_factors(sheet, shot));
    if (memory) past.grid = *memory;
    elastic.take_back(past);
  };
  if (!options.go_on_from.empty()) {
    Archive kept(options.go_on_from);
    archive_all(kept);
    ++frame;
    geometry_ms = 0;
  }
  for (; frame <= options.last_frame; ++frame) {
    AnimatedFrame result;
    result.frame = frame;
    const Held held = grip.held(frame);
    const bool first = frame == options.first_frame;

    begun = cpu_ms();
    const std::size_t born = sheet.singular.size();
    const double moved = unrest(sheet, held, held_before, before, colliders);
    quiet_frames = moved < asleep * side ? quiet_frames + 1 : 0;
    const bool moving = moved > still * side;
    const Moment now{frame, 1 / options.fps, moved / side};
    const Situation situation{started.fixed, memory ? &*memory : nullptr, pulled_alone(sheet, held, still * side, 0.15 * shorter_side(shot.pattern)),
                              now, moving, leaving, at_minimum, flowing, lies, leap_of(sheet, held, held_before) / side};
    if (method.propose && !first)
      if (auto proposal = method.propose(sheet, situation)) {
        const std::vector<double> stiffening = disc_factors(*proposal, shot);
        const Verdict verdict = exchange_mesh(sheet, elastic, std::move(*proposal), stiffening, held_before, 1 / options.fps);
        method.judged(verdict.accepted, now);
        result.remesh = verdict.accepted ? AnimatedFrame::accepted : AnimatedFrame::rejected;
        result.remesh_rise = verdict.rise;
      }
    held_before = held;
    held_before.colliders.from = held.colliders.to;
    std::optional<WayBack> way_back;
    if (method.remesh && !first && result.remesh != AnimatedFrame::accepted) {
      Sheet unchanged = sheet;
      if (method.remesh(sheet, situation)) {
        way_back = {std::move(unchanged), elastic.past()};
        elastic.set_mesh(sheet, disc_factors(sheet, shot));
      }
    }
    before = sheet.x;
    result.new_singular = static_cast<int>(sheet.singular.size() - born);
    result.geometry_ms = geometry_ms + cpu_ms() - begun;
    geometry_ms = 0;

    begun = cpu_ms();
    const std::string where = "frame " + std::to_string(frame) + " of " + std::to_string(options.last_frame);
    SteppedFrame step;
    const bool sleeps = quiet_frames >= 2 && options.elastic.inertia == Inertia::quasi_static;
    if (sleeps || (first && in_place(sheet, held, side))) {
      step.last = elastic.look(sheet);
      sheet.v.setZero();
    } else {
      const FrameToFollow way{where, side, least_halvings};
      step = follow(elastic, sheet, held, situation.leap, 1 / options.fps, 0, way);
      if (way_back && step.last.contact && !step.converged && length_distortion(sheet).largest > std::max(jammed_stretch, 4 * length_distortion(way_back->sheet).largest)) {
        sheet = std::move(way_back->sheet);
        elastic.set_mesh(sheet, disc_factors(sheet, shot));
        elastic.take_back(way_back->past);
        before = sheet.x;
        result.new_singular = 0;
        step = follow(elastic, sheet, held, situation.leap, 1 / options.fps, 0, way);
      }
      if (!step.lost.empty()) {
        if (first) throw Error(Fault::simulation, where, step.lost, "Let the sheet start where its handles are.");
        stay(sheet, elastic, held_before, step);
        result.note = "it stays as it was: " + step.lost;
      }
    }
    constexpr double most_flow = 0.01;  // [1] of the folds, in one frame
    leaving = step.last.leaving;
    lies = step.last.on_colliders > 0;
    at_minimum = step.converged && !leaving;
    flowing = step.last.plastic_flow > 0 && step.last.plastic_flow > most_flow * fold_integral(sheet);
    if (step.last.lower_branch > 1e-3)
      result.note = "snap: a second start ended " + std::to_string(static_cast<int>(std::lround(100 * step.last.lower_branch))) + " % lower in energy and was taken";
    if (options.probe_every > 0 && !sleeps && (frame - options.first_frame + 1) % options.probe_every == 0) {
      const Branches found = probe_branches(sheet, elastic, held_before, 1 / options.fps, options.seed, frame);
      if (found.taken || found.finished) {
        const ElasticReport stored = elastic.look(sheet);
        step.last.energy = stored.energy, step.last.membrane = stored.membrane;
      }
      if (const std::string note = note_of(found); !note.empty()) result.note += (result.note.empty() ? "" : "; ") + note;
    }
    result.elastic_ms = cpu_ms() - begun;
    grip.anchor(sheet.x, frame);

    begun = cpu_ms();
    if (!sleeps || first) {
      shown = finished(method, sheet, held, elastic, step.last);
      inside = elastic.inside(shown, held.colliders.to);
    }
    result.geometry_ms += cpu_ms() - begun;

    result.sheet = &shown;
    if (method.parts) result.parts = method.parts(sheet);
    result.handles = grip.report(shown.x, frame);
    result.substeps = step.substeps;
    result.newton_iterations = step.iterations;
    result.converged = step.converged;
    result.energy = step.last.energy;
    result.membrane_energy = step.last.membrane;
    result.contact = step.last.contact;
    result.touching = step.last.touching;
    result.on_colliders = step.last.on_colliders;
    result.inside_colliders = inside;
    result.plastic = memory ? memory->integral() : 0;
    result.memory = memory ? &*memory : nullptr;
    if (memory && options.show_memory) result.plastic_curvature = memory->at_vertices(shown.pattern, shown.triangles);
    result.state = [&] {
      Archive now;
      archive_all(now);
      return now.bytes();
    };
    if (!on_frame(result)) return;
  }
}

}  // namespace paperbake
