#include "baker/studies/chart.h"

#include "baker/job/method_choice.h"
#include "baker/job/plan.h"
#include "baker/output/summary.h"
#include "core/geometry/crease_network.h"
#include "core/geometry/measure.h"
#include "core/geometry/pattern_samples.h"
#include "core/model/error.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>

namespace paperbake {
namespace {

using Clock = std::chrono::steady_clock;

const char* const loose_fem = "fem-loose";  // fem that stops ten times farther from the minimum

struct Size {
  std::string method;
  int size;
  unsigned seed;
};

struct Times {
  double elastic_ms = 0, geometry_ms = 0, worst_frame_ms = 0;
};

/// One run of a method over all sheets and frames.
struct Run {
  ChartPoint point;
  Times times;
  std::vector<std::vector<Points3>> shapes;  // of each sheet, frame by frame, in longer sides
  double energy = 0;                         // [J] summed over sheets and frames
};

BakeSettings settings_for(const ChartSettings& settings, const Size& size) {
  BakeSettings s = settings.job;
  s.method = size.method == loose_fem ? "fem" : size.method;
  if (size.method == loose_fem) s.stop = 10 * s.stop;
  s.seed = size.seed;
  if (size.method == hybrid_and_fem) {
    s.polish = size.size;
  } else if (size.method == "hybrid") {
    s.base_triangles = size.size;
    s.triangles = std::max(1000, 2 * size.size);
  } else {
    s.triangles = size.size;
  }
  return s;
}

struct LastFrame {  // of a sheet
  CreaseNetwork network;
  int singular = 0;
};

/// Adds up what the sheets of a run have in the end.
void count_creases(const std::vector<LastFrame>& sheets, ChartPoint& point) {
  double creases = 0;
  for (const LastFrame& sheet : sheets) {
    point.crease_length += sheet.network.length;
    creases += sheet.network.count;
    point.singular += sheet.singular;
  }
  point.mean_crease = point.crease_length / std::max(1.0, creases);
}

Run run(const ChartSettings& settings, const Size& size, unsigned start_seed,
        Clock::time_point deadline, int max_frames = 1 << 30) {
  const BakePlan plan = plan_bake(settings_for(settings, size));
  Run r;
  r.point.method = size.method;
  r.point.size = size.size;
  r.point.seed = size.seed;
  std::vector<double> frame_ms;
  int wanted = 0;
  double c_m = 0, triangles = 0;
  const std::size_t sheets = plan.shots.size();
  std::vector<LastFrame> last(sheets);
  std::vector<PatternSamples> samples;
  for (const Shot& shot : plan.shots) samples.emplace_back(shot.pattern);
  AnimateOptions animation = plan.animation;
  // every run starts from the same imperfection: only draws and meshes differ
  animation.seed = start_seed;
  r.shapes.resize(sheets);
  try {
    simulate(plan, std::vector(sheets, animation), 1, [&](const AnimatedFrame& f) {
      if (!plan.frames.contains(f.frame)) return true;
      r.shapes[f.sheet_index].push_back(samples[f.sheet_index](*f.sheet) /
                                        longer_side(plan.shots[f.sheet_index].pattern));
      const LengthDistortion d = length_distortion(*f.sheet);
      ++wanted;
      c_m += 100 * d.mean;
      triangles += static_cast<double>(f.sheet->triangles.rows());
      r.times.elastic_ms += f.statistics.elastic_ms;
      r.times.geometry_ms += f.statistics.geometry_ms;
      const std::size_t at = r.shapes[f.sheet_index].size();
      frame_ms.resize(std::max(frame_ms.size(), at), 0.0);
      frame_ms[at - 1] += f.statistics.elastic_ms + f.statistics.geometry_ms;
      r.point.max_stretch_pct = std::max(r.point.max_stretch_pct, 100 * d.largest);
      r.point.not_converged += !f.statistics.converged;
      r.energy += f.statistics.energy;
      last[f.sheet_index] = {crease_network(*f.sheet), static_cast<int>(f.sheet->singular.size())};
      if (f.sheet_index + 1 < sheets) return true;
      if (Clock::now() > deadline && f.frame < animation.last_frame)
        r.point.failure = fmt::format("out of time at frame {}", f.frame);
      return r.point.failure.empty() && static_cast<int>(at) < max_frames;
    });
  } catch (const Error& error) {
    if (error.code != ErrorCode::simulation) throw;
    r.point.failure = error.place + ": " + error.cause;
  }
  count_creases(last, r.point);
  const double frames = std::max<std::size_t>(1, frame_ms.size());
  r.times.elastic_ms /= frames;
  r.times.geometry_ms /= frames;
  r.times.worst_frame_ms =
      frame_ms.empty() ? 0 : *std::max_element(frame_ms.begin(), frame_ms.end());
  r.point.c_m_pct = c_m / std::max(1, wanted);
  r.point.triangles = triangles / frames;
  return r;
}

/// Mean over the frames that both have. [% of the longer side]
double distance_pct(const Run& a, const Run& b) {
  double sum = 0;
  int n = 0;
  for (std::size_t s = 0; s < std::min(a.shapes.size(), b.shapes.size()); ++s)
    for (std::size_t f = 0; f < std::min(a.shapes[s].size(), b.shapes[s].size()); ++f, ++n)
      sum += rms_distance(a.shapes[s][f], b.shapes[s][f]);
  return n > 0 ? 100 * sum / n : 0;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// What each method is run at, besides the reference.
std::vector<Size> size_ladder(const ChartSettings& settings, int reference, unsigned seed) {
  std::vector<Size> sizes;
  for (const std::string& method : settings.methods) {
    if (method == "hybrid")
      for (const int base : {60, 90, 120, 180}) sizes.push_back({method, base, seed});
    if (method == "adaptive")
      // the last: what its sizing field asks for
      for (const int cap : {60, 120, 240, 3000}) sizes.push_back({method, cap, seed});
    if (method == hybrid_and_fem)
      for (const int part : {1, 4})
        if (reference / part >= min_polish_triangles)
          sizes.push_back({method, reference / part, seed});
    if (method == "fem") {
      for (int n = reference / 8; n >= std::max(60, reference / 32); n /= 2)
        sizes.push_back({method, n, seed});
      for (const int part : {1, 4, 16}) sizes.push_back({loose_fem, reference / part, seed});
    }
  }
  return sizes;
}

void check_methods(const std::vector<std::string>& methods) {
  for (const std::string& method : methods)
    if (!is_method(method))
      throw Error(ErrorCode::command, "--methods", fmt::format("Unknown method \"{}\".", method),
                  fmt::format("This version charts: {}.", all_methods));
}

/// The runs of a chart, within its budget.
class ChartRunner {
 public:
  ChartRunner(const ChartSettings& settings, const std::function<void(const std::string&)>& log)
      : settings_(settings),
        log_(log),
        end_(Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                std::chrono::duration<double>(settings.budget))) {
    BakeSettings first = settings.job;
    first.method = "fem";
    const BakePlan plan = plan_bake(first);
    std::vector<std::string> presets;
    for (const PlannedSheet& sheet : plan.sheets) presets.push_back(sheet.preset);
    seed_ = plan.sheets.front().seed;
    chart_.scene = fmt::format("{}, frames {}-{}, {}, gravity {:g} m/s2, stop {:g} m", plan.name,
                               plan.frames.first, plan.frames.last, fmt::join(presets, ", "),
                               plan.animation.elastic.forces.gravity, settings.job.stop);
    chart_.machine = machine_name();
    if (const auto at =
            std::find(settings_.methods.begin(), settings_.methods.end(), hybrid_and_fem);
        at != settings_.methods.end() && plan.animation.elastic.inertia == Inertia::dynamic) {
      settings_.methods.erase(at);
      chart_.remarks.push_back(fmt::format(
          "{} left out: a polished frame is at rest, and with inertia none is", hybrid_and_fem));
    }
  }

  Chart operator()() {
    log_("warming up");
    run(settings_, {"fem", 200, seed_}, seed_, end_, 5);
    find_reference();
    for (const Size& size : size_ladder(settings_, reference_, seed_)) {
      add(size);
      // without a singular point nothing was drawn: other seeds would do the same
      for (unsigned other = 1; other < 3 && runs_.back().point.singular > 0; ++other)
        add({size.method, size.size, seed_ + other});
    }
    run_control();
    repeat();
    return finished();
  }

 private:
  double seconds_left() const { return std::chrono::duration<double>(end_ - Clock::now()).count(); }

  void find_reference() {
    const auto share =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(0.4 * (end_ - Clock::now()));
    for (reference_ = settings_.reference; reference_ >= 100; reference_ /= 2) {
      log_(fmt::format("reference: fem, {} triangles", reference_));
      runs_.assign(1, run(settings_, {"fem", reference_, seed_}, seed_, share));
      const ChartPoint& p = runs_.front().point;
      if (p.failure.empty()) break;
      chart_.remarks.push_back(
          fmt::format("fem with {} triangles is no reference: {}", reference_, p.failure));
      log_(chart_.remarks.back());
    }
    if (runs_.empty() || !runs_.front().point.failure.empty())
      throw Error(ErrorCode::simulation, settings_.job.scene.string(),
                  "No reference: fem does not come to an end, however coarse.",
                  "Give it more time with --budget, or fewer frames with --frames.");
    for (const int part : {2, 4}) add({"fem", reference_ / part, seed_});
    if (runs_[1].point.failure.empty() && runs_[2].point.failure.empty())
      chart_.reference_error_pct =
          richardson_error(distance_pct(runs_[2], runs_[0]), distance_pct(runs_[1], runs_[0]));
  }

  void add(const Size& size) {
    if (seconds_left() <= 0) {
      chart_.remarks.push_back(fmt::format("no time left for {} {}", size.method, size.size));
      return;
    }
    log_(fmt::format("{}, size {}, seed {}", size.method, size.size, size.seed));
    runs_.push_back(run(settings_, size, seed_, end_));
    if (!runs_.back().point.failure.empty()) log_(runs_.back().point.failure);
  }

  /// Another mesh of nearly as many triangles: what a change that should not matter does.
  void run_control() {
    if (seconds_left() <= 0) return;
    const int size = static_cast<int>(std::lround(0.93 * reference_));
    log_(fmt::format("twin of the reference: fem, {} triangles", size));
    const Run other = run(settings_, {"fem", size, seed_}, seed_, end_);
    chart_.control_pct = distance_pct(other, runs_.front());
    std::vector<double> distances;
    for (std::size_t k = 1; k < runs_.size(); ++k)
      if (runs_[k].point.failure.empty())
        distances.push_back(distance_pct(runs_[k], runs_.front()));
    chart_.chaotic = distances.empty() ? false : chart_.control_pct > median(distances);
  }

  void repeat() {
    times_.resize(runs_.size());
    for (std::size_t k = 0; k < runs_.size(); ++k) times_[k].push_back(runs_[k].times);
    for (int again = 1; again < settings_.repeat; ++again)
      for (std::size_t k = 1; k < runs_.size(); ++k) {  // nobody waits for the reference twice
        const ChartPoint& p = runs_[k].point;
        if (seconds_left() <= 0) return;
        if (!p.failure.empty()) continue;
        log_(fmt::format("{}, size {}, seed {}, run {}", p.method, p.size, p.seed, again + 1));
        const Run timed = run(settings_, {p.method, p.size, p.seed}, seed_, end_);
        if (timed.point.failure.empty()) times_[k].push_back(timed.times);
      }
  }

  Chart finished() {
    const auto middle = [](const std::vector<Times>& times, double Times::*value) {
      std::vector<double> values;
      for (const Times& t : times) values.push_back(t.*value);
      return median(values);
    };
    for (std::size_t k = 0; k < runs_.size(); ++k) {
      ChartPoint p = runs_[k].point;
      p.elastic_ms = middle(times_[k], &Times::elastic_ms);
      p.geometry_ms = middle(times_[k], &Times::geometry_ms);
      p.worst_frame_ms = middle(times_[k], &Times::worst_frame_ms);
      p.rms_pct = distance_pct(runs_[k], runs_.front());
      p.energy_rel = runs_.front().energy > 0 ? runs_[k].energy / runs_.front().energy : 1;
      chart_.points.push_back(std::move(p));
    }
    if (chart_.chaotic)
      chart_.remarks.insert(
          chart_.remarks.begin(),
          fmt::format("chaotic: two references on different meshes differ by {:.2g} %, more than "
                      "the methods do; compare statistics instead",
                      chart_.control_pct));
    return std::move(chart_);
  }

  ChartSettings settings_;
  const std::function<void(const std::string&)>& log_;
  Clock::time_point end_;
  unsigned seed_ = 0;
  int reference_ = 0;
  Chart chart_;
  std::vector<Run> runs_;
  std::vector<std::vector<Times>> times_;
};

}  // namespace

Chart chart(const ChartSettings& settings, const std::function<void(const std::string&)>& log) {
  check_methods(settings.methods);
  return ChartRunner(settings, log)();
}

double richardson_error(double far, double near) {
  if (near <= 0) return 0;
  const double q = std::clamp(std::log2(std::max(far / near - 1, 1e-3)), 0.25, 2.0);
  return near / (std::exp2(q) - 1);
}

std::vector<int> pareto_front(const std::vector<ChartPoint>& points) {
  std::vector<int> order;
  for (std::size_t k = 0; k < points.size(); ++k)
    if (points[k].failure.empty() && points[k].rms_pct > 0) order.push_back(static_cast<int>(k));
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return points[a].total_ms() < points[b].total_ms(); });
  std::vector<int> front;
  for (const int k : order)
    if (front.empty() || points[k].rms_pct < points[front.back()].rms_pct) front.push_back(k);
  return front;
}

