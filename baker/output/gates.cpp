#include "baker/output/gates.h"

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

}  // namespace

std::vector<std::string> missed_gates(const Gates& gates, const std::vector<FrameRecord>& frames,
                                      const BakePlan& plan) {
  Review review(frames, plan.shots.size() > 1);
  review_lengths(gates, review);
  review.check(
      gates.handle_err_mm, [](const FrameRecord& f) { return 1e3 * f.statistics.handle_error_max; },
      [&](const FrameRecord&, double value) {
        return fmt::format("a handle is off by {:.2f} mm, more than {:g} mm", value,
                           gates.handle_err_mm);
      });
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
