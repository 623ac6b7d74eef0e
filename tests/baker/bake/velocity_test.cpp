// Motion blur: half a frame along the velocities of the cache, against a bake of the same curves at
// twice the frame rate. Prints a table; slow.
//
// Frames that the scene counts (paper_grab_frame) are doubled with the rate; what is let go later
// than the last frame compared is let go later there too.
//
//   off     RMS over the vertices of v dt/2 - (X(t + dt/2) - X(t)), X of the fine bake, in % of the
//   frame's motion
//           RMS (x(t + dt) - x(t - dt))/2: only motion is compared, not where the two bakes stand
//   own     the same of the fine bake alone: v = (X(t + dt) - X(t - dt))/(2 dt), what the cache
//   would hold of the same shapes
//   alike   frames in which both bakes move the same way: (x(t + dt) - x(t - dt))/2 differs by less
//   than 2 % from that of X. A
//           snap, a birth or a new mesh comes a fraction of a frame earlier or later at another
//           rate, and is no fault of a velocity

#include "core/geometry/point_location.h"
#include "formats/cache/alembic_reader.h"
#include "tests/baker/program_fixture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <vector>

namespace paperbake {
namespace {

using test::CommandLine;
using test::Ended;
using test::samples;
using test::Words;

double rms(const Points3& rows) { return std::sqrt(rows.squaredNorm() / rows.rows()); }

/// How far some frames are off. [1]
struct Spread {
  std::vector<double> off;
  int within() const {
    return static_cast<int>(
        std::count_if(off.begin(), off.end(), [](double o) { return o <= 0.05; }));
  }
  double median() const {
    std::vector<double> sorted = off;
    std::sort(sorted.begin(), sorted.end());
    return sorted.at(off.size() / 2);
  }
  std::string text() const {
    if (off.empty()) return "none";
    return fmt::format("{} frames, {} within 5 %, median {:.2f} %, worst {:.1f} %", off.size(),
                       within(), 100 * median(), 100 * *std::max_element(off.begin(), off.end()));
  }
};
struct Figures {
  Spread alike, own;
};

class VelocityTest : public CommandLine {
 protected:
  AlembicReader bake_at(const std::string& scene, const Words& more, int fps, int last) const {
    const std::string to = folder / ("at" + std::to_string(fps));
    std::string bytes = test::read(samples + "/" + scene + ".glb");
    const auto replace = [&](const std::string& from, const std::string& to) {  // as long
      for (std::size_t at = 0; (at = bytes.find(from, at)) != std::string::npos; ++at)
        bytes.replace(at, from.size(), to);
    };
    if (fps == 48) {
      replace("\"paper_grab_frame\":24", "\"paper_grab_frame\":48");
      replace("\"paper_release_frame\":73", "\"paper_release_frame\":99");
    }
    std::filesystem::create_directories(to);
    test::write(to + "/" + scene + ".glb", bytes);
    Words words{"bake",       to + "/" + scene + ".glb",
                "-o",         to,
                "--formats",  "abc",
                "--quality",  "draft",
                "--progress", "none",
                "--fps",      std::to_string(fps),
                "--frames",   fmt::format("{}-{}", fps / 24, last * fps / 24)};
    words.insert(words.end(), more.begin(), more.end());
    const Ended ended = run(words);
    EXPECT_TRUE(ended.code == 0 || ended.code == 4) << ended.err;
    return AlembicReader(to + "/" + scene + ".abc");
  }

  Figures compare(const std::string& scene, const Words& more, int last) const {
    const AlembicReader coarse = bake_at(scene, more, 24, last),
                        fine = bake_at(scene, more, 48, last);
    const CacheFrame first = coarse.frame(0, 0), fine_first = fine.frame(0, 0);
    const PointLocator locator(fine_first.uv, fine_first.triangles);
    std::vector<MeshPoint> places;
    for (Eigen::Index v = 0; v < first.uv.rows(); ++v)
      places.push_back(locator.locate(first.uv.row(v)));
    const auto fine_at = [&](int half) {
      const CacheFrame frame = fine.frame(0, half);
      Points3 x(places.size(), 3);
      for (std::size_t v = 0; v < places.size(); ++v)
        x.row(v) = interpolate(places[v], frame.triangles, frame.x);
      return x;
    };
    Figures figures;
    for (int k = 1; k + 1 < last; ++k) {
      const CacheFrame before = coarse.frame(0, k - 1), now = coarse.frame(0, k),
                       next = coarse.frame(0, k + 1);
      const Points3 motion = 0.5 * (next.x - before.x), half = now.velocity / 48.0,
                    X = fine_at(2 * k), X_half = fine_at(2 * k + 1);
      const Points3 X_before = fine_at(2 * k - 2), X_next = fine_at(2 * k + 2);
      const double moved = rms(motion), differ = rms(motion - 0.5 * (X_next - X_before)) / moved;
      const double off = rms(half - (X_half - X)) / moved, own_moved = 0.5 * rms(X_next - X_before);
      const double own = rms(0.25 * (X_next - X_before) - (X_half - X)) / own_moved;
      if (std::getenv("VELOCITY_FRAMES"))
        std::printf("  %s frame %d: off %.1f %%, own %.1f %%, motions differ by %.1f %%\n",
                    scene.c_str(), k + 1, 100 * off, 100 * own, 100 * differ);
      if (own_moved > 1e-6) figures.own.off.push_back(own);
      if (moved > 1e-6 && differ < 0.02) figures.alike.off.push_back(off);
    }
    std::printf("%s %s, frames 2-%d\n  alike: %s\n  own:   %s\n", scene.c_str(), more[1].c_str(),
                last - 1, figures.alike.text().c_str(), figures.own.text().c_str());
    std::fflush(stdout);
    return figures;
  }
};

const Words fem{"--method", "fem", "--triangles", "600"}, hybrid{"--method", "hybrid"};

// What is not within 5 % on fem: the first frames, where a flat sheet buckles as the root of time;
// the frames round 24 of S8, where one motion ends and another begins within a frame; and snaps. On
// hybrid also frames of a crumple, whose folds go elsewhere on another mesh (most of S4). What
// other meshes move is spread over many frames.

TEST_F(VelocityTest, TheStripIsHalfAFrameLaterWhereItsVelocitySays) {
  for (const Words& method : {fem, hybrid}) {
    const Figures figures = compare("S2_moebius", method, 44);
    ASSERT_EQ(figures.own.off.size(), 42u);
    EXPECT_GE(figures.own.within(), 34);
    EXPECT_GE(figures.alike.off.size(), 25u);  // and there the two bakes agree
    EXPECT_GE(figures.alike.within(), 0.85 * figures.alike.off.size());
  }
}

TEST_F(VelocityTest, TheConeIsHalfAFrameLaterWhereItsVelocitySays) {
  const Figures smooth = compare("S8_dcone", fem, 44), exchanged = compare("S8_dcone", hybrid, 44);
  EXPECT_GE(smooth.own.within(), 26);
  EXPECT_GE(smooth.alike.within(), 20);
  EXPECT_LE(exchanged.own.median(), 0.03);
  EXPECT_GE(exchanged.own.within(), 28);
}

TEST_F(VelocityTest, TheCrumpleIsHalfAFrameLaterWhereItsVelocitySays) {
  const Figures smooth = compare("S4_crumple", fem, 36),
                exchanged = compare("S4_crumple", hybrid, 36);
  EXPECT_GE(smooth.own.within(), 32);
  // vertices slide on the pattern, and at twice the frame rate they slide in other steps
  EXPECT_LE(exchanged.own.median(), 0.25);
}

}  // namespace
}  // namespace paperbake
