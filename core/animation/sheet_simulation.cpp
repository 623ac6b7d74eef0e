#include "core/animation/sheet_simulation.h"

#include "core/animation/branch_search.h"
#include "core/animation/initial_sheet.h"
#include "core/animation/mesh_swap.h"
#include "core/animation/motion_measures.h"
#include "core/geometry/hinges.h"
#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/geometry/mesh_transfer.h"
#include "core/model/error.h"

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

// [s] longest step with inertia: backward Euler damps motion, the more the longer the step
constexpr double longest_swing = 1 / 96.0;
constexpr int most_halvings_of_a_swing = 8;
constexpr double jammed_stretch = 0.01;  // [1] |l - L|/L of an edge
// [1] of the longer side: below motion_threshold no method changes the mesh, below sleep_threshold
// nothing is solved either
constexpr double still = 2e-4, asleep = 1e-5;

/// Puts the held vertices of the start shape at their targets and returns true, unless one of them
/// is farther away than `same`. The first frame then shows the sheet as it was modelled: relaxing
/// it would lose a slight arch that tells it which way to buckle, and handles that lie a little
/// below such an arch are no reason to relax it.
bool in_place(Sheet& sheet, const Held& held, double side) {
  const double same = 5e-4 * side;  // [m]
  for (std::size_t k = 0; k < held.vertices.size(); ++k)
    if ((sheet.x.row(held.vertices[k]) - held.targets.row(k)).norm() > same) return false;
  for (std::size_t k = 0; k < held.vertices.size(); ++k)
    sheet.x.row(held.vertices[k]) = held.targets.row(k);
  return true;
}

/// Sum of |dihedral angle| x length over the edges. [m rad]
double fold_integral(const Sheet& sheet) {
  double sum = 0;
  for (const Hinge& hinge : find_hinges(sheet.triangles).hinges)
    sum += std::abs(fold_angle(sheet.x, hinge)) *
           (sheet.pattern.row(hinge.vertices[1]) - sheet.pattern.row(hinge.vertices[0])).norm();
  return sum;
}

/// The sheet as the method finishes it. The simulated one is kept when the finished one would
/// intersect itself more often or lie deeper inside a collider.
Sheet finished(const Method& method, const Sheet& sheet, const Held& held, const Elastic& elastic,
               const ElasticReport& step) {
  Sheet shown = sheet;
  if (!method.finish) return shown;
  method.finish(shown, held.vertices);
  if (step.touching > 0 && crossings(shown) > crossings(sheet)) return sheet;
  if (elastic.inside(shown, held.colliders.to) > std::max(step.inside, 5e-5)) return sheet;
  return shown;
}

/// True if the state belongs to a mesh with as many vertices and triangles as the sheet has.
bool belongs(const ElasticPast& p, const Sheet& sheet) {
  const auto there_are = [](const auto& m, Eigen::Index rows) {
    return m.rows() == 0 || m.rows() == rows;
  };
  const Eigen::Index vertices = sheet.x.rows(), triangles = sheet.triangles.rows();
  return std::all_of(p.positions.begin(), p.positions.end(),
                     [&](const Points3& x) { return there_are(x, vertices); }) &&
         (!p.second || there_are(p.second->x, vertices)) && there_are(p.ridges.share, triangles) &&
         there_are(p.ridges.focus, triangles);
}

bool belongs(const Held& h, const Sheet& sheet) {
  const std::size_t n = h.vertices.size();
  return static_cast<std::size_t>(h.targets.rows()) == n &&
         (h.stiffness.empty() || h.stiffness.size() == n) &&
         std::all_of(h.vertices.begin(), h.vertices.end(),
                     [&](int v) { return v >= 0 && v < sheet.x.rows(); });
}

ElasticOptions options_of(const Shot& shot, const AnimateOptions& options) {
  ElasticOptions elastic = options.elastic;
  elastic.colliders = shot.colliders;
  return elastic;
}

}  // namespace

Animation::Animation(const Shot& shot, const Method& method, const AnimateOptions& options,
                     std::size_t number)
    : reach(number, 0.0),
      shot_(shot),
      method_(method),
      options_(options),
      number_(number),
      side_(longer_side(shot.pattern)),
      started_(start_sheet(shot, method, options.seed, options.first_frame)),
      elastic_(shot.paper, options_of(shot, options)),
      grip_(shot, started_.handle_vertex, options.first_frame),
      frame_(options.first_frame - 1) {
  if (options.memory == Memory::plastic) elastic_.remember_in(&memory_.emplace(shot.pattern));
  elastic_.set_mesh(started_.sheet, started_.stiffening);
  if (options.elastic.inertia == Inertia::dynamic)
    while (std::ldexp(1 / options.fps, -least_halvings_) > 1.001 * longest_swing &&
           least_halvings_ < most_halvings_of_a_swing)
      ++least_halvings_;
  if (options.go_on_from.empty()) return;
  Archive kept(options.go_on_from);
  archive(kept);
}

