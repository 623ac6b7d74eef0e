// Does a fit to 20 pushed sheets (paperbake fit --experiment) contain the law from which they were
// drawn? Counts the trials whose 95 % intervals of deviation and offset do, and reports where all
// points lie.
//
//   paperbake_bench_fit [TRIALS [GRADE [SHEETS]]]      default: 100 copy70 20, seven minutes
//
// The law is cut off 3 mm from the border, 2.2 deviations below its mean. So the mean of v is
// 0.18 mm too far inwards and its deviation 4 % too small.

#include "baker/studies/first_point_experiment.h"
#include "baker/studies/fit.h"
#include "formats/config/preset_file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace paperbake {
namespace {

void recover(const Paper& paper, int trials, int sheets) {
  Paper unscattered = paper;
  unscattered.apex_scatter = 0;
  const auto silent = [](const std::string&) {};
  const Vector2d law = push_sheets(unscattered, 1, 1, silent).front().pattern;
  int in_u = 0, in_v = 0, in_deviation = 0;
  Vector2d sum = Vector2d::Zero(), squares = Vector2d::Zero();
  int points = 0;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<Vector2d> measured;
    for (const FirstPoint& p : push_sheets(paper, sheets, 1 + trial * sheets, silent)) {
      measured.push_back(p.pattern);
      const Vector2d off = p.pattern - law;
      sum += off;
      squares += off.cwiseProduct(off);
      ++points;
    }
    const ScatterFit fit = fit_scatter(measured, law);
    const bool u = fit.offset_u.holds(0), v = fit.offset_v.holds(0),
               deviation = fit.deviation_within.holds(paper.apex_scatter);
    in_u += u;
    in_v += v;
    in_deviation += deviation;
    std::printf(
        "  trial %3d: %2d points, deviation %.2f mm [%.2f, %.2f]%s, off by (%.2f, %.2f) mm%s%s\n",
        trial + 1, fit.points, 1e3 * fit.deviation, 1e3 * fit.deviation_within.low,
        1e3 * fit.deviation_within.high, deviation ? "" : " missed", 1e3 * fit.offset.x(),
        1e3 * fit.offset.y(), u ? "" : " u missed", v ? "" : " v missed");
    std::fflush(stdout);
  }
  const double spread = 1.96 * std::sqrt(0.95 * 0.05 * trials);
  const Vector2d mean = sum / points,
                 deviation = (squares / points - mean.cwiseProduct(mean)).cwiseSqrt();
  std::printf(
      "%s, apex_scatter %.2f mm, %d trials of %d sheets: deviation held in %d, offset u in %d, v "
      "in %d (expected %.0f +- %.0f)\n",
      paper.name.c_str(), 1e3 * paper.apex_scatter, trials, sheets, in_deviation, in_u, in_v,
      0.95 * trials, spread);
  std::printf(
      "%d of %d sheets got a point: mean off by (%.3f, %.3f) +- %.3f mm, deviation (%.3f, %.3f) "
      "mm\n",
      points, trials * sheets, 1e3 * mean.x(), 1e3 * mean.y(),
      1e3 * paper.apex_scatter / std::sqrt(points), 1e3 * deviation.x(), 1e3 * deviation.y());
}

}  // namespace
}  // namespace paperbake

int main(int argc, char** argv) {
  setenv("OPENBLAS_NUM_THREADS", "1", 1);
  const int trials = argc > 1 ? std::max(1, std::atoi(argv[1])) : 100,
            sheets = argc > 3 ? std::max(3, std::atoi(argv[3])) : 20;
  paperbake::recover(paperbake::read_preset(argc > 2 ? argv[2] : "copy70").paper, trials, sheets);
}
