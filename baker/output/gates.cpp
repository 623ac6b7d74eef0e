#include "baker/output/gates.h"
#include "baker/job/plan_warnings.h"

#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <set>

namespace paperbake {
namespace {

/// The lines of a certificate and the sentences about them.
class Review {
 public:
  Review(const std::vector<FrameRecord>& frames, bool several_sheets)
      : frames_(frames), several_sheets_(several_sheets) {}

  using Value = std::function<double(const FrameRecord&)>;
  using Sentence = std::function<std::string(const FrameRecord&, double value)>;

  /// Adds a sentence about the worst frame if its value exceeds the limit, and says in which other
  /// frames it does.
  void check(double limit, const Value& value, const Sentence& sentence) {
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
        fmt::format("Frame {}{}: {}.{}", worst->frame,
                    several_sheets_ ? fmt::format(", sheet \"{}\"", worst->sheet) : std::string(),
                    sentence(*worst, value(*worst)), also));
  }

  std::vector<std::string> missed;

 private:
  const std::vector<FrameRecord>& frames_;
  bool several_sheets_;
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
      gates.mean_stretch_pct, [](const FrameRecord& f) { return 100 * f.statistics.stretch_mean; },
      mean(""));
  review.check(
      gates.mean_stretch_pct,
      [](const FrameRecord& f) {
        return f.statistics.render ? 100 * f.statistics.render->stretch_mean : 0;
      },
      mean("of the rendered mesh "));
  review.check(
      gates.max_stretch_pct, [](const FrameRecord& f) { return 100 * f.statistics.stretch_max; },
      [&](const FrameRecord&, double value) {
        return fmt::format("an edge is off by {:.2f} %, more than {:g} %", value,
                           gates.max_stretch_pct);
      });
  review.check(
      gates.max_stretch_pct,
      [](const FrameRecord& f) {
        return f.statistics.render ? 100 * f.statistics.render->stretch_max : 0;
      },
      [&](const FrameRecord& f, double value) {
        return fmt::format("an edge of the rendered mesh is off by {:.2f} %, more than {:g} %, {}",
                           value, gates.max_stretch_pct, place(f.worst.stretch_at));
      });
}

void review_crossings(const std::vector<FrameRecord>& frames, Review& review) {
  const auto pairs = [](const char* of) {
    return [of](const FrameRecord&, double value) {
      return fmt::format("{:.0f} pairs of {} pass through each other", value, of);
    };
  };
  review.check(
      0, [](const FrameRecord& f) { return double(f.statistics.crossings); }, pairs("triangles"));
  review.check(
      0,
      [](const FrameRecord& f) {
        return f.statistics.render ? double(f.statistics.render->crossings) : 0;
      },
      pairs("rendered triangles"));
  // sheets that pass through each other as simulated, such as those joined at a border, do so as
  // rendered too
  std::set<int> crossed;
  for (const FrameRecord& f : frames)
    if (f.statistics.crossings_with_others > 0) crossed.insert(f.frame);
  review.check(
      0,
      [&](const FrameRecord& f) {
        return f.statistics.render && !crossed.count(f.frame)
                   ? double(f.statistics.render->crossings_with_others)
                   : 0;
      },
      pairs("rendered triangles of two sheets"));
}

bool contains(const std::string& text, const char* words) {
  return text.find(words) != std::string::npos;
}

/// The handle that the paper could follow least, if one is known, and why it could not.
std::string worst_jam(const FrameRecord& f, const std::vector<SheetImpossible>& impossible) {
  const auto worst =
      std::max_element(f.jammed.begin(), f.jammed.end(),
                       [](const Jam& a, const Jam& b) { return a.off_mm < b.off_mm; });
  if (worst == f.jammed.end()) return "";
  const bool out_of_reach =
      std::any_of(impossible.begin(), impossible.end(), [&](const SheetImpossible& i) {
        return i.sheet == f.sheet && i.pair.first <= f.frame && f.frame <= i.pair.last &&
               (i.pair.a == worst->handle || i.pair.b == worst->handle);
      });
  return fmt::format(" (\"{}\" is {})", worst->handle,
                     out_of_reach ? "keyed beyond the reach of the paper" : "jammed");
}

