// Flags: how long the waves are that wind makes on a sheet, and the meshes on which it can wave.

#include "core/animation/flutter.h"

#include "core/animation/animate.h"
#include "core/geometry/point_location.h"
#include "core/methods/hybrid.h"
#include "tests/core/animation/together_shots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

namespace paperbake {
namespace {

constexpr double density = 1.2;               // [kg/m3] of air
constexpr double length = 0.3, height = 0.2;  // [m] of the flag
const Vector3d along(1, 0, 0), up(0, 0, 1);

/// A sheet in a vertical plane from its left edge, which a pole holds, along x. One frame of keys.
Shot flag() {
  Shot shot = test::placed(length, height, Vector3d::Zero(), along, up);
  for (const double v : {0.0, height / 2, height})
    test::hold(shot, {0, v}, 1, test::stays, Vector3d::Zero(), along, up);
  return shot;
}

Air blowing(const Vector3d& velocity) {
  Wind wind;
  wind.name = "wind";
  wind.velocity.resize(1, 3);
  wind.velocity.row(0) = velocity.transpose();
  return {density, {wind}, 24};
}

/// [1/s] Growth of the wave exp(i k s + r t): the larger real part of the roots r of
/// rho r^2 + P/U r + D k^4 + i P k = 0.
double growth(const Paper& paper, double speed, double k) {
  const double pressure = drag_across * density / 2 * speed * speed, damping = pressure / speed;
  const std::complex<double> rest(paper.bending_stiffness * std::pow(k, 4), pressure * k);
  const std::complex<double> root = std::sqrt(damping * damping - 4 * paper.area_density * rest);
  return std::max((-damping + root).real(), (-damping - root).real()) / (2 * paper.area_density);
}

TEST(FlutterTest, NoWaveGrowsFaster) {
  for (const double speed : {0.5, 3.0, 10.0}) {
    Paper paper;
    const double best = 2 * M_PI / flutter_wavelength(paper, density, speed);
    EXPECT_GT(growth(paper, speed, best), 0) << speed;
    for (double k = 0.02 * best; k < 20 * best; k *= 1.02)
      EXPECT_LE(growth(paper, speed, k), growth(paper, speed, best) + 1e-9) << speed << " " << k;
  }
}

TEST(FlutterTest, WavesGrowDownToALengthThatTheAirDoesNotDecide) {
  const Paper paper;
  const double speed = 4, shortest = 2 * M_PI / speed *
                                     std::sqrt(paper.bending_stiffness / paper.area_density);
  EXPECT_GT(growth(paper, speed, 2 * M_PI / (1.01 * shortest)), 0);
  EXPECT_LT(growth(paper, speed, 2 * M_PI / (0.99 * shortest)), 0);
  EXPECT_GT(flutter_wavelength(paper, density, speed), shortest);
}

TEST(FlutterTest, OnlyASheetThatStreamsFromALineIsAFlag) {
  EXPECT_DOUBLE_EQ(speed_along_flag(flag(), blowing({4, 2, 0}), 1), 4);
  EXPECT_EQ(speed_along_flag(flag(), blowing({2, 4, 0}), 1), 0);    // from the side
  EXPECT_EQ(speed_along_flag(flag(), blowing({-4, 0, 0}), 1), 0);   // towards the pole
  EXPECT_EQ(speed_along_flag(flag(), Air{density, {}, 24}, 1), 0);  // still air
  Shot pinned = flag();
  test::hold(pinned, {length, 0}, 1, test::stays, Vector3d::Zero(), along, up);
  EXPECT_EQ(speed_along_flag(pinned, blowing({4, 0, 0}), 1), 0);
  Shot by_its_middle = flag();
  for (Handle& handle : by_its_middle.handles) {
    handle.pattern.x() = length / 2;
    handle.keyed.col(0).setConstant(length / 2 - 1e-9);
  }
  EXPECT_EQ(speed_along_flag(by_its_middle, blowing({4, 0, 0}), 1), 0);
  Shot let_go = flag();
  let_go.handles.clear();
  EXPECT_EQ(speed_along_flag(let_go, blowing({4, 0, 0}), 1), 0);
}

// The control of a relative handle may stand anywhere.
TEST(FlutterTest, AFlagStreamsFromWhereItIsHeld) {
  Shot shot = flag();
  for (Handle& handle : shot.handles) {
    handle.mode = HandleMode::relative;
    handle.keyed.col(0).array() += 0.5;
  }
  EXPECT_DOUBLE_EQ(speed_along_flag(shot, blowing({4, 2, 0}), 1), 4);
}

TEST(FlutterTest, TheHighestSpeedOfTheShotCounts) {
  Air air = blowing({1, 0, 0});
  air.winds.front().velocity.conservativeResize(3, 3);
  air.winds.front().velocity.bottomRows(2) << 5, 0, 0, 2, 0, 0;
  EXPECT_DOUBLE_EQ(speed_along_flag(flag(), air, 1), 5);
  air.winds.push_back(blowing({0.5, 0, 0}).winds.front());
  EXPECT_DOUBLE_EQ(speed_along_flag(flag(), air, 1), 5.5);
}

AnimateOptions in_the_wind(const Vector3d& velocity, int frames) {
  AnimateOptions options;
  options.first_frame = 1;
  options.last_frame = frames;
  options.elastic.inertia = Inertia::dynamic;
  options.elastic.forces.gravity = 9.81;
  options.elastic.air = blowing(velocity);
  return options;
}

/// What a test looks at in a frame.
struct Seen {
  int frame, triangles, doublings;
  bool converged;
  std::string note;
};
std::vector<Seen> frames_of(const Shot& shot, const AnimateOptions& options) {
  std::vector<Seen> seen;
  animate(shot, test::small_hybrid(shot, 0), options, [&](const AnimatedFrame& f) {
    seen.push_back({f.frame, static_cast<int>(f.sheet->triangles.rows()), f.statistics.doublings,
                    f.statistics.converged, f.note});
    return true;
  });
  return seen;
}

TEST(FlutterTest, AFlagBeginsOnAMeshOnWhichItCanWaveAndSaysSo) {
  const Seen fine = frames_of(flag(), in_the_wind({4, 0.5, 0}, 1)).front(),
             coarse = frames_of(flag(), in_the_wind({0.5, 4, 0}, 1)).front();
  EXPECT_EQ(fine.doublings, 2);
  EXPECT_EQ(coarse.doublings, 0);
  EXPECT_GT(fine.triangles, 3 * coarse.triangles);
  EXPECT_NE(fine.note.find("4 times as many triangles: on fewer a flag waves less"),
            std::string::npos)
      << fine.note;
}

// Its free edge whips round by more than Newton's method finds in 1/96 s.
TEST(FlutterTest, StepsOfAFlagConverge) {
  for (const Seen& seen : frames_of(flag(), in_the_wind({6, 1.5, 0}, 10)))
    EXPECT_TRUE(seen.converged) << seen.frame;
}

// Steps of 1/256 s are the shortest there are: what has not converged then stands.
TEST(FlutterTest, NoFrameIsGivenUpBecauseAStepHasNotConverged) {
  AnimateOptions options = in_the_wind({6, 1.5, 0}, 4);
  options.fps = 1;
  options.elastic.air.fps = 1;
  for (const Seen& seen : frames_of(flag(), options))
    EXPECT_EQ(seen.note.find("cannot follow"), std::string::npos) << seen.frame << seen.note;
}

/// [m] Standard deviation of the middle of the free edge across the wind, over frames 13 to 48.
double sway(const MethodChoice& method) {
  const Shot shot = flag();
  std::vector<double> across;
  animate(shot, method, in_the_wind({4, 1, 0}, 48), [&](const AnimatedFrame& f) {
    const PointLocator locator(f.sheet->pattern, f.sheet->triangles);
    if (f.frame > 12)
      across.push_back(
          interpolate(locator.locate({length, height / 2}), f.sheet->triangles, f.sheet->x).y());
    return true;
  });
  double sum = 0, squares = 0;
  for (const double y : across) {
    sum += y;
    squares += y * y;
  }
  const double mean = sum / across.size();
  return std::sqrt(squares / across.size() - mean * mean);
}

TEST(FlutterTest, AFlagWavesFartherThanOnTheMeshItWouldHaveInStillAir) {
  const Shot shot = flag();
  CrumpleOptions coarse;
  coarse.max_first_triangles = coarse.max_triangles = 120;
  const double here = sway(hybrid(shot.pattern, shot.paper, 120, {}, 1, 0)),
               board = sway(hybrid(shot.pattern, shot.paper, 120, coarse, 1, 0));
  EXPECT_GT(here, 2 * board) << board;
}

}  // namespace
}  // namespace paperbake
