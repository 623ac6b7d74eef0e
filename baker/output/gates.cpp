#include "baker/output/gates.h"

#include "baker/job/plan_warnings.h"
#include "baker/output/frames_that.h"

#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <optional>
#include <set>
#include <utility>

namespace paperbake {
namespace {

/// What an artist can move more slowly.
std::string movers(const BakePlan& plan) {
  const bool by_handles = std::any_of(plan.shots.begin(), plan.shots.end(),
                                      [](const Shot& shot) { return !shot.handles.empty(); });
  const bool by_colliders = std::any_of(plan.shots.begin(), plan.shots.end(), [](const Shot& shot) {
    return shot.colliders && std::any_of(shot.colliders->begin(), shot.colliders->end(),
                                         [](const Collider& c) { return !c.frames().empty(); });
  });
  return by_colliders && !by_handles ? "colliders" : "handles";
}

/// What to do about a missed gate.
std::string advice(Gate gate, const BakePlan& plan) {
  switch (gate) {
    case Gate::lengths:
      return fmt::format(
          "The paper could not follow: move the {} more slowly there. If it is so from the first "
          "frame on, mark the creases of the folded sheet, or move away what stands in it.",
          movers(plan));
    case Gate::handles:
      return "Something is in the way of the paper there, there is too little of it, or its mesh "
             "is too coarse: move the handles less far or more slowly, or bake with more "
             "--base-triangles; cert/handles.csv says which handles.";
    case Gate::crossings:
      return fmt::format(
          "Move the {} more slowly in these frames, or bake with more --base-triangles.",
          movers(plan));
    case Gate::colliders:
      return "Paper that colliders squeeze farther than it can fold stays behind them: move them "
             "less far or more slowly, give it more room, or try another --seed or more "
             "--base-triangles. If it is so from the first frame on, move them away from where the "
             "paper begins.";
    case Gate::reach:
      return "Bring these handles closer to each other, or accept that the paper follows them as "
             "far as it can. No other attempts are made for the handles of such a shot.";
  }
  return "";
}

/// What to do about a gate that the simulated sheet keeps and only the render mesh misses.
const char* const advice_on_render_mesh =
    "The simulated sheet is good there: hand it on with --mesh simulation, or try another "
    "--quality.";

/// The lines of a certificate and the sentences about them.
class Review {
 public:
  Review(const std::vector<FrameRecord>& frames, const BakePlan& plan)
      : frames_(frames), plan_(plan) {}

  using Value = std::function<double(const FrameRecord&)>;
  using Sentence = std::function<std::string(const FrameRecord&, double value)>;

  /// Adds a sentence about the worst frame if its value exceeds the limit, and says in which other
  /// frames it does.
  void check(Gate gate, double limit, const Value& value, const Sentence& sentence) {
    const auto worst = std::max_element(
        frames_.begin(), frames_.end(),
        [&](const FrameRecord& a, const FrameRecord& b) { return value(a) < value(b); });
    if (worst == frames_.end() || !(value(*worst) > limit)) return;
    std::set<int> others;
    for (const FrameRecord& f : frames_)
      if (f.frame != worst->frame && value(f) > limit) others.insert(f.frame);
    std::string also;
    if (others.size() == 1) also = fmt::format(" Frame {} misses this gate, too.", *others.begin());
    if (others.size() > 1)
      also = fmt::format(" {} more frames from {} to {} miss this gate.", others.size(),
                         *others.begin(), *others.rbegin());
    missed.push_back(
        {gate,
         fmt::format(
             "Frame {}{}: {}.{}", worst->frame,
             plan_.shots.size() > 1 ? fmt::format(", sheet \"{}\"", worst->sheet) : std::string(),
             sentence(*worst, value(*worst)), also),
         advice(gate, plan_), static_cast<int>(others.size()) + 1, false, worst->sheet});
  }

  /// The same of the render mesh, after the simulated one was checked.
  void check_rendered(Gate gate, double limit, const Value& value, const Sentence& sentence) {
    const bool is_simulated_good = std::none_of(
        missed.begin(), missed.end(),
        [gate](const MissedGate& m) { return m.gate == gate && !m.only_of_rendering; });
    const std::size_t before = missed.size();
    check(
        gate, limit, [&](const FrameRecord& f) { return f.statistics.render ? value(f) : 0; },
        sentence);
    if (!is_simulated_good || missed.size() == before) return;
    missed.back().only_of_rendering = true;
    missed.back().advice = advice_on_render_mesh;
  }

  std::vector<MissedGate> missed;

