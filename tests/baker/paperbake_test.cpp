// The library as other programs use it: through its one header.

#include <paperbake/paperbake.h>

#include "core/model/segment2.h"
#include "formats/cache/alembic_reader.h"
#include "tests/own_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace paperbake {
namespace {

namespace fs = std::filesystem;

/// A sheet of 60 x 40 mm with a hinge on its left and one on its right, which comes 1 mm closer in
/// every frame.
Scene pushed_sheet(int frames = 6) {
  Scene scene;
  scene.source = "push";
  scene.last_frame = frames;
  SceneSheet sheet = flat_sheet("paper", 0.06, 0.04);
  for (const double u : {0.0, 0.06})
    for (const double v : {0.0, 0.04}) {
      Points3 keyed(frames, 3);
      for (int f = 0; f < frames; ++f) keyed.row(f) << u - (u > 0 ? 1e-3 * f : 0), v, 0;
      sheet.handles.push_back({"handle " + std::to_string(sheet.handles.size()), {u, v}, keyed});
    }
  scene.sheets.push_back(sheet);
  return scene;
}

std::vector<Points3> positions(const Scene& scene, const BakeJob& job = {}) {
  std::vector<Points3> all;
  simulate_scene(scene, job, [&](const AnimatedFrame& frame) {
    all.push_back(frame.sheet->x);
    return true;
  });
  return all;
}

double distance(const Points3& a, const Points3& b) {
  return a.rows() == b.rows() ? (a - b).cwiseAbs().maxCoeff()
                              : std::numeric_limits<double>::infinity();
}

/// The error that a call throws; an empty one when it throws none.
Error error_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error;
  }
  return Error(ErrorCode::simulation, "", "");
}

Error error_of(const Scene& scene, const BakeJob& job = {}) {
  return error_of([&] { simulate_scene(scene, job, [](const AnimatedFrame&) { return false; }); });
}

class Library : public testing::Test {
 protected:
  fs::path folder() const {
    return test::own_folder() / testing::UnitTest::GetInstance()->current_test_info()->name();
  }
  // seconds instead of minutes
  const BakeJob small{{"quality", "draft"}, {"formats", "abc,cert"}, {"threads", "1"}};
};

TEST_F(Library, AFlatSheetLiesWhereItsPatternIs) {
  const SceneSheet sheet = flat_sheet("a", 0.3, 0.2);
  EXPECT_DOUBLE_EQ(area(sheet.pattern), 0.06);
  EXPECT_EQ(sheet.start.x.leftCols<2>(), sheet.start.pattern);
  EXPECT_EQ(sheet.start.x.col(2).norm(), 0);
  double covered = 0;  // counter-clockwise triangles have positive areas
  for (int t = 0; t < sheet.start.triangles.rows(); ++t) {
    const auto corner = [&](int k) {
      return Vector2d(sheet.start.pattern.row(sheet.start.triangles(t, k)));
    };
    const Vector2d a = corner(1) - corner(0), b = corner(2) - corner(0);
    covered += cross(a, b) / 2;
  }
  EXPECT_DOUBLE_EQ(covered, 0.06);
}

TEST_F(Library, HandsOnEveryFrameInOrderWithTheHandlesWhereTheyAreKeyed) {
  const Scene scene = pushed_sheet();
  int frames = 0;
  simulate_scene(scene, {}, [&](const AnimatedFrame& frame) {
    EXPECT_EQ(frame.frame, ++frames);
    EXPECT_EQ(frame.sheet_index, 0u);
    for (std::size_t h = 0; h < 4; ++h)
      EXPECT_LT(
          (frame.handles[h].at - keyed_position(scene.sheets[0].handles[h], frames - 1)).norm(),
          1e-9);
    return true;
  });
  EXPECT_EQ(frames, 6);
}

TEST_F(Library, ASheetThatIsPushedTogetherBendsOutOfItsPlane) {
  const std::vector<Points3> x = positions(pushed_sheet());
  ASSERT_EQ(x.size(), 6u);
  EXPECT_LT(x.front().col(2).cwiseAbs().maxCoeff(), 1e-4);
  // an arch of length L over L - d is about sqrt(3/8 L d) high: 10.6 mm
  EXPECT_NEAR(x.back().col(2).cwiseAbs().maxCoeff(), std::sqrt(3. / 8 * 0.06 * 0.005), 2e-3);
}