/// A sentence about the frames in which the solver gave up; empty: there are none.
std::string not_solved(const std::vector<FrameRecord>& frames) {
  std::set<int> given_up;
  for (const FrameRecord& f : frames)
    if (contains(f.note, note_of_unsolved_step)) given_up.insert(f.frame);
  if (given_up.empty()) return "";
  return fmt::format(
      " In {} frames from {} to {} the sheet stands still because the step was not solved: look at "
      "what it meets there.",
      given_up.size(), *given_up.begin(), *given_up.rbegin());
}

// What sentences about missed gates have in common, by what they are about.
constexpr const char *of_lengths[] = {"mean stretch", "an edge"}, *of_handles = "a handle is off",
                     *of_crossings = "pass through each other",
                     *of_colliders = "inside the collider",
                     *of_impossible = "ask for more than paper can reach";

}  // namespace

std::vector<std::string> good_news(const std::vector<FrameRecord>& frames,
                                   const std::vector<std::string>& missed) {
  const auto none_about = [&](const char* words) {
    return std::none_of(missed.begin(), missed.end(),
                        [&](const std::string& sentence) { return contains(sentence, words); });
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
  if (none_about(of_lengths[0]) && none_about(of_lengths[1]))
    good.push_back(
        fmt::format("The paper keeps its size: lengths are wrong by {:.2g} % on average "
                    "in the worst frame.",
                    100 * mean));
  if (none_about(of_handles))
    good.push_back(fmt::format("Handles are where they were keyed, to {:.2g} mm.", 1e3 * handle));
  if (none_about(of_crossings)) good.push_back("No layer passes through another.");
  if (colliders && none_about(of_colliders)) good.push_back("The paper stays out of colliders.");
  return good;
}

std::string advice(const std::string& missed) {
  if (contains(missed, of_impossible))
    return "Bring these handles closer to each other, or accept that the paper follows them as far "
           "as it can.";
  if (contains(missed, of_colliders))
    return "Move the collider away from where the paper begins, move it more slowly, or bake with "
           "more --base-triangles.";
  if (contains(missed, of_crossings))
    return "Move the handles more slowly in these frames, or bake with more --base-triangles.";
  if (contains(missed, of_handles))
    return "Something is in the way of the paper there, or there is too little of it: move the "
           "handles less far or more slowly; cert/handles.csv says which.";
  if (contains(missed, of_lengths[0]) || contains(missed, of_lengths[1]))
    return "The paper could not follow: move the handles more slowly there. If it is so from the "
           "first frame on, mark the creases of the folded sheet, or move away what stands in it.";
  return "";
}

std::vector<std::string> missed_gates(const Gates& gates, const std::vector<FrameRecord>& frames,
                                      const BakePlan& plan) {
  Review review(frames, plan.shots.size() > 1);
  review_lengths(gates, review);
  review.check(
      gates.handle_err_mm, [](const FrameRecord& f) { return 1e3 * f.statistics.handle_error_max; },
      [&](const FrameRecord& f, double value) {
        return fmt::format("a handle is off by {:.2f} mm, more than {:g} mm{}", value,
                           gates.handle_err_mm, worst_jam(f, plan.impossible));
      });
  if (!review.missed.empty() && contains(review.missed.back(), of_handles))
    review.missed.back() += not_solved(frames);
  review_crossings(frames, review);
  review.check(
      gates.inside_mm, [](const FrameRecord& f) { return 1e3 * f.statistics.inside; },
      [&](const FrameRecord& f, double value) {
        return fmt::format(
            "the sheet is {:.2f} mm inside the collider \"{}\", more than {:g} mm, {}", value,
            f.worst.inside_of, gates.inside_mm, place(f.worst.inside_at));
      });
  if (!plan.impossible.empty())
    review.missed.push_back(
        fmt::format("{} pairs of handles ask for more than paper can reach; the worst: {}",
                    plan.impossible.size(), describe(plan.impossible.front())));
  return review.missed;
}

}  // namespace paperbake