 private:
  const std::vector<FrameRecord>& frames_;
  const BakePlan& plan_;
};

std::string place(const Vector2d& at) {
  return fmt::format("at ({:.1f}, {:.1f}) mm of the pattern", 1e3 * at.x(), 1e3 * at.y());
}

void review_lengths(const Gates& gates, Review& review) {
  const auto mean = [&](const char* whose) {
    return [&gates, whose](const FrameRecord&, double value) {
      return fmt::format("mean stretch {}{:.2f} %, more than {:g} %", whose, value,
                         gates.mean_stretch_pct);
    };
  };
  review.check(
      Gate::lengths, gates.mean_stretch_pct,
      [](const FrameRecord& f) { return 100 * f.statistics.stretch_mean; }, mean(""));
  review.check(
      Gate::lengths, gates.max_stretch_pct,
      [](const FrameRecord& f) { return 100 * f.statistics.stretch_max; },
      [&](const FrameRecord&, double value) {
        return fmt::format("an edge is off by {:.2f} %, more than {:g} %", value,
                           gates.max_stretch_pct);
      });
  review.check_rendered(
      Gate::lengths, gates.mean_stretch_pct,
      [](const FrameRecord& f) { return 100 * f.statistics.render->stretch_mean; },
      mean("of the rendered mesh "));
  review.check_rendered(
      Gate::lengths, gates.max_stretch_pct,
      [](const FrameRecord& f) { return 100 * f.statistics.render->stretch_max; },
      [&](const FrameRecord& f, double value) {
        return fmt::format("an edge of the rendered mesh is off by {:.2f} %, more than {:g} %, {}",
                           value, gates.max_stretch_pct, place(f.worst.stretch_at));
      });
}

void review_crossings(Review& review) {
  const auto pairs = [](const char* of) {
    return [of](const FrameRecord&, double value) {
      return fmt::format("{:.0f} pairs of {} pass through each other", value, of);
    };
  };
  review.check(
      Gate::crossings, 0, [](const FrameRecord& f) { return double(f.statistics.crossings); },
      pairs("triangles"));
  review.check(
      Gate::crossings, 0,
      [](const FrameRecord& f) { return double(f.statistics.crossings_with_others); },
      pairs("triangles of two sheets"));
  review.check_rendered(
      Gate::crossings, 0,
      [](const FrameRecord& f) { return double(f.statistics.render->crossings); },
      pairs("rendered triangles"));
  review.check_rendered(
      Gate::crossings, 0,
      [](const FrameRecord& f) { return double(f.statistics.render->crossings_with_others); },
      pairs("rendered triangles of two sheets"));
}

bool is_about(const StartFault& fault, const std::string& sheet) {
  return std::find(fault.sheets.begin(), fault.sheets.end(), sheet) != fault.sheets.end();
}

bool has_start_fault(const BakePlan& plan, const std::string& sheet) {
  return std::any_of(plan.start_faults.begin(), plan.start_faults.end(),
                     [&](const StartFault& fault) { return is_about(fault, sheet); });
}

/// What touches a sheet in a frame, and may be in the way of its handles.
std::string what_touches(const FrameRecord& f, const BakePlan& plan) {
  const FrameStatistics& now = f.statistics;
  std::vector<std::string> found;
  if (now.on_colliders > 0) {
    const auto shot = std::find_if(plan.shots.begin(), plan.shots.end(),
                                   [&](const Shot& shot) { return shot.sheet_name == f.sheet; });
    const bool only_one =
        shot != plan.shots.end() && shot->colliders && shot->colliders->size() == 1;
    found.push_back(only_one ? fmt::format("the collider \"{}\"", (*shot->colliders)[0].mesh().name)
                             : "a collider");
  }
  if (now.touching_others > 0) found.push_back("another sheet");
  if (now.touching > 0) found.push_back("itself");
  return fmt::format("{}", fmt::join(found, " and "));
}

/// The handle that the paper could follow least; null: none is known.
const Jam* worst_jam(const FrameRecord& f) {
  const auto worst =
      std::max_element(f.jammed.begin(), f.jammed.end(),
                       [](const Jam& a, const Jam& b) { return a.off_mm < b.off_mm; });
  return worst == f.jammed.end() ? nullptr : &*worst;
}

/// Whether the handle that the paper could follow least, if one is known, is keyed out of reach.
bool is_out_of_reach(const FrameRecord& f, const BakePlan& plan) {
  const Jam* jam = worst_jam(f);
  return jam && is_out_of_reach(plan, f.sheet, jam->handle, f.frame);
}

/// How many handles hold the sheet of a frame.
int held_handles(const FrameRecord& f, const BakePlan& plan) {
  int held = 0;
  for (const Shot& shot : plan.shots)
    if (shot.sheet_name == f.sheet)
      for (const Handle& handle : shot.handles) held += handle.held(f.frame);
  return held;
}

/// What to do where paper beyond a handle may be what is in the way; empty: there is none of about
/// the size of the miss. Where a sheet turns about a handle that stands near its edge, as a page
/// does about its spine, what reaches beyond the handle stands up on what lies there and lifts the
/// handle by as much.
std::string advice_on_paper_beyond(const Jam& jam, const FrameRecord& f, const BakePlan& plan) {
  constexpr double about = 2;  // [1] the reach over the miss, or the reverse, assumed
  for (const Shot& shot : plan.shots)
    for (const Handle& handle : shot.handles) {
      if (shot.sheet_name != f.sheet || handle.name != jam.handle) continue;
      const double reach_mm =
          1e3 * (handle.pattern - nearest_border_point({shot.pattern.outline, {}}, handle.pattern))
                    .norm();
      if (reach_mm > about * jam.off_mm || jam.off_mm > about * reach_mm) continue;
      return fmt::format(
          "If the sheet turns about \"{}\" there, the {:.1f} mm of paper between it and the edge "
          "are in the way: put it on the edge itself. ",
          jam.handle, reach_mm);
    }
  return "";
}

/// Why the paper could not follow a handle.
struct Hindrance {
  std::string why;     // what the handle is
  std::string advice;  // empty: another sentence gives it
};

Hindrance hindrance(const FrameRecord& f, const BakePlan& plan) {
  const std::string touches = what_touches(f, plan);
  if (is_out_of_reach(f, plan)) return {"keyed beyond the reach of the paper", ""};
  if (const Jam* jam = worst_jam(f); jam && !jam->taut_to.empty())
    return {
        fmt::format("keyed farther from \"{}\" than the paper between them is long", jam->taut_to),
        "Move them less far from each other: a relative handle goes on from where it takes "
        "hold of the paper."};
  if (!has_start_fault(plan, f.sheet) &&
      is_pulled(f.statistics, f.statistics.singular, held_handles(f, plan)))
    return {
        fmt::format(
            "behind{}: its weight, its stiffness, its speed or the air may be too strong for the "
            "hand, which gives way rather than tear the paper",
            touches.empty() ? ", though nothing touches the sheet" : ""),
        "Hold the paper with more handles, move them more slowly, or make the wind weaker."};
  if (!touches.empty()) {
    const Jam* jam = worst_jam(f);
    return {"jammed; the sheet touches " + touches,
            (jam ? advice_on_paper_beyond(*jam, f, plan) : "") + advice(Gate::handles, plan)};
  }
  if (has_start_fault(plan, f.sheet)) return {"jammed", advice(Gate::handles, plan)};
  return {
      "jammed, though nothing touches the sheet: the paper pushes back harder than a hand holds it",
      "Hold the paper with more handles there, move them less far, or bake with more "
      "--base-triangles."};
}

/// Adds to a sentence what was wrong at the beginning: it may be why a gate was missed. To that on
/// handles, if there is one, and to none on the render mesh alone. A fault of the sheet that the
/// sentence is about is told before those of others.
void add_start_faults(const std::vector<StartFault>& faults, std::vector<MissedGate>& missed) {
  if (faults.empty()) return;
  const auto find = [&](const auto& is_it) {
    return std::find_if(missed.begin(), missed.end(), is_it);
  };
  auto told = find([](const MissedGate& m) { return m.gate == Gate::handles; });
  if (told == missed.end()) told = find([](const MissedGate& m) { return !m.only_of_rendering; });
  if (told == missed.end()) return;
  auto fault = std::find_if(faults.begin(), faults.end(),
                            [&](const StartFault& one) { return is_about(one, told->sheet); });
  if (fault == faults.end()) fault = faults.begin();
  told->sentence += " This may be the cause: " + fault->sentence;
  if (faults.size() > 1)
    told->sentence += fmt::format(" {} more {} told by warnings.", faults.size() - 1,
                                  faults.size() == 2 ? "fault is" : "faults are");
}

}  // namespace

bool is_pulled(const FrameStatistics& now, int singular, int held) {
  if (!now.inertia || now.on_colliders > 0 || now.touching_others > 0) return false;
  return held == 1 || (now.touching == 0 && singular == 0);
}

std::string describe_unsolved(const std::vector<FrameRecord>& frames) {
  const std::string when =
      frames_that(frames, [](const FrameRecord& f) { return f.step_unsolved; });
  if (when.empty()) return "";
  return fmt::format(
      "In {} the sheet stands still because the step was not solved: look at what it meets there.",
      when);
}

std::string describe_unsettled(const std::vector<FrameRecord>& frames) {
  std::set<std::string> crumpled;  // sheets
  std::set<std::pair<std::string, int>> unsettled;
  for (const FrameRecord& f : frames) {
    if (f.statistics.singular > 0) crumpled.insert(f.sheet);
    if (!f.statistics.converged && !f.step_unsolved) unsettled.insert({f.sheet, f.frame});
  }
  const std::string when = frames_that(frames, [&](const FrameRecord& f) {
    return unsettled.count({f.sheet, f.frame}) && crumpled.count(f.sheet) == 0 &&
           (unsettled.count({f.sheet, f.frame - 1}) || unsettled.count({f.sheet, f.frame + 1}));
  });
  if (when.empty()) return "";
  return fmt::format(
      "In {} the solver ended before the paper had come to rest, as it does where paper snaps: "
      "look whether it moves there as it should.",
      when);
}

std::vector<std::string> good_news(const std::vector<FrameRecord>& frames,
                                   const std::vector<MissedGate>& missed) {
  const auto is_kept = [&](Gate gate) {
    return std::none_of(missed.begin(), missed.end(),
                        [&](const MissedGate& m) { return m.gate == gate; });
  };
  double mean = 0, handle = 0;
  bool colliders = false;
  for (const FrameRecord& f : frames) {
    const FrameStatistics& s = f.statistics;
    mean = std::max(mean, s.render ? s.render->stretch_mean : s.stretch_mean);
    handle = std::max(handle, s.handle_error_max);
    colliders = colliders || s.on_colliders > 0;
  }
  std::vector<std::string> good;
  if (frames.empty()) return good;
  if (is_kept(Gate::lengths))
    good.push_back(
        fmt::format("The paper keeps its size: lengths are wrong by {:.2g} % on average "
                    "in the worst frame.",
                    100 * mean));
  if (is_kept(Gate::handles))
    good.push_back(fmt::format("Handles are where they were keyed, to {:.2g} mm.", 1e3 * handle));
  if (is_kept(Gate::crossings)) good.push_back("No layer passes through another.");
  if (colliders && is_kept(Gate::colliders)) good.push_back("The paper stays out of colliders.");
  return good;
}

std::vector<MissedGate> missed_gates(const Gates& gates, const std::vector<FrameRecord>& frames,
                                     const BakePlan& plan) {
  Review review(frames, plan);
  review_lengths(gates, review);
  std::optional<std::string> advice_on_handles;
  review.check(
      Gate::handles, gates.handle_err_mm,
      [](const FrameRecord& f) { return 1e3 * f.statistics.handle_error_max; },
      [&](const FrameRecord& f, double value) {
        std::string jam;
        if (const Jam* worst = worst_jam(f)) {
          const Hindrance found = hindrance(f, plan);
          jam = fmt::format(" (\"{}\" is {})", worst->handle, found.why);
          advice_on_handles = found.advice;
        }
        return fmt::format("a handle is off by {:.2f} mm, more than {:g} mm{}", value,
                           gates.handle_err_mm, jam);
      });
  if (!review.missed.empty() && review.missed.back().gate == Gate::handles)
    if (const std::string unsolved = describe_unsolved(frames); !unsolved.empty())
      review.missed.back().sentence += " " + unsolved;
  if (advice_on_handles) review.missed.back().advice = *advice_on_handles;
  review_crossings(review);
  review.check(
      Gate::colliders, gates.inside_mm,
      [](const FrameRecord& f) { return 1e3 * f.statistics.inside; },
      [&](const FrameRecord& f, double value) {
        return fmt::format(
            "the sheet is {:.2f} mm inside the collider \"{}\", more than {:g} mm, {}", value,
            f.worst.inside_of, gates.inside_mm, place(f.worst.inside_at));
      });
  if (!plan.impossible.empty())
    review.missed.push_back(
        {Gate::reach,
         plan.impossible.size() == 1
             ? describe(plan.impossible.front())
             : fmt::format("{} pairs of handles ask for more than paper can reach; the worst: {}",
                           plan.impossible.size(), describe(plan.impossible.front())),
         advice(Gate::reach, plan)});
  std::stable_sort(review.missed.begin(), review.missed.end(),
                   [](const MissedGate& a, const MissedGate& b) { return a.frames > b.frames; });
  add_start_faults(plan.start_faults, review.missed);
  std::set<Gate> advised;
  for (MissedGate& m : review.missed)
    if (!advised.insert(m.gate).second) m.advice.clear();
  return review.missed;
}

std::vector<std::string> with_advice(const std::vector<MissedGate>& missed) {
  std::vector<std::string> sentences;
  for (const MissedGate& m : missed)
    sentences.push_back(m.advice.empty() ? m.sentence : m.sentence + " " + m.advice);
  return sentences;
}

}  // namespace paperbake