TEST_F(Library, FalseCancels) {
  int frames = 0;
  simulate_scene(pushed_sheet(), {}, [&](const AnimatedFrame&) { return ++frames < 3; });
  EXPECT_EQ(frames, 3);
}

TEST_F(Library, HandsOnOnlyTheFramesThatAreAskedFor) {
  std::vector<int> frames;
  simulate_scene(pushed_sheet(), {{"frames", "2-6x2"}}, [&](const AnimatedFrame& frame) {
    frames.push_back(frame.frame);
    return true;
  });
  EXPECT_EQ(frames, (std::vector<int>{2, 4, 6}));
}

TEST_F(Library, WhatTheCallerThrowsPassesThrough) {
  EXPECT_THROW(simulate_scene(pushed_sheet(), {},
                              [](const AnimatedFrame&) -> bool { throw std::domain_error("own"); }),
               std::domain_error);
}

TEST_F(Library, TwoSimulationsAtOnceAreTwoOneAfterTheOther) {
  const Scene scene = pushed_sheet();
  const std::vector<Points3> alone = positions(scene);
  std::vector<Points3> a, b;
  std::thread beside([&] { a = positions(scene); });
  b = positions(scene);
  beside.join();
  ASSERT_EQ(alone.size(), 6u);
  EXPECT_TRUE(a == alone);
  EXPECT_TRUE(b == alone);
}

TEST_F(Library, NumbersOfThePaperAndItsGradeChangeTheShape) {
  const Scene scene = pushed_sheet();
  const Points3 by_default = positions(scene).back();
  BakeJob job;
  job.paper["apex_scatter"] = 0.005;  // what it is without
  EXPECT_EQ(distance(positions(scene, job).back(), by_default), 0);
  job.paper["membrane_stiffness"] = 1e4;
  EXPECT_GT(distance(positions(scene, job).back(), by_default), 1e-6);
}

TEST_F(Library, ABakeHasTheFramesThatASimulationHandsOn) {
  BakeJob job = small;
  job.options["mesh"] = "simulation";
  const Scene scene = pushed_sheet();
  const BakeResult result = bake_scene(scene, folder(), job);
  ASSERT_FALSE(result.files.empty());
  EXPECT_EQ(result.files.front(), folder() / "push.abc");
  const AlembicReader cache(result.files.front());
  const std::vector<Points3> x = positions(scene);
  ASSERT_EQ(cache.sheets().at(0).frames, x.size());
  for (std::size_t i = 0; i < x.size(); ++i)  // up to the rounding to 32 bits
    EXPECT_LT(distance(cache.frame(0, i).x, x[i]), 1e-8) << i;
}

TEST_F(Library, ABakeTellsEveryFrameOfBothPasses) {
  BakeCallbacks callbacks;
  std::vector<std::string> told;
  callbacks.on_progress = [&](const BakeProgress& p) {
    EXPECT_EQ(p.sheet, "paper");
    EXPECT_EQ(p.done, p.frame);
    EXPECT_EQ(p.frames, 3);
    told.push_back(p.pass + " " + std::to_string(p.frame));
  };
  bake_scene(pushed_sheet(3), folder(), small, callbacks);
  EXPECT_EQ(told, (std::vector<std::string>{"simulated 1", "simulated 2", "simulated 3",
                                            "rendered 1", "rendered 2", "rendered 3"}));
  told.clear();
  bake_scene(pushed_sheet(3), folder(), small, callbacks);
  EXPECT_TRUE(told.empty()) << "the bake was complete";
}