std::string chart_csv(const Chart& chart) {
  std::string text =
      "method,size,seed,triangles,elastic_ms,geometry_ms,total_ms,worst_frame_ms,c_m_pct,max_"
      "stretch_pct,rms_pct,energy_rel,not_converged,failed\n";
  for (const ChartPoint& p : chart.points)
    text += fmt::format(
        "{},{},{},{:.1f},{:.4f},{:.4f},{:.4f},{:.3f},{:.6f},{:.5f},{:.6f},{:.6f},{},{}\n", p.method,
        p.size, p.seed, p.triangles, p.elastic_ms, p.geometry_ms, p.total_ms(), p.worst_frame_ms,
        p.c_m_pct, p.max_stretch_pct, p.rms_pct, p.energy_rel, p.not_converged,
        p.failure.empty() ? 0 : 1);
  return text;
}

std::string statistics_csv(const Chart& chart) {
  std::string text =
      "method,size,seed,triangles,total_ms,c_m_pct,crease_length_m,mean_crease_m,singular,energy_"
      "rel\n";
  for (const ChartPoint& p : chart.points)
    text += fmt::format("{},{},{},{:.1f},{:.4f},{:.6f},{:.4f},{:.4f},{},{:.4f}\n", p.method, p.size,
                        p.seed, p.triangles, p.total_ms(), p.c_m_pct, p.crease_length,
                        p.mean_crease, p.singular, p.energy_rel);
  return text;
}

}  // namespace paperbake