void Animation::archive(Archive& a) {
  Sheet& sheet = started_.sheet;
  ElasticPast past = elastic_.past();
  a(frame_, sheet, shown_, before_, held_before_, at_minimum_, flowing_, leaving_, lies_,
    quiet_frames_, contact_, touching_, on_colliders_, past, grip_, reach);
  if (memory_) a(*memory_);
  if (method_.archive) method_.archive(a);
  if (!a.reads()) return;
  a.end();
  const auto rows = sheet.x.rows();
  a.demand(frame_ >= options_.first_frame && shown_.x.rows() == rows &&
           (before_.rows() == 0 || before_.rows() == rows));
  a.demand(belongs(held_before_, sheet) && belongs(past, sheet) && reach.size() == number_);
  a.demand(std::all_of(started_.handle_vertex.begin(), started_.handle_vertex.end(),
                       [&](int v) { return v < rows; }));
  elastic_.set_mesh(sheet, disc_factors(sheet, shot_));
  if (memory_) past.grid = *memory_;
  elastic_.take_back(past);
}

void Animation::prepare(const Fits& fits) {
  Sheet& sheet = started_.sheet;
  result_ = {};
  step_ = {};
  result_.frame = ++frame_;
  held_ = grip_.held(frame_);
  const bool first = frame_ == options_.first_frame;
  const std::size_t born = sheet.singular.size();
  const double moved = unrest(sheet, held_, held_before_, before_, shot_.colliders.get());
  quiet_frames_ = moved < asleep * side_ ? quiet_frames_ + 1 : 0;
  const bool moving = moved > still * side_;
  const Moment now{frame_, 1 / options_.fps, moved / side_};
  leap_ = leap_of(sheet, held_, held_before_) / side_;
  const Situation situation{
      started_.fixed,
      memory_ ? &*memory_ : nullptr,
      pulled_alone(sheet, held_, still * side_, 0.15 * shorter_side(shot_.pattern)),
      now,
      moving,
      leaving_,
      at_minimum_,
      flowing_,
      lies_,
      leap_};
  if (method_.propose && !first)
    if (auto proposal = method_.propose(sheet, situation)) {
      const std::vector<double> stiffening = disc_factors(*proposal, shot_);
      const Verdict verdict = exchange_mesh(sheet, elastic_, std::move(*proposal), stiffening,
                                            held_before_, 1 / options_.fps, fits);
      method_.judged(verdict.accepted, now);
      result_.remesh = verdict.accepted ? AnimatedFrame::accepted : AnimatedFrame::rejected;
      result_.remesh_rise = verdict.rise;
    }
  held_before_ = held_;
  held_before_.colliders.from = held_.colliders.to;
  way_back_.reset();
  begun_.reset();
  if (method_.remesh && !first && result_.remesh != AnimatedFrame::accepted) {
    Sheet unchanged = sheet;
    if (method_.remesh(sheet, situation)) {
      way_back_ = {std::move(unchanged), elastic_.past()};
      elastic_.set_mesh(sheet, disc_factors(sheet, shot_));
      if (!fits(way_back_->sheet, sheet, 0)) put_on(std::move(*way_back_)), way_back_.reset();
    }
  }
  before_ = sheet.x;
  result_.new_singular = static_cast<int>(sheet.singular.size() - born);
  sleeps_ = quiet_frames_ >= 2 && options_.elastic.inertia == Inertia::quasi_static;
  stays_ = sleeps_ || (first && in_place(sheet, held_, side_));
}

void Animation::put_on(WayBack&& back) {
  Sheet& sheet = started_.sheet;
  sheet = std::move(back.sheet);
  elastic_.set_mesh(sheet, disc_factors(sheet, shot_));
  elastic_.take_back(back.past);
}

void Animation::stay() {
  step_ = {};
  step_.last = elastic_.look(sheet());
  step_.last.contact = contact_, step_.last.touching = touching_,
  step_.last.on_colliders = on_colliders_;
  started_.sheet.v.setZero();
  way_ = {{0, sheet().x}, {1, sheet().x}};
}

/// Holds a sheet that cannot follow its handles where it is, until they are where it can.
void Animation::wait_if_lost() {
  if (step_.lost.empty()) return;
  if (frame_ == options_.first_frame)
    throw Error(Fault::simulation, way_through({}).where, step_.lost,
                "Let the sheet start where its handles are.");
  result_.note = "it stays as it was: " + step_.lost;
  stay();
  step_.converged = false;
  for (std::size_t k = 0; k < held_before_.vertices.size(); ++k)
    held_before_.targets.row(k) = sheet().x.row(held_before_.vertices[k]);
}

Follower Animation::follower(Trace trace) {
  return {elastic_, started_.sheet, held_, leap_, side_, trace == Trace::kept ? &way_ : nullptr};
}

FrameToFollow Animation::way_through(const Eigen::MatrixXd& between) const {
  return {"frame " + std::to_string(frame_) + " of " + std::to_string(options_.last_frame),
          1 / options_.fps, least_halvings_, between};
}

bool Animation::wedged() const {
  return way_back_ && step_.last.contact && !step_.converged &&
         length_distortion(sheet()).largest >
             std::max(jammed_stretch, 4 * length_distortion(way_back_->sheet).largest);
}