TEST_F(Library, ABakeThatIsCancelledGoesOnWhereItStopped) {
  BakeCallbacks callbacks;
  int simulated = 0;
  std::vector<std::string> messages;
  callbacks.on_progress = [&](const BakeProgress& p) { simulated += p.pass == "simulated"; };
  callbacks.on_message = [&](const std::string& text) { messages.push_back(text); };
  callbacks.cancel = [&] { return simulated == 3; };
  const Error error = error_of([&] { bake_scene(pushed_sheet(), folder(), small, callbacks); });
  EXPECT_EQ(error.code, ErrorCode::stopped);
  EXPECT_EQ(simulated, 3);

  callbacks.cancel = {};
  bake_scene(pushed_sheet(), folder(), small, callbacks);
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(messages[0], "Frames 1-3 are as an earlier bake simulated them.");
  EXPECT_EQ(AlembicReader(folder() / "push.abc").sheets().at(0).frames, 6u);
}

TEST_F(Library, HandlesThatAskTheImpossibleAreAWarning) {
  Scene scene = pushed_sheet(3);
  scene.sheets[0].handles[2].keyed.col(0).array() += 0.01;
  BakeCallbacks callbacks;
  std::string messages;
  callbacks.on_message = [&](const std::string& text) { messages += text; };
  const BakeResult result = bake_scene(scene, folder(), small, callbacks);
  EXPECT_NE(messages.find("too far apart"), std::string::npos) << messages;
  EXPECT_FALSE(result.missed_gates.empty());
}

TEST_F(Library, AnOptionThatIsNotThereIsAnErrorWithTheNearestName) {
  const Error error = error_of(pushed_sheet(), {{"metod", "fem"}});
  EXPECT_EQ(error.code, ErrorCode::command);
  EXPECT_EQ(error.place, "option \"metod\"");
  EXPECT_NE(error.cause.find("\"method\""), std::string::npos) << error.cause;
  EXPECT_EQ(error_of(pushed_sheet(), {{"method", "magic"}}).code, ErrorCode::command);
}

TEST_F(Library, AnOptionOfReadingComesTooLateForAScene) {
  for (const char* name :
       {"scene", "output", "progress", "fps", "start_frame", "unit_scale", "take"})
    EXPECT_EQ(error_of(pushed_sheet(), {{name, "1"}}).place,
              "option \"" + std::string(name) + "\"");
}

TEST_F(Library, ASceneThatCannotBeIsAnErrorThatNamesItsPlace) {
  const auto place_of = [](const std::function<void(Scene&)>& spoil) {
    Scene scene = pushed_sheet();
    spoil(scene);
    const Error error = error_of(scene);
    return error.code == ErrorCode::scene ? error.place : "nothing is wrong";
  };
  EXPECT_EQ(place_of([](Scene&) {}), "nothing is wrong");
  EXPECT_EQ(place_of([](Scene& s) { s.sheets.clear(); }), "push");
  EXPECT_EQ(place_of([](Scene& s) { s.last_frame = 0; }), "push");
  EXPECT_EQ(place_of([](Scene& s) { s.fps = 0; }), "push");
  EXPECT_EQ(place_of([](Scene& s) { s.sheets.push_back(s.sheets[0]); }), "push");
  const std::string sheet = "sheet \"paper\"", handle = sheet + ", handle \"handle 1\"";
  EXPECT_EQ(place_of([](Scene& s) {
              auto& outline = s.sheets[0].pattern.outline;
              std::reverse(outline.begin(), outline.end());
            }),
            sheet);
  EXPECT_EQ(place_of([](Scene& s) {
              for (Vector2d& p : s.sheets[0].pattern.outline) p.x() += 1;
            }),
            sheet);
  EXPECT_EQ(place_of([](Scene& s) { s.sheets[0].start.x.resize(3, 3); }), sheet);
  EXPECT_EQ(place_of([](Scene& s) { s.sheets[0].start.triangles(0, 0) = 4; }), sheet);
  EXPECT_EQ(place_of([](Scene& s) { s.sheets[0].handles[1].keyed.resize(0, 3); }), handle);
  EXPECT_EQ(place_of([](Scene& s) { s.sheets[0].handles[1].keyed(2, 0) = NAN; }), handle);
  EXPECT_EQ(place_of([](Scene& s) { s.sheets[0].handles[1].pattern.x() = -0.01; }), handle);
  EXPECT_EQ(error_of([] { flat_sheet("a", 0.1, 0); }).code, ErrorCode::scene);
}

}  // namespace
}  // namespace paperbake
