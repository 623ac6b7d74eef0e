#include "core/geometry/intersections.h"

#include "core/animation/animate.h"
#include "core/geometry/curvature.h"
#include "core/geometry/hinges.h"
#include "core/geometry/measure.h"
#include "core/geometry/mesh_transfer.h"
#include "core/geometry/random.h"
#include "core/methods/hybrid.h"
#include "core/step2_crumple/edge_flips.h"
#include "tests/core/geometry/sound_mesh.h"
#include "tests/core/test_meshes.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <set>

namespace paperbake {
namespace {

struct Played {
  std::vector<Sheet> sheets;
  std::vector<AnimatedFrame> frames;
};
Played play(const Shot& shot, const MethodChoice& method, int last_frame) {
  AnimateOptions options;
  options.last_frame = last_frame;
  Played played;
  animate(shot, method, options, [&](const AnimatedFrame& frame) {
    played.sheets.push_back(*frame.sheet);
    played.frames.push_back(frame);
    return true;
  });
  return played;
}

MethodChoice hybrid_of(const Shot& shot, unsigned seed = 0) {
  return hybrid(shot.pattern, shot.paper, 120, {}, seed, 0);
}

TEST(HybridTest, AFinerFirstMeshHasNoMoreTrianglesThanTheMethodMayHave) {
  const Pattern square = test::rectangle(0.1, 0.1);
  CrumpleOptions options;
  options.max_first_triangles = 500;
  const auto method = hybrid(square, Paper{}, 120, options, 0, 0).make();
  method->first_mesh(square, {});
  ASSERT_TRUE(method->finer_mesh()) << "240";
  EXPECT_TRUE(method->finer_mesh()) << "480";
  const auto finer = hybrid(square, Paper{}, 240, options, 0, 0).make();
  finer->first_mesh(square, {});
  ASSERT_TRUE(finer->finer_mesh()) << "480";
  EXPECT_FALSE(finer->finer_mesh()) << "960";
}

TEST(HybridTest, AnArchOfAHundredTrianglesIsNearlyTheElastica) {
  const Shot shot = test::s1_push();
  const Played played = play(shot, hybrid_of(shot), 24);
  const Sheet& sheet = played.sheets.back();
  EXPECT_LT(sheet.triangles.rows(), 150);
  EXPECT_NEAR(sheet.x.col(2).maxCoeff() / 0.019492, 1, 0.015);
  EXPECT_LT(length_distortion(sheet).mean, 1e-4);
  EXPECT_TRUE(sheet.singular.empty());
}

TEST(HybridTest, ANewMeshComesWithTheSheetOfTheFrameBefore) {
  const Shot shot = test::s1_push();
  const Played played = play(shot, hybrid_of(shot), 24);
  int known = 0;
  for (std::size_t k = 1; k < played.sheets.size(); ++k) {
    const Sheet &before = played.sheets[k - 1], &now = played.sheets[k];
    const Points3& carried = played.frames[k].carried;
    const bool same_mesh = before.pattern.rows() == now.pattern.rows() &&
                           before.pattern == now.pattern && before.triangles == now.triangles;
    if (carried.rows() == 0) continue;
    EXPECT_FALSE(same_mesh) << k;
    ++known;
    ASSERT_EQ(carried.rows(), now.x.rows());
    const Points3 there =
        MeshTransfer(before.pattern, before.triangles, now.pattern)(Points3(before.x));
    const auto farthest = [](const Points3& a, const Points3& b) {
      return (a - b).rowwise().norm().maxCoeff();
    };
    EXPECT_GT(farthest(carried, there), 0) << "it is in equilibrium on the new mesh";
    EXPECT_LT(farthest(carried, there), 0.03 * 0.1);
    EXPECT_LT(farthest(carried, there), farthest(now.x, there)) << "hands have not moved yet";
    EXPECT_LT(length_distortion({now.pattern, carried, {}, now.triangles, {}}).mean, 1e-4);
  }
  EXPECT_GE(known, 3);
}

TEST(HybridTest, FramesReportTheRulingsAndRegionsOfAnArch) {
  const Shot shot = test::s1_push();  // bends about lines along y, across the push
  const Played played = play(shot, hybrid_of(shot), 24);
  const BentParts& parts = played.frames.back().parts;
  ASSERT_GT(parts.rulings.size(), 5u);
  for (const auto& [a, b] : parts.rulings) EXPECT_LT(std::abs((b - a).normalized().x()), 0.1);
  ASSERT_EQ(static_cast<Eigen::Index>(parts.region.size()), played.sheets.back().triangles.rows());
  const std::set<int> curved(parts.region.begin(), parts.region.end());
  EXPECT_GE(*curved.rbegin(), 0);
  EXPECT_LE(curved.size(), 5u);  // an arch, its feet, and what is flat
}

TEST(HybridTest, NothingChangesWhileNothingMoves) {
  Shot shot = test::s1_push();
  for (Handle& handle : shot.handles)  // at rest from frame 12 on
    for (int f = 12; f < handle.keyed.rows(); ++f) handle.keyed.row(f) = handle.keyed.row(11);
  shot.handles.back().grab_frame = 1000;
  const Played played = play(shot, hybrid_of(shot), 30);
  for (std::size_t f = 18; f < played.sheets.size(); ++f) {
    EXPECT_TRUE(played.sheets[f].triangles == played.sheets[17].triangles) << f;
    // twice the `stop` of the solver
    EXPECT_LT((played.sheets[f].x - played.sheets[17].x).rowwise().norm().maxCoeff(), 2e-5) << f;
    EXPECT_EQ(played.frames[f].statistics.newton_iterations, 0) << f;  // and it costs nothing
  }
}

TEST(HybridTest, OnlyPaperWoundTooTightlyKeepsACurl) {
  // A strip of 60 x 20 mm is led around a cylinder by handles along both borders and released at
  // frame 25; it yields at 100 1/m with a hardening of 0.3.
  const auto curl = [](double curvature) {
    constexpr int frames = 40, rows = 31;
    Shot shot = test::blank_shot(test::rectangle(0.06, 0.02));
    for (int i = 0; i < rows; ++i)
      for (double y : {0.0, 0.02}) {
        const double u = 0.06 * i / (rows - 1) - 0.03;
        Handle handle = test::bare_handle("h", {u + 0.03, y}, frames);
        for (int f = 0; f < frames; ++f) {
          const double k = std::max(1e-6, curvature * std::min(f, 24) / 24);
          handle.keyed.row(f) << std::sin(k * u) / k, y, (std::cos(k * u) - 1) / k;
        }
        if (i != rows / 2) handle.release_frame = 26;
        shot.handles.push_back(handle);
      }
    AnimateOptions options;
    options.last_frame = frames;
    options.plasticity = Plasticity::on;
    options.report_plastic_curvature = true;
    options.elastic.contact = SelfContact::off;  // it is wound twice around the same cylinder
    double plastic = 0, residual = 0, kept = 0;
    animate(
        shot, hybrid(shot.pattern, shot.paper, 240, {}, 0, 0), options,
        [&](const AnimatedFrame& frame) {
          EXPECT_GE(frame.statistics.plastic, plastic - 1e-9);  // paper does not heal
          plastic = frame.statistics.plastic;
          EXPECT_EQ(frame.plastic_curvature.rows(), frame.sheet->pattern.rows());
          kept = frame.plastic_curvature.col(0).mean();
          // mean curvature from the chord between the ends: c = 2/k sin(k L/2)
          const double chord = (frame.handles.front().at - frame.handles[2 * (rows - 1)].at).norm();
          for (residual = 1e-6; residual < 300 && 2 / residual * std::sin(residual * 0.03) > chord;)
            residual += 0.1;
          return true;
        });
    // except for its ends the free sheet has the curvature that it kept
    EXPECT_NEAR(kept, residual < 1 ? 0 : residual, std::max(1.0, 0.15 * residual));
    return std::make_pair(residual, plastic);
  };
  const auto tight = curl(200), loose = curl(70);
  EXPECT_NEAR(tight.first, 0.7 * 100, 0.05 * 70);  // (1 - eta)(k - k_y)
  EXPECT_LT(loose.first, 1);
  EXPECT_LT(loose.second, 0.02 * tight.second);
}

/// Eight handles are drawn towards the middle: the sheet must break.
Shot crush() {
  constexpr int frames = 40;
  Shot shot = test::blank_shot(test::rectangle(0.21, 0.21));
  for (double x : {0.0, 0.105, 0.21})
    for (double y : {0.0, 0.105, 0.21}) {
      if (x == 0.105 && y == 0.105) continue;
      Handle handle = test::bare_handle("h", {x, y}, frames);
      handle.radius.reset();
      const bool corner = x != 0.105 && y != 0.105;
      for (int f = 0; f < frames; ++f) {
        const double way = 0.5 * f / frames;
        handle.keyed.row(f) << x + way * (0.105 - x), y + way * (0.105 - y),
            way * (corner ? 0.06 : -0.04);
      }
      shot.handles.push_back(handle);
    }
  return shot;
}

TEST(HybridTest, SingularPointsOfACrushedSheetStayAndDependOnTheSeed) {
  const Shot shot = crush();
  const Played a = play(shot, hybrid_of(shot, 1), 40), again = play(shot, hybrid_of(shot, 1), 40),
               b = play(shot, hybrid_of(shot, 2), 40);
  const auto& points = a.sheets.back().singular;
  ASSERT_GE(points.size(), 3u);
  for (std::size_t f = 1; f < a.sheets.size(); ++f) {
    ASSERT_GE(a.sheets[f].singular.size(), a.sheets[f - 1].singular.size());
    for (std::size_t k = 0; k < a.sheets[f - 1].singular.size(); ++k)
      EXPECT_TRUE(a.sheets[f].singular[k].pattern == a.sheets[f - 1].singular[k].pattern);
    test::expect_sound(a.sheets[f], 0.21 * 0.21);
    EXPECT_EQ(a.frames[f].statistics.new_singular,
              int(a.sheets[f].singular.size() - a.sheets[f - 1].singular.size()));
  }
  EXPECT_TRUE(a.sheets.back().x == again.sheets.back().x);
  EXPECT_FALSE(points[0].pattern == b.sheets.back().singular.at(0).pattern);
  EXPECT_EQ(crossings(a.sheets.back()), 0);
  for (const HandleFrame& handle : a.frames.back().handles) {
    const double lag = (handle.at - handle.keyed).norm();
    EXPECT_EQ(handle.state, lag > 1e-4 ? HandleFrame::jammed : HandleFrame::held);
    EXPECT_LT(lag, 0.02);
  }
}

TEST(HybridTest, OptionsBoundTheNumberOfSingularPoints) {
  const Shot shot = crush();
  const auto born = [&](const CrumpleOptions& options) {
    return play(shot, hybrid(shot.pattern, shot.paper, 120, options, 1, 0), 30)
        .sheets.back()
        .singular.size();
  };
  CrumpleOptions one, full;
  one.max_points = 1;
  full.max_triangles = 60;  // fewer than the first mesh has
  EXPECT_EQ(born(one), 1u);
  EXPECT_EQ(born(full), 0u);
}

}  // namespace
}  // namespace paperbake
