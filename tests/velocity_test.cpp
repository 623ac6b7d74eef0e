// Motion blur: half a frame along the velocities of the cache, against a bake of the same curves at twice the frame rate. Prints
// a table; slow.
//
//   off     RMS over the vertices of v dt/2 - (X(t + dt/2) - X(t)), X of the fine bake, in % of the frame's motion
//           RMS (x(t + dt) - x(t - dt))/2: only motion is compared, not where the two bakes stand
//   apart   the same of x(t) + v dt/2 - X(t + dt/2): with where they stand
//   alike   frames in which both bakes move the same way: (x(t + dt) - x(t - dt))/2 differs by less than 2 % from that of X. A
//           snap, a birth or a new mesh comes a fraction of a frame earlier or later at another rate, and is no fault of a velocity

#include "core/locate.h"
#include "formats/alembic_reader.h"
#include "tests/program_fixture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace paperbake {
namespace {

using test::CommandLine;
using test::Ended;
using test::samples;
using test::Words;

double rms(const Points3& rows) { return std::sqrt(rows.squaredNorm() / rows.rows()); }

struct Figures {
  int alike = 0, within = 0;  // frames; of them off by at most 5 %
  double median = 0, worst = 0;
};

class TwiceTheFrameRate : public CommandLine {
 protected:
  AlembicReader bake_at(const std::string& scene, const Words& more, int fps, int last) const {
    const std::string to = folder / ("at" + std::to_string(fps));
    Words words{"bake", samples + "/" + scene + ".glb", "-o", to, "--formats", "abc", "--quality", "draft", "--progress", "none", "--fps", std::to_string(fps),
                "--frames", fmt::format("{}-{}", fps / 24, last * fps / 24)};
    words.insert(words.end(), more.begin(), more.end());
    const Ended ended = run(words);
    EXPECT_TRUE(ended.code == 0 || ended.code == 4) << ended.err;
    return AlembicReader(to + "/" + scene + ".abc");
  }

  Figures compare(const std::string& scene, const Words& more, int last) const {
    const AlembicReader coarse = bake_at(scene, more, 24, last), fine = bake_at(scene, more, 48, last);
    const CacheFrame first = coarse.frame(0, 0), fine_first = fine.frame(0, 0);
    const Locator locator(fine_first.uv, fine_first.triangles);
    std::vector<Place> places;
    for (Eigen::Index v = 0; v < first.uv.rows(); ++v) places.push_back(locator.locate(first.uv.row(v)));
    const auto fine_at = [&](int half) {
      const CacheFrame frame = fine.frame(0, half);
      Points3 x(places.size(), 3);
      for (std::size_t v = 0; v < places.size(); ++v) x.row(v) = interpolate(places[v], frame.triangles, frame.x);
      return x;
    };
    Figures figures;
    std::vector<double> all;
    for (int k = 1; k + 1 < last; ++k) {
      const CacheFrame before = coarse.frame(0, k - 1), now = coarse.frame(0, k), next = coarse.frame(0, k + 1);
      const Points3 motion = 0.5 * (next.x - before.x), half = now.velocity / 48.0, X = fine_at(2 * k), X_half = fine_at(2 * k + 1);
      const double moved = rms(motion), differ = rms(motion - 0.5 * (fine_at(2 * k + 2) - fine_at(2 * k - 2))) / moved;
      const double off = rms(half - (X_half - X)) / moved, apart = rms(now.x + half - X_half) / moved;
      if (std::getenv("VELOCITY_FRAMES")) std::printf("  %s frame %d: off %.1f %%, apart %.1f %%, motions differ by %.1f %%\n", scene.c_str(), k + 1, 100 * off, 100 * apart, 100 * differ);
      if (moved < 1e-6 || differ > 0.02) continue;
      all.push_back(off);
      ++figures.alike;
      figures.within += off <= 0.05;
    }
    std::sort(all.begin(), all.end());
    if (!all.empty()) figures.median = all[all.size() / 2], figures.worst = all.back();
    std::printf("%s%s: %d of %d frames alike, %d of these within 5 %%, median %.2f %%, worst %.1f %%\n", scene.c_str(), more.empty() ? "" : (" " + more[1]).c_str(),
                figures.alike, last - 2, figures.within, 100 * figures.median, 100 * figures.worst);
    std::fflush(stdout);
    return figures;
  }
};

const Words fem{"--method", "fem", "--triangles", "600"}, hybrid{"--method", "hybrid"};

TEST_F(TwiceTheFrameRate, TheStripIsHalfAFrameLaterWhereItsVelocitySays) {
  for (const Words& method : {fem, hybrid}) {
    const Figures figures = compare("S2_moebius", method, 44);
    EXPECT_GE(figures.alike, 20);
    EXPECT_GE(figures.within, 0.9 * figures.alike);
  }
}

TEST_F(TwiceTheFrameRate, TheConeIsHalfAFrameLaterWhereItsVelocitySays) {
  for (const Words& method : {fem, hybrid}) {
    const Figures figures = compare("S8_dcone", method, 44);
    EXPECT_GE(figures.alike, 20);
    EXPECT_GE(figures.within, 0.9 * figures.alike);
  }
}

TEST_F(TwiceTheFrameRate, TheCrumpleIsHalfAFrameLaterWhereItsVelocitySays) {
  for (const Words& method : {fem, hybrid}) {
    const Figures figures = compare("S4_crumple", method, 36);
    EXPECT_GE(figures.alike, 5);
    EXPECT_GE(figures.within, 0.9 * figures.alike);
  }
}

}  // namespace
}  // namespace paperbake