void Animation::take_way_back() {
  put_on(std::move(*way_back_));
  way_back_.reset();
  before_ = sheet().x;
  result_.new_singular = 0;
}

void Animation::begin_step(Trace trace) {
  if (trace == Trace::none) return;
  begun_ = {sheet(), elastic_.past()};
  way_ = {{0, sheet().x}};
}

void Animation::step(Trace trace) {
  const auto go = [&] {
    begin_step(trace);
    step_ = follow({follower(trace)}, way_through({})).front();
  };
  go();
  if (wedged()) {
    take_way_back();
    go();
  }
  wait_if_lost();
}

Points3 Animation::begun() const {
  return Transfer(shot_.start.pattern, shot_.start.triangles, sheet().pattern)(shot_.start.x);
}

void Animation::step_together(const std::vector<Animation*>& all, const Eigen::MatrixXd& reach,
                              Begun begun) {
  const auto take_back = [](Animation& a) {
    if (!a.begun_) return;
    a.started_.sheet = a.begun_->sheet;
    a.elastic_.take_back(a.begun_->past);
  };
  const auto go = [&] {
    std::vector<Follower> followers;
    for (Animation* a : all) {
      a->stays_ = a->sleeps_ = false;
      a->begin_step(Trace::kept);
      followers.push_back(a->follower(Trace::kept));
      if (begun == Begun::near_each_other) followers.back().begun = a->begun();
    }
    const std::vector<SteppedFrame> steps = follow(followers, all.front()->way_through(reach));
    for (std::size_t k = 0; k < all.size(); ++k) all[k]->step_ = steps[k];
  };
  for (Animation* a : all) take_back(*a);
  go();
  const auto wedged = [](const Animation* a) { return a->wedged(); };
  if (std::any_of(all.begin(), all.end(), wedged)) {
    for (Animation* a : all)
      if (wedged(a))
        a->take_way_back();
      else
        take_back(*a);
    go();
  }
  for (Animation* a : all) a->wait_if_lost();
}

void Animation::settle(const Fits& fits) {
  constexpr double most_flow = 0.01;  // [1] of the fold integral, in one frame
  leaving_ = step_.last.leaving;
  contact_ = step_.last.contact, touching_ = step_.last.touching,
  on_colliders_ = step_.last.on_colliders;
  lies_ = step_.last.on_colliders > 0 || touches_others();
  at_minimum_ = step_.converged && !leaving_;
  flowing_ =
      step_.last.plastic_flow > 0 && step_.last.plastic_flow > most_flow * fold_integral(sheet());
  if (step_.last.lower_branch > 1e-3)
    result_.note = "snap: a second start ended " +
                   std::to_string(static_cast<int>(std::lround(100 * step_.last.lower_branch))) +
                   " % lower in energy and was taken";
  if (options_.probe_every > 0 && !sleeps_ && !touches_others() &&
      (frame_ - options_.first_frame + 1) % options_.probe_every == 0)
    probe(fits);
  grip_.anchor(sheet().x, frame_);
}

void Animation::probe(const Fits& fits) {
  WayBack as_it_was{sheet(), elastic_.past()};
  const Branches found = probe_branches(started_.sheet, elastic_, held_before_, 1 / options_.fps,
                                        options_.seed, frame_);
  if (found.taken || found.finished) {
    if (!fits(as_it_was.sheet, sheet(),
              (sheet().x - as_it_was.sheet.x).rowwise().norm().maxCoeff()))
      return put_on(std::move(as_it_was));
    const ElasticReport stored = elastic_.look(sheet());
    step_.last.energy = stored.energy, step_.last.membrane = stored.membrane;
  }
  if (const std::string note = note_of(found); !note.empty())
    result_.note += (result_.note.empty() ? "" : "; ") + note;
}

void Animation::show(Shown how) {
  if (sleeps_ && frame_ != options_.first_frame) return;
  shown_ = how == Shown::as_simulated ? sheet()
                                      : finished(method_, sheet(), held_, elastic_, step_.last);
  inside_ = elastic_.inside(shown_, held_.colliders.to);
}

AnimatedFrame Animation::report() {
  AnimatedFrame result = std::move(result_);
  result.of = number_;
  result.sheet = &shown_;
  if (method_.parts) result.parts = method_.parts(sheet());
  result.handles = grip_.report(shown_.x, frame_);
  result.substeps = step_.substeps;
  result.newton_iterations = step_.iterations;
  result.converged = step_.converged;
  result.energy = step_.last.energy;
  result.membrane_energy = step_.last.membrane;
  result.contact = step_.last.contact;
  result.touching = step_.last.touching;
  result.touching_others = step_.last.touching_others;
  result.on_colliders = step_.last.on_colliders;
  result.inside_colliders = inside_;
  result.plastic = memory_ ? memory_->integral() : 0;
  result.memory = memory_ ? &*memory_ : nullptr;
  if (memory_ && options_.show_memory)
    result.plastic_curvature = memory_->at_vertices(shown_.pattern, shown_.triangles);
  result.state = [this] {
    Archive now;
    archive(now);
    return now.bytes();
  };
  return result;
}

}  // namespace paperbake
