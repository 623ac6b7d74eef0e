#include "baker/studies/accuracy_search.h"

#include "baker/job/method_choice.h"
#include "core/geometry/measure.h"
#include "core/geometry/pattern_samples.h"
#include "core/model/error.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace paperbake {
namespace {

constexpr double kept_share = 0.9;  // [1] of the frames that must keep the accuracy
// [1] of the error that a mesh of twice as many triangles keeps, at most
constexpr double least_gain = 0.75;
// [%] of the longer side, by which results on finer meshes part. The same whatever accuracy is
// asked for: frames that counted for one and not for another would get it a finer mesh.
constexpr double noticeable = 0.1;
constexpr double size_exponent = 1.3;  // CPU time ~ size^1.3, to tell whether a budget is enough

/// A simulation of all sheets, sampled at places of their patterns.
struct SampledRun {
  int size;
  std::vector<std::vector<Points3>> shapes;  // frame by frame, sheet by sheet [longer sides]
  std::size_t crumples_from;                 // index of the first frame with a crumpled sheet
  double seconds = 0;                        // CPU time
};

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(std::ceil(share * values.size())) - 1];
}

/// The meshes among which an accuracy is looked for.
struct SizeLadder {
  std::string option;      // that sets the size
  std::vector<int> sizes;  // the last one may only measure the one before it
  int largest;             // that may be chosen
  bool is_given = false;   // the first one, and only its error is asked for
};

SizeLadder ladder_of(const BakeSettings& settings) {
  const bool hybrid = is_hybrid(settings);
  SizeLadder ladder;
  ladder.option = hybrid ? "base_triangles" : "triangles";
  ladder.is_given = settings.given.count(ladder.option) > 0;
  const int first = ladder.is_given ? (hybrid ? settings.base_triangles : *settings.triangles)
                    : hybrid        ? settings.base_triangles
                                    : 250;
  ladder.largest = ladder.is_given ? first : hybrid ? 960 : 4000;
  if (hybrid && settings.triangles)  // the mesh that is handed on never has more
    ladder.largest = std::min(ladder.largest, *settings.triangles);
  for (int size = std::min(first, ladder.largest);
       ladder.sizes.empty() || ladder.sizes.back() <= ladder.largest; size *= 2)
    ladder.sizes.push_back(size);
  return ladder;
}

void set_size(BakeSettings& settings, const SizeLadder& ladder, int size) {
  if (ladder.option == "triangles")
    settings.triangles = size;
  else
    settings.base_triangles = size;
}

using Log = std::function<void(const std::string&)>;
using Planner = std::function<BakePlan(const BakeSettings&)>;

class AccuracySearch {
 public:
  AccuracySearch(const BakeSettings& settings, const Log& log, const Planner& plan)
      : settings_(settings), log_(log), plan_(plan), ladder_(ladder_of(settings)) {
    choice_.asked_pct = settings.accuracy;
    choice_.budget_seconds = settings.budget;
    choice_.method = settings.method;
    choice_.size_option = ladder_.option;
  }

  AccuracyChoice operator()() {
    for (std::size_t k = 0; k < ladder_.sizes.size(); ++k) {
      const int size = ladder_.sizes[k];
      if (!runs_.empty() && !is_affordable(size)) break;
      run(size);
      if (repeats_the_one_before()) {
        runs_.pop_back();
        choice_.tried.pop_back();
        if (k + 1 == ladder_.sizes.size()) ladder_.sizes.push_back(2 * size);
        continue;
      }
      if (runs_.size() > 1) compare();
      // a finer mesh has nothing to add
      if (comparable_ == 0 || first_that_keeps()) break;
    }
    return choose();
  }

 private:
  double seconds() const {
    double sum = 0;
    for (const SampledRun& r : runs_) sum += r.seconds;
    return sum;
  }

  /// With a budget: will there be time to simulate at this size twice, once to see its shape and
  /// once for the bake?
  bool is_affordable(int size) const {
    if (!settings_.budget) return true;
    const SampledRun& last = runs_.back();
    const double next = last.seconds * std::pow(double(size) / last.size, size_exponent);
    return seconds() + 2 * next <= *settings_.budget;
  }

