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
constexpr double most_leap = 0.03;  // [1] of the longer side, in one step
constexpr int most_halvings_of_a_leap = 5;
// A flat sheet buckles to one side when it is compressed. Its steps are so short there that neither
// their length nor the mesh decides on the side.
constexpr double flat = 0.01, most_leap_of_flat = 2e-3;  // [1] of the longer side
constexpr int most_halvings_of_a_choice = 3;
// [1] |l - L|/L of an edge, beyond which a step that has not converged is rejected
constexpr double torn = 0.5;

bool chooses(const Follower& f, int halvings) {
  return f.leap > most_leap_of_flat && halvings < most_halvings_of_a_choice &&
         off_plane(f.sheet.x) < flat * f.side;
}
bool goes_too_far(const Follower& f, int halvings) {
  return f.leap > most_leap && halvings < most_halvings_of_a_leap;
}

std::vector<ElasticReport> step(const std::vector<Follower>& sheets, const Eigen::MatrixXd& reach,
                                double dt) {
  if (sheets.size() == 1)
    return {sheets.front().elastic.step(sheets.front().sheet, sheets.front().held, dt)};
  std::vector<Together> all;
  for (const Follower& f : sheets) all.push_back({f.elastic, f.sheet, f.held, f.begun});
  return Elastic::step_together(all, reach, dt);
}

LengthDistortion worst_of(const std::vector<Follower>& sheets) {
  LengthDistortion worst;
  for (const Follower& f : sheets)
    if (const LengthDistortion d = length_distortion(f.sheet); d.largest >= worst.largest)
      worst = d;
  return worst;
}

/// Solves the part of the frame that ends at time `end` and is 1/2^halvings of a frame long.
std::vector<SteppedFrame> follow(const std::vector<Follower>& sheets, const FrameToFollow& frame,
                                 int halvings, double end) {
  std::vector<Sheet> before;
  std::vector<ElasticPast> past;
  for (const Follower& f : sheets) before.push_back(f.sheet), past.push_back(f.elastic.past());
  std::vector<SteppedFrame> result(sheets.size());
  std::string failure;
  LengthDistortion distortion;
  const double share = std::ldexp(1, -halvings);
  const bool is_long = std::any_of(sheets.begin(), sheets.end(), [&](const Follower& f) {
    return goes_too_far(f, halvings) || chooses(f, halvings);
  });
  if (!is_long && halvings >= frame.least_halvings) {
    bool converged = false;
    try {
      const std::vector<ElasticReport> reports = step(sheets, frame.reach, share * frame.dt);
      for (std::size_t k = 0; k < sheets.size(); ++k)
        result[k] = {1, reports[k].iterations, reports[k].converged, reports[k]};
      converged = std::all_of(reports.begin(), reports.end(),
                              [](const ElasticReport& r) { return r.converged; });
    } catch (const Error& error) {
      failure = error.cause;
    }
    if (!converged) distortion = worst_of(sheets);
    if (failure.empty() && (converged || distortion.largest < torn)) {
      for (const Follower& f : sheets)
        if (f.way) f.way->push_back({end, f.sheet.x});
      return result;
    }
  }
  const auto take_back = [&] {
    for (std::size_t k = 0; k < sheets.size(); ++k) {
      sheets[k].sheet = before[k];
      sheets[k].elastic.take_back(past[k]);
    }
  };
  take_back();
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
    for (SteppedFrame& r : result) r.lost = cause;
    return result;
  }
  std::vector<Follower> first, rest;
  for (std::size_t k = 0; k < sheets.size(); ++k) {
    const Follower& f = sheets[k];
    Held half = f.held, other = f.held;
    for (std::size_t h = 0; h < half.vertices.size(); ++h)
      half.targets.row(h) = 0.5 * (before[k].x.row(half.vertices[h]) + half.targets.row(h));
    half.colliders.to = between(f.held.colliders.from, f.held.colliders.to);
    other.colliders.from = half.colliders.to;
    first.push_back({f.elastic, f.sheet, std::move(half), 0.5 * f.leap, f.side, f.way, f.begun});
    rest.push_back({f.elastic, f.sheet, std::move(other), 0.5 * f.leap, f.side, f.way, f.begun});
  }
  const std::vector<SteppedFrame> begun = follow(first, frame, halvings + 1, end - 0.5 * share);
  if (!begun.front().lost.empty()) return begun;
  std::vector<SteppedFrame> all = follow(rest, frame, halvings + 1, end);
  if (!all.front().lost.empty()) take_back();
  for (std::size_t k = 0; k < sheets.size(); ++k) {
    all[k].substeps += begun[k].substeps;
    all[k].iterations += begun[k].iterations + result[k].iterations;
    all[k].converged &= begun[k].converged;
  }
  return all;
}

}  // namespace

std::vector<SteppedFrame> follow(const std::vector<Follower>& sheets, const FrameToFollow& frame) {
  return follow(sheets, frame, 0, 1);
}

}  // namespace paperbake
