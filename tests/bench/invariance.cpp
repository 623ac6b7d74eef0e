#include "tests/bench/invariance.h"

#include "core/geometry/measure.h"
#include "core/geometry/pattern_samples.h"

#include <algorithm>
#include <cmath>

namespace paperbake::bench {
namespace {

constexpr int common = 4;  // [frames] every fourth frame exists under every change
constexpr double degree = M_PI / 180;

}  // namespace

const std::vector<Change>& changes() {
  static const std::vector<Change> all{{"as it is", 1, 1, 0, 0},
                                       {"dt x4", 4, 1, 0, 0},
                                       {"dt /4", 0.25, 1, 0, 0},
                                       {"speed x4", 4, 0.25, 0, 0},
                                       {"speed /4", 0.25, 4, 0, 0},
                                       {"mesh 17 deg", 1, 1, 17 * degree, 0},
                                       {"mesh 8 deg", 1, 1, 8 * degree, 0},
                                       {"mesh 41 deg", 1, 1, 41 * degree, 0},
                                       {"ripple 1", 1, 1, 0, 1}};
  return all;
}

Shot paced(Shot shot, double pace) {
  // a handle that is never grabbed or released stays so
  const auto step_of = [&](int frame) {
    return std::abs(frame) > 1e8 ? frame : static_cast<int>(std::ceil(frame / pace));
  };
  for (Handle& handle : shot.handles) {
    const int first = static_cast<int>(std::floor(1 / pace)),
              last = step_of(static_cast<int>(handle.keyed.rows()));
    const Points3 keyed = handle.keyed;
    handle.keyed.resize(last - first + 1, 3);
    for (int step = first; step <= last; ++step) {
      const double row = std::clamp(step * pace - 1, 0.0, keyed.rows() - 1.0);
      const int below = std::min<int>(static_cast<int>(row), static_cast<int>(keyed.rows()) - 2);
      handle.keyed.row(step - first) =
          keyed.row(below) + (row - below) * (keyed.row(below + 1) - keyed.row(below));
    }
    handle.grab_frame = step_of(handle.grab_frame);
    handle.release_frame = step_of(handle.release_frame);
  }
  return shot;
}

Shapes shapes_of(const Shot& shot, const MakeMethod& make, const Change& change, double gravity,
                 double fps, int last_frame) {
  AnimateOptions options;
  options.fps = fps / change.pace / change.slowness;
  options.first_frame = static_cast<int>(std::floor(1 / change.pace));
  options.last_frame = static_cast<int>(last_frame / common * common / change.pace);
  options.seed = change.ripple;
  options.elastic.forces.gravity = gravity;
  const PatternSamples samples(shot.pattern);
  Shapes shapes;
  animate(paced(shot, change.pace), make(shot, change.turn), options, [&](const AnimatedFrame& f) {
    const double frame = f.frame * change.pace;
    if (frame >= common && std::fmod(frame, common) == 0)
      shapes.frames.push_back(samples(*f.sheet));
    shapes.births += f.statistics.new_singular;
    return true;
  });
  return shapes;
}

double apart_pct(const Shapes& a, const Shapes& b, const Pattern& pattern) {
  double sum = 0;
  for (std::size_t f = 0; f < a.frames.size(); ++f) sum += rms_distance(a.frames[f], b.frames[f]);
  return 100 * sum / longer_side(pattern) / a.frames.size();
}

}  // namespace paperbake::bench
