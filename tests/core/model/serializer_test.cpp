// State as bytes: all of it comes back, truncated or altered bytes are refused, and a shot resumes
// from it as if it had never stopped.

#include "core/model/serializer.h"
#include "core/methods/adaptive.h"
#include "core/methods/fem.h"
#include "core/methods/hybrid.h"

#include "core/animation/animate.h"
#include "tests/core/test_meshes.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <memory>

namespace paperbake {
namespace {

Sheet triangle() {
  Sheet sheet;
  sheet.pattern = Points2::Random(3, 2);
  sheet.x = Points3::Random(3, 3);
  sheet.v = Points3::Random(3, 3);
  sheet.triangles.resize(1, 3);
  sheet.triangles << 0, 1, 2;
  sheet.singular = {{{0.1, 0.2}, 7, "bends"}};
  sheet.prescribed_creases = {{{{0, 0}, {1, 0}, {1, 1}}, -0.5}, {{{0, 1}, {1, 1}}, 0, false}};
  sheet.crease_edges = {{{0, 0}, {0.5, 0}, -1.25, true, 2.5}, {{0, 1}, {1, 1}, 0.25, false, {}}};
  return sheet;
}

TEST(Serializer, ReadsBackWhatItWroteBitForBit) {
  Sheet sheet = triangle(), other;
  sheet.x(0, 0) = -0.0;
  sheet.x(1, 1) = std::numeric_limits<double>::denorm_min();
  sheet.x(2, 2) = std::nextafter(0.1, 1);
  std::optional<double> none, some = 3.0;
  std::deque<Points3> past{Points3::Random(2, 3), Points3(0, 3)};
  bool yes = true;
  Serializer out;
  out(sheet, none, some, past, yes);
  std::optional<double> none_there = 1.0, some_there;
  std::deque<Points3> past_there;
  bool yes_there = false;
  Serializer in(out.bytes());
  in(other, none_there, some_there, past_there, yes_there);
  in.end();
  EXPECT_EQ(other.pattern, sheet.pattern);
  EXPECT_EQ(std::memcmp(other.x.data(), sheet.x.data(), sizeof(double) * 9), 0);
  EXPECT_EQ(other.v, sheet.v);
  EXPECT_EQ(other.triangles, sheet.triangles);
  EXPECT_EQ(other.singular.at(0).cause, "bends");
  EXPECT_EQ(other.singular[0].frame_of_birth, 7);
  EXPECT_EQ(other.prescribed_creases.at(0).line, sheet.prescribed_creases[0].line);
  EXPECT_EQ(other.prescribed_creases[0].angle, -0.5);
  EXPECT_TRUE(other.prescribed_creases[0].folded);
  EXPECT_FALSE(other.prescribed_creases.at(1).folded);
  ASSERT_EQ(other.crease_edges.size(), 2u);
  for (std::size_t e = 0; e < 2; ++e) {
    const CreaseEdge &edge = other.crease_edges[e], &was = sheet.crease_edges[e];
    EXPECT_TRUE(edge.a == was.a && edge.b == was.b);
    EXPECT_EQ(edge.rest_angle, was.rest_angle);
    EXPECT_EQ(edge.folded, was.folded);
    EXPECT_EQ(edge.pressed, was.pressed);
  }
  EXPECT_EQ(none_there, none);
  EXPECT_EQ(some_there, some);
  EXPECT_EQ(past_there, past);
  EXPECT_TRUE(yes_there);
}

TEST(Serializer, RefusesBytesThatAreTruncatedAnywhere) {
  Sheet sheet = triangle();
  Serializer out;
  out(sheet);
  const std::string& bytes = out.bytes();
  ASSERT_GT(bytes.size(), 200u);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    Sheet there;
    Serializer in(std::string_view(bytes).substr(0, size));
    EXPECT_THROW(in(there), Error) << size;
  }
}

TEST(Serializer, SurvivesAChangeOfAnyByte) {
  Sheet sheet = triangle();
  Serializer out;
  out(sheet);
  int refused = 0;
  for (std::size_t k = 0; k < out.bytes().size(); ++k)
    for (const char byte : {'\x00', '\x7f', '\xff'}) {
      std::string bytes = out.bytes();
      bytes[k] = byte;
      Sheet there;
      try {
        Serializer in(bytes);
        in(there);
        EXPECT_TRUE(there.triangles.size() == 0 ||
                    there.triangles.maxCoeff() < there.pattern.rows());
      } catch (const Error&) {
        ++refused;
      }
    }
  EXPECT_GT(refused, 50) << "counts and numbers of vertices are among them";
}

struct Case {
  const char* name;
  std::function<MethodChoice(const Shot&)> method;
  Plasticity plasticity;
  Inertia inertia;
  int probe_every;
};

class SerializerTest : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(
    Methods, SerializerTest,
    testing::Values(Case{"hybrid",
                         [](const Shot& s) { return hybrid(s.pattern, s.paper, 80, {}, 1, 0); },
                         Plasticity::on, Inertia::quasi_static, 0},
                    Case{"hybrid_that_is_probed",
                         [](const Shot& s) { return hybrid(s.pattern, s.paper, 60, {}, 1, 0); },
                         Plasticity::on, Inertia::quasi_static, 5},
                    Case{"adaptive", [](const Shot& s) { return adaptive(s.pattern, 400); },
                         Plasticity::on, Inertia::quasi_static, 0},
                    Case{"fem_that_swings", [](const Shot&) { return fem(120); }, Plasticity::off,
                         Inertia::dynamic, 0}),
    [](const auto& info) { return std::string(info.param.name); });

/// Everything that a frame hands on, except times.
struct Seen {
  Sheet sheet;
  double energy, plastic;
  int iterations;
  std::string state;
};

TEST_P(SerializerTest, TheStateIsEverythingThatTheNextFramesDependOn) {
  const Case& c = GetParam();
  const Shot shot = test::s1_push();
  AnimateOptions options;
  options.last_frame = 32;  // includes the frame in which a relative handle takes hold
  options.plasticity = c.plasticity;
  options.elastic.inertia = c.inertia;
  options.probe_every = c.probe_every;
  const auto frames = [&](const AnimateOptions& how) {
    std::vector<Seen> seen;
    animate(shot, c.method(shot), how, [&](const AnimatedFrame& f) {
      seen.push_back({*f.sheet, f.statistics.energy, f.statistics.plastic,
                      f.statistics.newton_iterations, f.state()});
      return true;
    });
    return seen;
  };
  const std::vector<Seen> whole = frames(options);
  ASSERT_EQ(whole.size(), 32u);
  EXPECT_GT((whole[31].sheet.x.topRows(4) - whole[3].sheet.x.topRows(4)).norm(), 1e-3);
  for (const int from : {1, 2, 7, 16, 24, 25, 31}) {
    options.resume_state = whole[from - 1].state;
    const std::vector<Seen> rest = frames(options);
    ASSERT_EQ(rest.size(), whole.size() - from);
    for (std::size_t k = 0; k < rest.size(); ++k) {
      const Seen& then = whole[from + k];
      ASSERT_TRUE(rest[k].sheet.triangles.rows() == then.sheet.triangles.rows() &&
                  rest[k].sheet.triangles == then.sheet.triangles)
          << "from " << from;
      ASSERT_EQ(rest[k].sheet.x, then.sheet.x) << "from " << from << ", " << k << " frames later";
      EXPECT_EQ(rest[k].energy, then.energy);
      EXPECT_EQ(rest[k].plastic, then.plastic);
      EXPECT_EQ(rest[k].iterations, then.iterations);
      EXPECT_EQ(rest[k].state, then.state);
    }
  }
}

/// Paper yields by the ridges of the step before, until a step looks for them again.
TEST(Serializer, TheSolverStateKeepsItsRidges) {
  Sheet saddle = test::hex_sheet(0.1, 0.1, 8);
  PositionConstraints held;
  for (int v = 0; v < saddle.x.rows(); ++v) {
    const Vector2d p = saddle.pattern.row(v).transpose() - Vector2d(0.05, 0.05);
    // 30 1/m both ways: a ridge yields; smooth paper does not below 100 1/m
    saddle.x(v, 2) = 15 * (p.x() * p.x() - p.y() * p.y());
    if (std::abs(p.x()) > 0.0499 && std::abs(p.y()) > 0.0499) held.push_back({v, saddle.x.row(v)});
  }
  PlasticGrid flowed(test::rectangle(0.1, 0.1));
  Elastic elastic({}, {});
  elastic.set_plastic_grid(&flowed);
  elastic.set_mesh(saddle);
  Sheet after = saddle;
  elastic.step(after, {held}, 1 / 24.0);
  SolverState past = elastic.state(), there, smooth = past;
  ASSERT_GT(past.ridges.focus.maxCoeff(), 5);
  Serializer out;
  out(past);
  Serializer in(out.bytes());
  in(there);
  in.end();
  there.grid = past.grid;
  smooth.ridges = {};
  const auto bending = [&](const SolverState& told) {  // [J] of the saddle
    PlasticGrid grid = flowed;
    Elastic other({}, {});
    other.set_plastic_grid(&grid);
    other.set_mesh(saddle);
    other.restore(told);
    const ElasticReport stored = other.evaluate_energies(saddle);
    return stored.energy - stored.membrane;
  };
  EXPECT_EQ(bending(there), bending(past));
  EXPECT_GT(bending(smooth), 1.1 * bending(past)) << "it is the ridges that are asked for";
}

TEST(Serializer, ATruncatedStateOrOneOfAnotherShotIsRefused) {
  const Shot shot = test::s1_push();
  AnimateOptions options;
  options.last_frame = 3;
  options.plasticity = Plasticity::on;
  std::string state;
  const auto keep = [&](const AnimatedFrame& f) {
    state = f.state();
    return true;
  };
  animate(shot, fem(60), options, keep);
  const std::string whole = state;
  for (const std::size_t size : {std::size_t(1), whole.size() / 2, whole.size() - 1}) {
    options.resume_state = whole.substr(0, size);
    EXPECT_THROW(animate(shot, fem(60), options, keep), Error) << size;
  }
  Shot other = shot;
  other.handles.pop_back();
  options.resume_state = whole;
  EXPECT_THROW(animate(other, fem(60), options, keep), Error);
}

}  // namespace
}  // namespace paperbake