  void run(int size) {
    BakeSettings settings = settings_;
    if (settings.method == hybrid_and_fem) settings.method = "hybrid";
    settings.polish = 0;  // the error of what is polished is asked for
    set_size(settings, ladder_, size);
    if (ladder_.option == "base_triangles" && settings.triangles)
      settings.triangles = std::max(*settings.triangles, 2 * size);  // a limit would hide the error
    const BakePlan plan = plan_(settings);
    log_(fmt::format("looking for the accuracy: {} with {} triangles", settings.method, size));
    SampledRun r{size, {}, std::size_t(-1)};
    std::vector<PatternSamples> samples;
    for (const Shot& shot : plan.shots) samples.emplace_back(shot.pattern);
    first_frame_ = plan.animation.first_frame;
    simulate(plan, options_of_sheets(plan), settings.threads, [&](const AnimatedFrame& f) {
      const auto index = static_cast<std::size_t>(f.frame - first_frame_);
      r.shapes.resize(index + 1);
      r.shapes[index].push_back(samples[f.sheet_index](*f.sheet) /
                                longer_side(plan.shots[f.sheet_index].pattern));
      r.seconds += 1e-3 * (f.statistics.elastic_ms + f.statistics.geometry_ms);
      if (is_crumpled(*f.sheet)) r.crumples_from = std::min(r.crumples_from, index);
      return f.sheet_index + 1 < plan.shots.size() || index < comparable_;
    });
    note_crumple(r);
    runs_.push_back(std::move(r));
    choice_.tried.push_back({size, std::nullopt, runs_.back().seconds});
  }

  void part(std::size_t index, const std::string& why) {
    if (index >= comparable_) return;
    comparable_ = index;
    choice_.parts_in_frame = first_frame_ + static_cast<int>(index);
    choice_.why_parts = why;
  }

  void note_crumple(const SampledRun& r) {
    if (r.crumples_from < r.shapes.size())
      part(r.crumples_from, "it crumples: three singular points or more");
  }

  /// Whether the last run began on the same mesh as the one before it, because a rehearsal
  /// (rehearsal.h) has made both first meshes finer: it measures nothing, and the next size must.
  bool repeats_the_one_before() const {
    return runs_.size() > 1 && runs_.back().shapes == runs_[runs_.size() - 2].shapes;
  }

  /// Measures the last run against the one before it.
  void compare() {
    const SampledRun &coarse = runs_[runs_.size() - 2], &fine = runs_.back();
    const std::size_t frames = std::min({coarse.shapes.size(), fine.shapes.size(), comparable_});
    std::vector<double> pct(frames, 0.0);
    for (std::size_t f = 0; f < frames; ++f)
      for (std::size_t s = 0; s < std::min(coarse.shapes[f].size(), fine.shapes[f].size()); ++s)
        pct[f] = std::max(pct[f], 100 * rms_distance(coarse.shapes[f][s], fine.shapes[f][s]));
    comparable_ = std::min(comparable_, frames);
    distances_.push_back(std::move(pct));
    const std::size_t last = distances_.size() - 1;
    if (last > 0) {
      const std::size_t at = parting_frame(cut(last - 1), cut(last), noticeable);
      part(at, "finer meshes do not come nearer to each other");
    }
  }

  std::vector<double> cut(std::size_t pair) const {
    const std::vector<double>& all = distances_[pair];
    return {all.begin(), all.begin() + static_cast<long>(std::min(all.size(), comparable_))};
  }
  std::vector<double> errors_of(std::size_t run) const {
    return estimated_errors(run > 0 ? cut(run - 1) : std::vector<double>{}, cut(run));
  }
  double error_of(std::size_t run) const { return quantile(errors_of(run), kept_share); }
  /// The coarsest of the measured runs that keeps the accuracy.
  std::optional<std::size_t> first_that_keeps() const {
    for (std::size_t run = 0; run < distances_.size(); ++run)
      if (ladder_.is_given || (settings_.accuracy && error_of(run) <= *settings_.accuracy))
        return run;
    return std::nullopt;
  }

