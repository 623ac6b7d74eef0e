#include "core/animation/animate.h"
#include "core/model/segment2.h"

#include "core/animation/initial_sheet.h"
#include "core/geometry/collider.h"
#include "core/geometry/measure.h"
#include "core/methods/fem.h"
#include "core/model/error.h"
#include "tests/core/test_meshes.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace paperbake {
namespace {

struct Played {
  std::vector<Sheet> sheets;
  std::vector<AnimatedFrame> frames;
};

Played play(const Shot& shot, int triangles, int last_frame, double stop = 1e-5,
            double gravity = 0) {
  AnimateOptions options;
  options.last_frame = last_frame;
  options.elastic.stop = stop;
  options.elastic.forces.gravity = gravity;
  Played played;
  animate(shot, fem(triangles), options, [&](const AnimatedFrame& frame) {
    played.sheets.push_back(*frame.sheet);
    played.frames.push_back(frame);
    return true;
  });
  return played;
}

TEST(AnimateTest, ASheetPushedAndDrawnBackIsFlatAgain) {
  const Played played = play(test::s1_push(/*back=*/true), 600, 47);
  ASSERT_EQ(played.sheets.size(), 47u);
  // the arch of the elastica at 10 %
  EXPECT_NEAR(played.sheets[23].x.col(2).maxCoeff(), 0.019492, 1e-4);
  const auto z = played.sheets.back().x.col(2);
  EXPECT_LT(z.maxCoeff() - z.minCoeff(), 1e-4);
}

TEST(AnimateTest, TheSameSeedGivesTheSamePositionsToTheLastBit) {
  Shot shot = test::s1_push();
  shot.start = test::blank_shot(shot.pattern).start;  // flat: the seed chooses the side
  AnimateOptions options;
  options.last_frame = 6;
  const auto end = [&](unsigned seed) {
    options.seed = seed;
    Points3 x;
    animate(shot, fem(200), options, [&](const AnimatedFrame& frame) {
      x = frame.sheet->x;
      return true;
    });
    return x;
  };
  const Points3 one = end(1);
  ASSERT_GT(one.col(2).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_TRUE(one == end(1));
  EXPECT_FALSE(one == end(2));
}

TEST(AnimateTest, TheEnergyOfAFemArchConvergesWithTheSquareOfTheEdge) {
  // Scene S1, frame 24, all meshes against the finest one. The energy is compared because no
  // interpolation between meshes blurs it.
  const auto energy = [](int triangles) {
    return play(test::s1_push(), triangles, 24, 1e-7).frames.back().statistics.energy;
  };
  const double exact = 1.0126 * 2.7e-4;  // U L/(D W) of the elastica, times D W/L of a square sheet
  const double coarse = energy(200), fine = energy(800), finest = energy(3200);
  const double order = std::log2((coarse - fine) / (fine - finest));
  EXPECT_GT(order, 1.8) << coarse << " " << fine << " " << finest;
  EXPECT_NEAR(finest / exact, 1, 0.005);
}

TEST(AnimateTest, ARelativeHandleStartsFromWhereTheSheetIsAtItsGrabFrame) {
  const Played played = play(test::s1_push(), 300, 27);
  const std::size_t mid = 22;
  EXPECT_EQ(played.frames[22].handles[mid].state, HandleFrame::free);
  const Vector3d grabbed = played.frames[23].handles[mid].at;
  EXPECT_GT(grabbed.z(), 0.019);
  EXPECT_EQ(played.frames[23].handles[mid].state, HandleFrame::held);
  for (int f = 24; f < 27; ++f) {
    const Vector3d expected = grabbed - Vector3d(0, 0, 0.02 * (f - 23) / 36);
    EXPECT_LT((played.frames[f].handles[mid].at - expected).norm(), 1e-12);
    EXPECT_LT((played.frames[f].handles[mid].keyed - expected).norm(), 1e-12);
  }
}

TEST(AnimateTest, AHandleLetsGoAtItsReleaseFrame) {
  Shot shot = test::blank_shot(test::rectangle(0.1, 0.1));
  for (double x : {0.0, 0.1})
    for (double y : {0.0, 0.1}) shot.handles.push_back(test::bare_handle("h", {x, y}, 10));
  // paper has to stretch by 0.002 % for this
  for (int f = 0; f < 10; ++f) shot.handles[3].keyed(f, 2) = 0.0005 * f;
  shot.handles[3].release_frame = 6;
  const Played played = play(shot, 200, 10);
  EXPECT_EQ(played.frames[4].handles[3].state, HandleFrame::held);
  EXPECT_NEAR(played.frames[4].handles[3].at.z(), 0.002, 1e-12);
  EXPECT_EQ(played.frames[5].handles[3].state, HandleFrame::free);
  EXPECT_LT(played.frames[9].handles[3].at.z(), 0.001);  // springs back
}

TEST(AnimateTest, HandlesBeyondReachAreDrawnTogetherAndReportedAsJammed) {
  Shot shot = test::blank_shot(test::rectangle(0.1, 0.1));
  for (double x : {0.0, 0.1}) shot.handles.push_back(test::bare_handle("h", {x, 0}, 5));
  for (int f = 0; f < 5; ++f) shot.handles[1].keyed(f, 0) = 0.1 + 0.005 * f;
  const Played played = play(shot, 200, 5);
  const auto& last = played.frames.back();
  EXPECT_EQ(last.handles[1].state, HandleFrame::jammed);
  EXPECT_NEAR((last.handles[1].at - last.handles[0].at).norm(), 0.1, 1e-4);
  EXPECT_LT(length_distortion(played.sheets.back()).largest, 0.01);
}

TEST(AnimateTest, HandlesThatJumpEndNearTheSlowRun) {
  Shot slow = test::s1_push(), fast = slow;
  for (Handle& handle : fast.handles)
    for (int f = 1; f < 23; ++f) handle.keyed.row(f) = handle.keyed.row(23);
  fast.handles.back().grab_frame = slow.handles.back().grab_frame = 1000;
  const Played a = play(slow, 400, 26), b = play(fast, 400, 26);
  EXPECT_LT(rms_distance(a.sheets.back().x, b.sheets.back().x), 0.002 * 0.1);
}

TEST(AnimateTest, TheFirstFrameIsTheSheetAsItWasModelled) {
  const Played played = play(test::s1_push(), 300, 1);
  EXPECT_EQ(played.frames[0].statistics.newton_iterations, 0);
  EXPECT_NEAR(played.sheets[0].x.col(2).maxCoeff(), 1e-4, 1e-6);
}

TEST(AnimateTest, ASlightArchDecidesTheBucklingSideEvenIfTheHandlesLieFlat) {
  // as in scene S8: the handles are keyed at z = 0, up to 16 um below the sheet they hold
  for (const double side : {1.0, -1.0}) {
    Shot shot = test::s1_push();
    shot.start.x.col(2) *= side;
    for (Handle& handle : shot.handles) handle.keyed.col(2).array() -= 1.6e-5 * side;
    const Played played = play(shot, 300, 8);
    EXPECT_GT(side * played.sheets.back().x.col(2).mean(), 0.005);
  }
}

TEST(AnimateTest, AFrameThatCannotBeSimulatedEndsTheShotAfterTheGoodOnes) {
  Shot shot = test::s1_push();
  shot.handles[5].keyed(6, 1) = std::numeric_limits<double>::quiet_NaN();
  int frames = 0;
  AnimateOptions options;
  options.last_frame = 20;
  try {
    animate(shot, fem(100), options, [&](const AnimatedFrame&) {
      ++frames;
      return true;
    });
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code, ErrorCode::simulation);
    EXPECT_EQ(error.place, "frame 7 of 20");
  }
  EXPECT_EQ(frames, 6);
}

/// A fixed mesh whose pattern is half as large in frames 8 to 10.
class Shrinking : public Method {
 public:
  PatternMesh first_mesh(const Pattern& pattern, const std::vector<Vector2d>& points) override {
    return fem(100).make()->first_mesh(pattern, points);
  }
  MeshChange remesh(Sheet& sheet, const RemeshContext& context) override {
    if (context.now.frame != 8 && context.now.frame != 11) return MeshChange::none;
    sheet.pattern *= context.now.frame == 8 ? 0.5 : 2;
    return MeshChange::local;
  }
};

TEST(AnimateTest, ASheetThatCannotFollowItsHandlesStaysAndReportsIt) {
  // In frames 8 to 10 the paper between hard handles is half as long as their distance, and no step
  // reaches a minimum.
  const MethodChoice shrinking{"shrinking", [] { return std::make_unique<Shrinking>(); }};
  AnimateOptions options;
  options.last_frame = 13;
  options.elastic.contact = SelfContact::off;  // otherwise handles would give way
  options.elastic.max_iterations = 1;
  std::vector<AnimatedFrame> frames;
  std::vector<Points3> x;
  animate(test::s1_push(), shrinking, options, [&](const AnimatedFrame& f) {
    frames.push_back(f);
    x.push_back(f.sheet->x);
    return true;
  });
  ASSERT_EQ(frames.size(), 13u);
  for (int f = 8; f <= 10; ++f) {
    EXPECT_FALSE(frames[f - 1].statistics.converged);
    EXPECT_NE(frames[f - 1].note.find("it stays as it was: The sheet cannot follow the handles"),
              std::string::npos)
        << frames[f - 1].note;
    EXPECT_EQ(x[f - 1], x[6]);
    EXPECT_TRUE(std::any_of(frames[f - 1].handles.begin(), frames[f - 1].handles.end(),
                            [](const HandleFrame& h) { return h.state == HandleFrame::jammed; }));
  }
  EXPECT_TRUE(frames[10].note.empty());
  for (const HandleFrame& h : frames[10].handles) EXPECT_NE(h.state, HandleFrame::jammed);
}

TEST(AnimateTest, ASheetWithoutHandlesCannotFollowItsCollidersAndSaysSo) {
  const MethodChoice shrinking{"shrinking", [] { return std::make_unique<Shrinking>(); }};
  Shot shot = test::s1_push();
  shot.handles.clear();
  ColliderMesh table{"table", Points3(3, 3), Triangles(1, 3), {}};
  table.x << -1, -1, -1, 1, -1, -1, 0, 1, -1;
  table.triangles << 0, 1, 2;
  shot.colliders = std::make_shared<const Colliders>(Colliders{Collider(table)});
  AnimateOptions options;
  options.last_frame = 9;
  options.elastic.contact = SelfContact::off;
  options.elastic.max_iterations = 1;
  options.elastic.inertia = Inertia::dynamic;
  std::string notes;
  animate(shot, shrinking, options, [&](const AnimatedFrame& f) {
    notes += f.note;
    return true;
  });
  EXPECT_NE(notes.find("The sheet cannot follow the colliders"), std::string::npos) << notes;
  EXPECT_EQ(notes.find("handles"), std::string::npos) << notes;
}

TEST(AnimateTest, StopsWhenTheCallbackReturnsFalse) {
  int frames = 0;
  AnimateOptions options;
  options.last_frame = 10;
  animate(test::s1_push(), fem(100), options, [&](const AnimatedFrame&) { return ++frames < 3; });
  EXPECT_EQ(frames, 3);
}

TEST(AnimateTest, ALoneHandleStiffensADiscTheSizeOfAFinger) {
  Shot shot = test::blank_shot(test::rectangle(0.2, 0.2));
  shot.handles.push_back(test::bare_handle("lone", {0.1, 0.1}, 1));
  shot.handles[0].radius.reset();
  const InitialSheet started = make_initial_sheet(shot, *fem(800).make(), 0);
  double area = 0;
  for (int t = 0; t < started.sheet.triangles.rows(); ++t) {
    if (started.stiffening[t] == 1) continue;
    EXPECT_EQ(started.stiffening[t], 10);
    const auto p = [&](int i) -> Vector2d {
      return started.sheet.pattern.row(started.sheet.triangles(t, i));
    };
    const Vector2d u = p(1) - p(0), v = p(2) - p(0);
    area += 0.5 * cross(u, v);
  }
  EXPECT_NEAR(area, 1.5 * std::sqrt(3.0) * 0.01 * 0.01, 1e-8);  // the hexagon of radius 10 mm
}

}  // namespace
}  // namespace paperbake
