// --dynamics auto: inertia is switched on where a sheet falls, swings or is thrown, and nowhere
// else. What it computes is compared with closed forms.

#include "core/animation/inertia_need.h"
#include "core/methods/adaptive.h"
#include "core/methods/fem.h"
#include "core/methods/hybrid.h"
#include "formats/scene/scene_file.h"
#include "tests/core/animation/together_shots.h"
#include "tests/formats/scene/gltf_fixture.h"

#include <gtest/gtest.h>

#include <cmath>

namespace paperbake {
namespace {

using test::GltfFixture;

constexpr double g = 9.81;

Shot shot_of(const Scene& scene) {
  const SceneSheet& s = scene.sheets.front();
  return {s.name, s.pattern, s.start, s.handles, Paper{}};
}

InertiaNeed need_in(const Scene& scene, double gravity) {
  return need_of_inertia(shot_of(scene), {gravity}, scene.fps, scene.first_frame, scene.last_frame);
}

/// A sheet of 20 x 10 cm held by a row of handles along its short side at x = 0. `bend` is its
/// start shape; the handles move along `way`.
Scene held_by_an_edge(const std::string& name, const std::function<Vector3d(double, double)>& bend,
                      const std::vector<Vector3d>& way, const std::string& extras = "{}") {
  GltfFixture file;
  file.mesh("paper", test::grid(8, 4, 0.2, 0.1, nullptr, bend));
  for (int k = 0; k < 5; ++k) {
    const Vector3d at(0, 0.025 * k, 0);
    const int node = file.node("handle." + std::to_string(k), at, extras);
    std::vector<int> frames;
    std::vector<Vector3d> places;
    for (std::size_t f = 0; f < way.size(); ++f) {
      frames.push_back(static_cast<int>(f));
      places.push_back(at + way[f]);
    }
    file.move(node, frames, places);
  }
  return read_scene(file.write(name + ".gltf"));
}

Vector3d flat(double u, double v) { return {u, v, 0}; }
Vector3d hanging(double u, double v) { return {0, v, -u}; }
std::vector<Vector3d> still(int frames) { return std::vector<Vector3d>(frames, Vector3d::Zero()); }
std::vector<Vector3d> steady(int frames, const Vector3d& all_the_way) {
  std::vector<Vector3d> way;
  for (int f = 0; f < frames; ++f) way.push_back(all_the_way * f / (frames - 1));
  return way;
}

/// The middle of the far edge in every frame. [m]
std::vector<Vector3d> far_edge(const Shot& shot, const MethodChoice& method, Inertia inertia,
                               int last_frame) {
  AnimateOptions options;
  options.last_frame = last_frame;
  options.elastic.forces.gravity = g;
  options.elastic.inertia = inertia;
  std::vector<Vector3d> path;
  animate(shot, method, options, [&](const AnimatedFrame& f) {
    Vector3d sum = Vector3d::Zero();
    int n = 0;
    for (int v = 0; v < f.sheet->x.rows(); ++v)
      if (f.sheet->pattern(v, 0) > 0.2 - 1e-6) {
        sum += f.sheet->x.row(v).transpose();
        ++n;
      }
    path.push_back(sum / n);
    return true;
  });
  return path;
}

TEST(InertiaTest, AReleasedSheetNeedsInertiaOnlyUnderGravity) {
  const Scene scene = held_by_an_edge("let_go", flat, still(24), R"({"paper_release_frame":6})");
  EXPECT_TRUE(need_in(scene, g).needed);
  // before it is released
  EXPECT_NE(need_in(scene, g).why.find("swings"), std::string::npos) << need_in(scene, g).why;
  EXPECT_FALSE(need_in(scene, 0).needed);
  GltfFixture free;
  free.mesh("paper", test::grid(4, 4, 0.2, 0.2));
  const int node = free.node("handle.a", {0, 0, 0}, R"({"paper_release_frame":2})");
  free.move(node, {0, 11}, {{0, 0, 0}, {0, 0, 0}});
  Shot shot = shot_of(read_scene(free.write("free.gltf")));
  shot.handles.clear();
  EXPECT_NE(need_of_inertia(shot, {g}, 24, 1, 12).why.find("falls"), std::string::npos);
  EXPECT_NE(need_of_inertia(shot, {0}, 24, 1, 12).why.find("no weight"), std::string::npos);
}

TEST(InertiaTest, ASheetHeldByOneEdgeSwingsUnlessItHangsAndIsCarriedSlowly) {
  EXPECT_TRUE(need_in(held_by_an_edge("swing", flat, still(24)), g).needed);
  const InertiaNeed rest = need_in(held_by_an_edge("rest", hanging, still(24)), g);
  EXPECT_FALSE(rest.needed);
  EXPECT_NE(rest.why.find("hangs"), std::string::npos) << rest.why;
  EXPECT_FALSE(need_in(held_by_an_edge("slow", hanging, steady(240, {0.02, 0, 0})), g).needed);
  EXPECT_TRUE(need_in(held_by_an_edge("fast", hanging, steady(12, {0.5, 0, 0})), g).needed);
}

TEST(InertiaTest, AHangingSheetThatAColliderStrikesSwings) {
  Shot shot = shot_of(held_by_an_edge("struck", hanging, still(24)));
  const auto need_with = [&](const Vector3d& begin, const Vector3d& each_frame) {
    ColliderMesh ball;
    ball.name = "collider.ball";
    ball.x.resize(4, 3);
    ball.x << 0, 0, 0, 0.02, 0, 0, 0, 0.02, 0, 0, 0, 0.02;
    ball.x.rowwise() += begin.transpose();
    ball.triangles.resize(4, 3);
    ball.triangles << 0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3;
    if (!each_frame.isZero())
      for (int f = 0; f < 24; ++f)
        ball.frames.own().emplace_back(ball.x.rowwise() + f * each_frame.transpose());
    shot.colliders = std::make_shared<const Colliders>(Colliders{Collider(ball)});
    return need_of_inertia(shot, {g}, 24, 0, 23);
  };
  const InertiaNeed struck = need_with({-0.1, 0.04, -0.1}, {0.02, 0, 0});
  EXPECT_TRUE(struck.needed);
  EXPECT_NE(struck.why.find("collider.ball"), std::string::npos) << struck.why;
  EXPECT_FALSE(need_with({-0.1, 0.04, -0.1}, {-0.02, 0, 0}).needed) << "it goes away";
  EXPECT_FALSE(need_with({-0.1, 0.3, -0.1}, {0.02, 0, 0}).needed) << "it goes by";
  EXPECT_FALSE(need_with({-0.005, 0.04, -0.1}, Vector3d::Zero()).needed) << "it stands still";
}

/// A table of 2 m at z = 0 that stands still until frame 60, and is then drawn 10 mm to one side
/// within 12 frames.
std::shared_ptr<const Colliders> drawn_table(int frames) {
  ColliderMesh table{"table", Points3(4, 3), Triangles(2, 3), {}};
  table.x << -1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0;
  table.triangles << 0, 1, 2, 0, 2, 3;
  table.friction = 0.4;
  for (int f = 0; f < frames; ++f)
    table.frames.own().emplace_back(table.x.rowwise() + std::clamp((f - 60) / 12.0, 0.0, 1.0) *
                                                            Eigen::RowVector3d(0.01, 0, 0));
  return std::make_shared<const Colliders>(Colliders{Collider(table)});
}

TEST(InertiaTest, SheetsThatLieOnATableFallAsleepAndAreTakenAlongWhenItMoves) {
  constexpr int frames = 90;
  const Vector3d x(1, 0, 0), y(0, 1, 0);
  std::vector<Shot> shots{test::placed(0.1, 0.1, {0, 0, 0.002}, x, y),
                          test::placed(0.08, 0.08, {0.01, 0.01, 0.004}, x, y)};
  for (Shot& shot : shots) {
    shot.colliders = drawn_table(frames);
    shot.paper.friction = 0.4;
  }
  AnimateOptions options;
  options.last_frame = frames;
  options.elastic.forces.gravity = g;
  options.elastic.inertia = Inertia::dynamic;
  const test::Outcome seen = test::outcome_of(
      shots, [](const Shot&, std::size_t) { return fem(60); }, options);
  for (std::size_t s = 0; s < shots.size(); ++s) {
    ASSERT_GT(seen.frames[s][3].statistics.substeps, 0);
    for (int f = 50; f < 60; ++f) EXPECT_EQ(seen.frames[s][f].statistics.substeps, 0) << s << f;
    EXPECT_GT(seen.frames[s][66].statistics.substeps, 0) << s << ": it is awake again";
    const Points3 way = seen.shapes[s].back().x - seen.shapes[s][59].x;
    EXPECT_LT((way.rowwise() - Eigen::RowVector3d(0.01, 0, 0)).rowwise().norm().maxCoeff(), 1e-4)
        << s << ": it has gone along, without sliding";
  }
}

TEST(InertiaTest, ASheetInABalanceOnNothingIsNotAsleep) {
  // Held at its lower edge, it stands upright, and for half a second it moves by less than sheets
  // do that fall asleep. Then it falls.
  const Scene scene = held_by_an_edge(
      "upright",
      [](double u, double v) -> Vector3d {
        return {1e-7 * u, v, u};
      },
      still(72));
  Shot shot = shot_of(scene);
  const std::vector<Vector3d> path = far_edge(shot, fem(60), Inertia::dynamic, 71);
  EXPECT_LT((path[10] - path[9]).norm(), 2e-6);
  EXPECT_LT(path.back().z(), 0.1);
}

TEST(InertiaTest, ASlowPushNeedsNoInertiaAndAWhipDoes) {
  const auto pushed = [](double fast) {
    GltfFixture file;
    file.mesh("paper", test::grid(4, 4, 0.1, 0.1));
    for (int k = 0; k < 4; ++k) {
      const Vector3d at(0.1 * (k % 2), 0.1 * (k / 2), 0);
      file.move(file.node("handle." + std::to_string(k), at), {0, 24},
                {at, at - Vector3d(k % 2 * fast * 0.01, 0, 0)});
    }
    return read_scene(file.write("pushed.gltf"));
  };
  const InertiaNeed slow = need_in(pushed(1), g), whip = need_in(pushed(300), 0);
  EXPECT_FALSE(slow.needed);
  EXPECT_GT(slow.sway, 1e-4);
  EXPECT_NEAR(whip.sway / need_in(pushed(1), 0).sway, 300, 1);  // the oscillator is linear
  EXPECT_TRUE(whip.needed) << whip.sway;
}

TEST(InertiaTest, ASceneWithoutGravityIsJudgedWithThatOfTheEarth) {
  // A corner of a floppy poster is carried over it in two seconds: without any gravity in the
  // estimate it would lag by more than a quarter.
  GltfFixture file;
  file.mesh("paper", test::grid(4, 4, 0.3, 0.4));
  for (const Vector3d& top : {Vector3d(0, 0.4, 0), Vector3d(0.3, 0.4, 0)})
    file.move(file.node("handle." + std::to_string(top.x()), top), {0, 48}, {top, top});
  file.move(file.node("handle.corner", {0.3, 0, 0}), {0, 12, 48},
            {{0.3, 0, 0}, {0.25, 0.08, 0.1}, {0.2, 0.2, 0.05}});
  const Scene scene = read_scene(file.write("poster.gltf"));
  const InertiaNeed none = need_in(scene, 0), some = need_in(scene, 0.01);
  EXPECT_FALSE(none.needed) << none.why;
  EXPECT_EQ(none.sway, need_in(scene, 9.81).sway);
  EXPECT_GT(some.sway, 0.25) << "a scene with little weight is taken at its word";
}

TEST(InertiaTest, TheSwayIsThatOfAnOscillatorWhoseBaseIsSetInMotion) {
  // The velocity jumps from 0 to v: r = v/w sin(w t), less what the damping of the solver takes in
  // a quarter of a period.
  const Shot shot = shot_of(held_by_an_edge("kick", hanging, steady(240, {1.0, 0, 0})));
  const double v = 1.0 / (239 / 24.0), l = 0.4;  // twice the 0.2 m of the paper
  const double w = std::sqrt(std::pow(M_PI, 4) * 2.7e-4 / (0.070 * std::pow(l, 4)) + g / l);
  const double sway = 0.2 * need_of_inertia(shot, {g}, 24, 1, 240).sway;
  EXPECT_LT(sway, v / w);
  EXPECT_GT(sway, 0.9 * v / w);
}

TEST(InertiaTest, ASwingingSheetHasThePeriodOfItsPendulum) {
  // A stiff card on a hinge, released 30 degrees from hanging, is a compound pendulum:
  // T = 2 pi sqrt(2 L/3g) (1 + a^2/16)
  const double a = M_PI / 6, L = 0.2;
  Shot shot = shot_of(held_by_an_edge(
      "pendulum",
      [&](double u, double v) { return Vector3d(u * std::sin(a), v, -u * std::cos(a)); },
      still(60)));
  shot.paper.bending_stiffness = 0.1;
  ASSERT_TRUE(need_of_inertia(shot, {g}, 24, 1, 60).needed);
  const double period = 2 * M_PI * std::sqrt(2 * L / (3 * g)) * (1 + a * a / 16);
  for (const MethodChoice& method :
       {fem(60), hybrid(shot.pattern, shot.paper, 60, {}, 0, 0), adaptive(shot.pattern, 200)}) {
    const std::vector<Vector3d> path = far_edge(shot, method, Inertia::dynamic, 60);
    std::vector<double> zeros;  // [s] when it passes below the hinge
    for (std::size_t f = 1; f < path.size(); ++f)
      if (path[f - 1].x() * path[f].x() < 0)
        zeros.push_back((f - 1 + path[f - 1].x() / (path[f - 1].x() - path[f].x())) / 24);
    double back = 0;  // [m] how far it swings to the other side
    for (std::size_t f = 0; f / 24.0 < period; ++f) back = std::max(back, -path[f].x());
    ASSERT_GE(zeros.size(), 2u) << method.name;
    EXPECT_NEAR((zeros[1] - zeros[0]) / (period / 2), 1, 0.01) << method.name;
    // backward Euler at 1/96 s takes 0.13, the damping of the velocity the rest
    EXPECT_NEAR(back / (L * std::sin(a)), 0.8, 0.05) << method.name;
  }
}

TEST(InertiaTest, ASheetThatNothingHoldsFallsLikeAStone) {
  Shot shot = shot_of(held_by_an_edge("stone", flat, still(13)));
  shot.handles.clear();
  const double fallen =
      -far_edge(shot, adaptive(shot.pattern, 200), Inertia::dynamic, 13).back().z();
  const double drag = -24 * std::log(0.98), t = 0.5;  // [1/s]; [s]
  const double falls = g / (drag * drag) * (drag * t - 1 + std::exp(-drag * t));
  EXPECT_LT(falls, 0.95 * 0.5 * g * t * t);
  // backward Euler in 48 steps: n(n+1)/2 instead of n^2/2
  EXPECT_NEAR(fallen / falls, 1 + 1 / 48.0, 0.005);
}

}  // namespace
}  // namespace paperbake