  AccuracyChoice choose() {
    std::size_t chosen = 0;
    if (!distances_.empty() && comparable_ > 0) {
      const std::size_t finest = distances_.size() - 1;
      const std::optional<std::size_t> keeps = first_that_keeps();
      chosen = keeps.value_or(finest);
      for (std::size_t run = 0; run <= finest; ++run) choice_.tried[run].error_pct = error_of(run);
      choice_.frame_error_pct = errors_of(chosen);
      if (settings_.budget && !keeps && runs_.back().size <= ladder_.largest) {
        // there is time for the finest one, too
        chosen = finest + 1;
        for (double& error : choice_.frame_error_pct) error *= least_gain;
      }
      choice_.error_pct = quantile(choice_.frame_error_pct, kept_share);
      choice_.is_reached = !settings_.accuracy || choice_.error_pct <= *settings_.accuracy;
    }
    choice_.size = runs_[chosen].size;
    return std::move(choice_);
  }

  const BakeSettings& settings_;
  const Log& log_;
  const Planner& plan_;
  SizeLadder ladder_;
  AccuracyChoice choice_;
  std::vector<SampledRun> runs_;
  std::vector<std::vector<double>> distances_;  // [%] frame by frame: of run k to run k + 1
  std::size_t comparable_ = std::size_t(-1);    // frames before this index have one answer
  int first_frame_ = 1;
};

}  // namespace

std::vector<double> estimated_errors(const std::vector<double>& coarser,
                                     const std::vector<double>& finer) {
  std::vector<double> ratios;
  for (std::size_t f = 0; f < std::min(coarser.size(), finer.size()); ++f)
    if (coarser[f] > 0) ratios.push_back(finer[f] / coarser[f]);
  const double r =
      ratios.empty() ? 0.5 : std::clamp(quantile(std::move(ratios), 0.5), 0.25, least_gain);
  std::vector<double> errors = finer;
  for (double& error : errors) error /= 1 - r;
  return errors;
}

std::size_t parting_frame(const std::vector<double>& coarser, const std::vector<double>& finer,
                          double least) {
  constexpr double slow = 0.8;        // [1] meshes of twice as many triangles should gain more
  constexpr double most = 2.0 / 3.0;  // [1] of the frames that remain
  const std::size_t frames = std::min(coarser.size(), finer.size());
  std::size_t first = frames, parted = 0;
  for (std::size_t f = frames; f-- > 0;) {
    if (!(finer[f] > slow * coarser[f] && finer[f] > least)) continue;
    ++parted;
    if (static_cast<double>(parted) >= most * static_cast<double>(frames - f)) first = f;
  }
  return first;
}

BakePlan plan_with_accuracy(BakeSettings& settings, const Log& log, const Planner& plan_with) {
  if (!settings.accuracy && !settings.budget) return plan_with(settings);
  AccuracyChoice choice = AccuracySearch(settings, log, plan_with)();
  set_size(settings, ladder_of(settings), choice.size);
  BakePlan plan = plan_with(settings);
  log(describe(choice));
  plan.accuracy = std::move(choice);
  return plan;
}

BakePlan plan_with_accuracy(BakeSettings& settings, const Log& log) {
  if (!settings.accuracy && !settings.budget) return plan_bake(settings);
  return plan_with_accuracy(settings, log,
                            [scene = read_scene(settings.scene, settings.reading)](
                                const BakeSettings& with) { return plan_bake(with, scene); });
}

std::string describe(const AccuracyChoice& choice) {
  std::string text = fmt::format("accuracy: {} with {} triangles", choice.method, choice.size);
  if (choice.frame_error_pct.empty() && !choice.parts_in_frame)
    text += "; there was no time to estimate how far off it is";
  if (!choice.frame_error_pct.empty())
    text += fmt::format(
        "; nine of ten frames{} are estimated to be within {:.2g} % of the longer side",
        choice.parts_in_frame ? fmt::format(" of the {} before frame {}",
                                            choice.frame_error_pct.size(), *choice.parts_in_frame)
                              : "",
        choice.error_pct);
  if (choice.asked_pct && !choice.is_reached && !choice.frame_error_pct.empty())
    text += fmt::format(", which is more than the {:g} % that were asked for", *choice.asked_pct);
  if (choice.parts_in_frame)
    text += fmt::format("; from frame {} on there is no one answer ({})", *choice.parts_in_frame,
                        choice.why_parts);
  return text;
}

}  // namespace paperbake
