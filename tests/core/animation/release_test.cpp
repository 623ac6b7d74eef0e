// What a sheet does when hands let go of it: whether it springs, and that it comes to rest.

#include "core/animation/swing.h"
#include "core/geometry/collider.h"
#include "core/geometry/measure.h"
#include "core/methods/fem.h"
#include "core/methods/hybrid.h"
#include "tests/core/animation/together_shots.h"
#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace paperbake {
namespace {

using test::Outcome;
using test::small_hybrid;

constexpr int let_go = 24;

MethodChoice coarse_fem(const Shot&, std::size_t) { return fem(80); }

/// A strip whose two ends are held by two points each; in frames 1 to 16 the right end comes nearer
/// by a tenth of its length and up by `lift`, and in frame 24 it is let go.
Shot bent_strip(double length, int frames, double lift = 0.2) {
  const Vector3d x(1, 0, 0), y(0, 1, 0);
  Shot shot = test::placed(length, length / 4, Vector3d::Zero(), x, y);
  for (const double u : {0.0, 0.1, 0.9, 1.0})
    for (const double v : {0.0, 0.25}) {
      const bool right = u > 0.5;
      test::hold(
          shot, {u * length, v * length}, frames,
          [=](int f) -> Vector3d {
            const double t = std::min(1.0, f / 15.0) * (right ? length : 0);
            return {-0.1 * t, 0, lift * t};
          },
          Vector3d::Zero(), x, y);
      if (right) shot.handles.back().release_frame = let_go;
    }
  return shot;
}

AnimateOptions until(int last_frame) {
  AnimateOptions options;
  options.last_frame = last_frame;
  options.release_inertia = ReleaseInertia::automatic;
  options.elastic.air.density = 1.2;
  return options;
}

/// How far the corner that was held last goes in each frame. [m]
std::vector<double> moves(const Outcome& outcome) {
  const std::vector<AnimatedFrame>& frames = outcome.frames[0];
  std::vector<double> all{0};
  for (std::size_t f = 1; f < frames.size(); ++f)
    all.push_back((frames[f].handles.back().at - frames[f - 1].handles.back().at).norm());
  return all;
}

TEST(SwingTest, TheRateOfAClampedStripIsThatOfACantilever) {
  // Released from a load at its tip: Rayleigh's quotient of that shape, x^2 (3L - x), is
  // w = sqrt(140/11) sqrt(D/rho)/L^2, 1.5 % above the exact 3.516.
  constexpr double length = 0.2, height = 0.01;
  Sheet strip = test::hex_sheet(length, 0.05, 20);
  Paper paper;
  paper.poisson = 0;
  Elastic elastic(paper, {});
  elastic.set_mesh(strip);
  PositionConstraints clamped, lifted;
  for (int v = 0; v < strip.x.rows(); ++v)
    if (strip.pattern(v, 0) < 0.011)
      clamped.push_back({v, strip.x.row(v)});
    else if (strip.pattern(v, 0) > length - 1e-6)
      lifted.push_back(
          {v, strip.x.row(v) + Eigen::RowVector3d(-3 * height * height / length / 5, 0, height)});
  ASSERT_GT(lifted.size(), 2u);
  lifted.insert(lifted.end(), clamped.begin(), clamped.end());
  for (int k = 0; k < 3; ++k) elastic.step(strip, {lifted}, 1);
  const Points3 bent = strip.x;
  const double before = elastic.evaluate_energies(strip).potential;
  for (int k = 0; k < 3; ++k) elastic.step(strip, {clamped}, 1);
  const double freed = before - elastic.evaluate_energies(strip).potential;
  const Swing swing = swing_to(strip, bent, vertices_of(clamped), freed, paper.area_density);
  EXPECT_NEAR(swing.amplitude, height, 0.05 * height);
  double free_length = 0;
  for (const PositionConstraint& c : clamped)
    free_length = std::max(free_length, strip.pattern(c.vertex, 0));
  free_length = length - free_length;
  const double beam = std::sqrt(140 / 11.0 * paper.bending_stiffness / paper.area_density) /
                      (free_length * free_length);
  EXPECT_NEAR(swing.rate / beam, 1, 0.05);
}

TEST(SwingTest, ARigidMotionIsNoSwing) {
  const Sheet sheet = test::hex_sheet(0.1, 0.1, 4);
  Sheet moved = sheet;
  const Eigen::AngleAxisd turn(0.7, Vector3d(1, 2, 3).normalized());
  moved.x =
      (sheet.x * turn.toRotationMatrix().transpose()).rowwise() + Eigen::RowVector3d(0.1, 0.2, 0.3);
  EXPECT_LT(swing_to(moved, sheet.x, {}, 1, 0.07).amplitude, 1e-12);
  moved.x = sheet.x;  // about a line that is held
  std::vector<int> line;
  for (int v = 0; v < sheet.x.rows(); ++v) {
    if (sheet.pattern(v, 0) < 1e-9) line.push_back(v);
    moved.x.row(v) << 0.8 * sheet.x(v, 0), sheet.x(v, 1), 0.6 * sheet.x(v, 0);
  }
  ASSERT_GT(line.size(), 1u);
  EXPECT_LT(swing_to(moved, sheet.x, line, 1, 0.07).amplitude, 1e-4);
  const int corner = static_cast<int>(sheet.x.rows()) - 1;
  moved.x.row(corner) += Eigen::RowVector3d(0, 0, 0.01);
  EXPECT_NEAR(swing_to(moved, sheet.x, line, 1, 0.07).amplitude, 0.01, 0.002);
}

TEST(ReleaseTest, ABentStripTakesSeveralFrames) {
  for (const auto method : {coarse_fem, small_hybrid}) {
    const Shot shot = bent_strip(0.28, 40);
    AnimateOptions options = until(40), off = options;
    off.release_inertia = ReleaseInertia::off;
    const Outcome sprung = test::outcome_of({shot}, method, options),
                  popped = test::outcome_of({shot}, method, off);
    const double way = moves(popped)[let_go - 1];
    ASSERT_GT(way, 0.04) << "it is there within one frame";
    const std::vector<double> springs = moves(sprung);
    EXPECT_LT(*std::max_element(springs.begin() + let_go - 1, springs.end()), 0.6 * way);
    for (int f = 0; f + 1 < let_go; ++f)
      ASSERT_TRUE(sprung.shapes[0][f].x == popped.shapes[0][f].x) << "before, nothing changes";
    EXPECT_FALSE(sprung.frames[0][let_go - 2].statistics.inertia);
    EXPECT_TRUE(sprung.frames[0][let_go - 1].statistics.inertia);
    EXPECT_NE(sprung.frames[0][let_go - 1].note.find("let go"), std::string::npos);
  }
}

TEST(ReleaseTest, AStripSpringsOnAnyMesh) {
  // Curled over at one end. The finer the mesh, the shorter is the first step of the trial,
  // although it converges.
  constexpr int frames = 26;
  const Vector3d x(1, 0, 0), y(0, 1, 0), origin = Vector3d::Zero();
  Shot shot = test::placed(0.2, 0.04, origin, x, y);
  for (const Vector2d& p : {Vector2d(0.005, 0.005), Vector2d(0.005, 0.035), Vector2d(0.03, 0.02)})
    test::hold(shot, p, frames, test::stays, origin, x, y);
  for (const double v : {0.008, 0.032}) {
    test::hold(
        shot, {0.194, v}, frames,
        [](int f) {
          const double t = std::min(1.0, f / 16.0);
          return Vector3d(-0.1 * t, 0, 0.05 * std::sin(0.8 * M_PI * t));
        },
        origin, x, y);
    shot.handles.back().release_frame = let_go;
  }
  AnimateOptions options = until(frames);
  options.elastic.forces.gravity = 9.81;
  for (const int triangles : {80, 1700}) {
    const auto on = [=](const Shot&, std::size_t) -> MethodChoice { return fem(triangles); };
    const Outcome sprung = test::outcome_of({shot}, on, options);
    EXPECT_TRUE(sprung.frames[0][let_go - 1].statistics.inertia) << triangles;
  }
}

TEST(ReleaseTest, ASheetThatWasLetGoComesToRestAndFallsAsleep) {
  for (const auto method : {coarse_fem, small_hybrid}) {
    constexpr int frames = 400;
    const Shot shot = bent_strip(0.16, frames);
    AnimateOptions options = until(frames), off = options;
    off.release_inertia = ReleaseInertia::off;
    const Outcome sprung = test::outcome_of({shot}, method, options),
                  popped = test::outcome_of({shot}, method, off);
    const auto& seen = sprung.frames[0];
    ASSERT_TRUE(seen[let_go - 1].statistics.inertia);
    int rest = let_go;
    while (rest < frames && seen[rest].statistics.inertia) ++rest;
    ASSERT_LT(rest, frames - 12) << "it comes to rest";
    // what a change of mesh moves, too
    EXPECT_LT(moves(sprung)[rest], 2e-3 * 0.16) << "which does not move it";
    EXPECT_EQ(seen.back().statistics.substeps, 0) << "and falls asleep";
    EXPECT_LT((seen.back().handles.back().at - popped.frames[0].back().handles.back().at).norm(),
              2e-3 * 0.16)
        << "where it is without inertia";
  }
}

TEST(ReleaseTest, ASmallStiffSheetIsThereWithinAFrame) {
  // The 45 mm that are let go swing 17 times a second.
  const Shot shot = bent_strip(0.05, 40);
  AnimateOptions options = until(40), off = options;
  off.release_inertia = ReleaseInertia::off;
  const Outcome with = test::outcome_of({shot}, coarse_fem, options),
                without = test::outcome_of({shot}, coarse_fem, off);
  ASSERT_GT(moves(without)[let_go - 1], 0.005);
  for (int f = 0; f < 40; ++f) {
    EXPECT_FALSE(with.frames[0][f].statistics.inertia) << f;
    ASSERT_TRUE(with.shapes[0][f].x == without.shapes[0][f].x) << f;
  }
}

TEST(ReleaseTest, TheSameSpringAtEveryFrameRate) {
  // 0.1 s after it was let go, whatever the length of a frame
  std::vector<Points3> shapes;
  for (const int fps : {12, 24, 48, 120}) {
    const int last = fps / 2 + (fps + 5) / 10 + 1;
    Shot shot = bent_strip(0.28, last);
    for (Handle& handle : shot.handles) {
      for (int f = 0; f < last; ++f) {
        const double t = std::min(1.0, 3.0 * f / fps);
        const bool right = handle.pattern.x() > 0.14;
        handle.keyed.row(f) << handle.pattern.x() - (right ? 0.028 * t : 0), handle.pattern.y(),
            right ? 0.056 * t : 0;
      }
      if (handle.pattern.x() > 0.14) handle.release_frame = fps / 2 + 1;
    }
    AnimateOptions options = until(last);
    options.fps = fps;
    const Outcome seen = test::outcome_of({shot}, coarse_fem, options);
    EXPECT_TRUE(seen.frames[0].back().statistics.inertia) << fps;
    shapes.push_back(seen.shapes[0].back().x);
  }
  for (std::size_t k = 1; k < shapes.size(); ++k)
    EXPECT_LT(max_row_norm(shapes[k] - shapes[0]), 0.1 * 0.28) << k;
}

TEST(ReleaseTest, ASheetModelledInAShapeThatDoesNotBearItsWeightTakesSeveralFrames) {
  // held level by six points at one end; 0.2 m stand out
  constexpr int frames = 130;
  const Vector3d x(1, 0, 0), y(0, 1, 0), origin = Vector3d::Zero();
  Shot shot = test::placed(0.24, 0.08, origin, x, y);

  for (const double u : {0.0, 0.04})
    for (const double v : {0.0, 0.04, 0.08})
      test::hold(shot, {u, v}, frames, test::stays, origin, x, y);
  const auto fine_fem = [](const Shot&, std::size_t) -> MethodChoice { return fem(200); };
  AnimateOptions options = until(frames);
  options.elastic.forces.gravity = 9.81;
  const auto farthest_in_a_frame = [](const Outcome& outcome) {
    double most = 0;
    for (std::size_t f = 1; f < outcome.shapes[0].size(); ++f)
      most = std::max(most, max_row_norm(outcome.shapes[0][f].x - outcome.shapes[0][f - 1].x));
    return most;
  };
  const Outcome falls = test::outcome_of({shot}, fine_fem, options);
  options.release_inertia = ReleaseInertia::off;
  const Outcome drops = test::outcome_of({shot}, fine_fem, options);
  ASSERT_GT(farthest_in_a_frame(drops), 0.08) << "without inertia it is there within one frame";
  EXPECT_LT(farthest_in_a_frame(falls), 0.5 * farthest_in_a_frame(drops));
  EXPECT_NE(falls.frames[0][1].note.find("does not bear its weight"), std::string::npos);
  EXPECT_LT(max_row_norm(falls.shapes[0].back().x - drops.shapes[0].back().x), 2e-3)
      << "it swings about the same equilibrium";

  // no mesh that it gets on its way makes it swing, either
  const auto on_changing_meshes = [](const Shot& s, std::size_t) {
    return hybrid(s.pattern, s.paper, 120, {}, 0, 0);
  };
  options.release_inertia = ReleaseInertia::automatic;
  const Outcome sinks = test::outcome_of({shot}, on_changing_meshes, options);
  std::vector<Vector3d> tip;  // [m]
  bool has_other_mesh = false;
  for (const Sheet& sheet : sinks.shapes[0]) {
    const Points2& pattern = sheet.pattern;
    has_other_mesh |= !same_entries(pattern, sinks.shapes[0].front().pattern);
    for (int v = 0; v < pattern.rows(); ++v)
      if ((pattern.row(v) - Eigen::RowVector2d(0.24, 0)).norm() < 1e-9)
        tip.emplace_back(sheet.x.row(v));
  }
  ASSERT_EQ(tip.size(), sinks.shapes[0].size());
  EXPECT_TRUE(has_other_mesh);
  bool arrived = false;
  for (const Vector3d& at : tip) {
    const double left = (at - tip.back()).norm();
    EXPECT_TRUE(!arrived || left < 5e-3) << left;
    arrived |= left < 2e-3;
  }

  // modelled as it hangs, it stays
  shot.start = drops.shapes[0].back();
  const Outcome hangs = test::outcome_of({shot}, fine_fem, options);
  EXPECT_LT(farthest_in_a_frame(hangs), 5e-3 * 0.24);
  for (const AnimatedFrame& frame : hangs.frames[0]) ASSERT_FALSE(frame.statistics.inertia);
}

TEST(ReleaseTest, AnUprightPageThatLosesItsBalanceFallsAsFastAsItsWeightTakesIt) {
  // A4, upright, held by four points at its lower left corner, which go to and fro after a while:
  // until then nothing disturbs its balance
  constexpr int frames = 48;
  const Vector3d x(1, 0, 0), z(0, 0, 1), origin = Vector3d::Zero();
  Shot shot = test::placed(0.21, 0.297, origin, x, z);
  for (const double u : {0.004, 0.03})
    for (const double v : {0.004, 0.06})
      test::hold(
          shot, {u, v}, frames,
          [](int f) { return Vector3d(0, 2e-3 * std::sin(0.2 * std::max(0, f - 10)), 0); }, origin,
          x, z);
  const auto farthest_in_a_frame = [](const Outcome& outcome) {
    double most = 0;
    for (std::size_t f = 1; f < outcome.shapes[0].size(); ++f) {
      const Sheet &now = outcome.shapes[0][f], &before = outcome.shapes[0][f - 1];
      // the corner that is farthest from the hand, whatever the mesh
      const auto corner = [](const Sheet& sheet) {
        Eigen::Index at = 0;
        sheet.pattern.rowwise().norm().maxCoeff(&at);
        return Vector3d(sheet.x.row(at));
      };
      most = std::max(most, (corner(now) - corner(before)).norm());
    }
    return most;
  };
  for (const double fps : {24.0, 48.0}) {
    AnimateOptions options = until(frames);
    options.fps = fps;
    options.elastic.forces.gravity = 9.81;
    const Outcome falls = test::outcome_of({shot}, small_hybrid, options);
    options.release_inertia = ReleaseInertia::off;
    const Outcome drops = test::outcome_of({shot}, small_hybrid, options);
    ASSERT_GT(farthest_in_a_frame(drops), 0.2) << "without inertia it is there within one frame";
    // nothing that turns about the hand falls faster than from twice its own height
    EXPECT_LT(farthest_in_a_frame(falls), std::sqrt(2 * 9.81 * 2 * 0.36) / fps);
    bool told = false;
    for (const AnimatedFrame& frame : falls.frames[0])
      told |= frame.note.find("loses its balance") != std::string::npos;
    EXPECT_TRUE(told);
  }
}

TEST(ReleaseTest, ASheetThatIsLetGoWhileItSinksSwings) {
  // held level along 6 cm; from frame 4 on, when it is on its way down, along 4 cm
  constexpr int frames = 72;
  const Vector3d x(1, 0, 0), y(0, 1, 0), origin = Vector3d::Zero();
  Shot shot = test::placed(0.24, 0.08, origin, x, y);
  for (const double u : {0.0, 0.04, 0.06})
    for (const double v : {0.0, 0.04, 0.08}) {
      test::hold(shot, {u, v}, frames, test::stays, origin, x, y);
      if (u > 0.05) shot.handles.back().release_frame = 4;
    }
  AnimateOptions options = until(frames);
  options.elastic.forces.gravity = 9.81;
  const auto fine_fem = [](const Shot&, std::size_t) -> MethodChoice { return fem(200); };
  const Outcome seen = test::outcome_of({shot}, fine_fem, options);
  EXPECT_NE(seen.frames[0][1].note.find("does not bear its weight"), std::string::npos);
  std::vector<double> height;  // [m] of its end
  for (const Sheet& sheet : seen.shapes[0]) height.push_back(sheet.x.col(2).minCoeff());
  int turns = 0;
  for (std::size_t f = 2; f < height.size(); ++f)
    turns += (height[f] - height[f - 1]) * (height[f - 1] - height[f - 2]) < 0;
  EXPECT_GE(turns, 3);
  EXPECT_LT(*std::min_element(height.begin(), height.end()), height.back() - 2e-3);
}

TEST(ReleaseTest, ASheetSpringsOntoATableAndGoesOnFromAState) {
  Shot shot = bent_strip(0.28, 60);
  ColliderMesh table{"table", Points3(4, 3), Triangles(2, 3), {}};
  table.x << -1, -1, -0.002, 1, -1, -0.002, 1, 1, -0.002, -1, 1, -0.002;
  table.triangles << 0, 1, 2, 0, 2, 3;
  shot.colliders = std::make_shared<Colliders>(Colliders{Collider(table)});
  AnimateOptions options = until(60);
  options.elastic.forces.gravity = 1;
  std::vector<std::string> states;
  std::vector<Points3> shapes;
  const MethodChoice method = small_hybrid(shot, 0);
  bool springs = false, lies = false;
  const auto keep = [&](const AnimatedFrame& f) {
    springs |= f.statistics.inertia;
    lies |= f.statistics.on_colliders > 0;
    states.push_back(f.state());
    shapes.push_back(f.sheet->x);
    return true;
  };
  animate(shot, method, options, keep);
  ASSERT_TRUE(springs);
  ASSERT_TRUE(lies);
  const std::vector<Points3> whole = shapes;
  for (const int from : {let_go - 1, let_go, let_go + 7}) {
    options.resume_state = states[from - 1];
    shapes.clear();
    const std::vector<std::string> kept = states;
    animate(shot, method, options, keep);
    states = kept;
    ASSERT_EQ(shapes.size(), whole.size() - from);
    for (std::size_t k = 0; k < shapes.size(); ++k)
      ASSERT_TRUE(shapes[k] == whole[from + k]) << from << " " << k;
  }
}

}  // namespace
}  // namespace paperbake
