#include "baker/bake/render_pass.h"

#include "tests/core/collider_meshes.h"
#include "tests/core/test_meshes.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace paperbake {
namespace {

constexpr double size = 0.1;  // [m]

/// A square sheet folded along its middle, at z = up. [m]
Sheet folded(double up, double angle) {
  Sheet sheet;
  sheet.pattern.resize(6, 2);
  sheet.pattern << 0, 0, size / 2, 0, size, 0, 0, size, size / 2, size, size, size;
  sheet.triangles.resize(4, 3);
  sheet.triangles << 0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4;
  sheet.x.resize(6, 3);
  for (int v = 0; v < 6; ++v) {
    const double s = sheet.pattern(v, 0) - size / 2;
    sheet.x.row(v) << s * std::cos(angle), sheet.pattern(v, 1), std::abs(s) * std::sin(angle) + up;
  }
  return sheet;
}

/// Frames of it, as high as is said.
ShotRecord record_of(const std::vector<double>& up) {
  ShotRecord record;
  for (std::size_t f = 0; f < up.size(); ++f) {
    const Sheet sheet = folded(up[f], 0.2 * (f + 1));
    AnimatedFrame frame;
    frame.frame = static_cast<int>(f) + 1;
    frame.sheet = &sheet;
    record.add(frame);
  }
  return record;
}

TEST(RenderPassTest, SheetsOneInTheOtherAreApartAndTheSameForAnyNumberOfThreads) {
  const ShotRecord low = record_of({0, 0, 0, 0, 0, 0}),
                   high = record_of({1e-4, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4});
  const Shot shot = test::blank_shot(test::rectangle(size, size));
  const auto positions = [&](int threads) {
    std::vector<std::vector<Points3>> all(2);
    RenderPass pass({{&low, &shot}, {&high, &shot}}, {Quality::draft, {1, 6, 1}, 24, threads});
    for (int frame = 1; pass.next(); ++frame)
      for (std::size_t s = 0; s < pass.sheets().size(); ++s) {
        const RenderedSheet& rendered = pass.sheets()[s];
        EXPECT_EQ(rendered.frame, frame);
        EXPECT_EQ(rendered.statistics.crossings, 0);
        EXPECT_EQ(rendered.statistics.crossings_with_others, 0);
        all[s].push_back(rendered.mesh.x);
      }
    EXPECT_FALSE(pass.next()) << "there is nothing after the last frame";
    return all;
  };
  const auto one = positions(1);
  ASSERT_EQ(one[0].size(), 6u);
  ASSERT_EQ(one[1].size(), 6u);
  EXPECT_EQ(positions(3), one);
}

TEST(RenderPassTest, VelocitiesAreCentralDifferencesAlsoBesideFramesThatAreLeftOut) {
  const std::vector<double> up{0, 0.01, 0.03, 0.06, 0.1};
  const ShotRecord record = record_of(up);
  const Shot shot = test::blank_shot(test::rectangle(size, size));
  const auto frames = [&](const FrameSpan& wanted) {
    std::map<int, CacheFrame> all;
    RenderPass pass({{&record, &shot}}, {Quality::draft, wanted, 24, 2});
    while (pass.next()) all[pass.sheets().front().frame] = pass.sheets().front().mesh;
    return all;
  };
  auto every = frames({1, 5, 1}), second = frames({2, 4, 2});
  ASSERT_EQ(every.size(), 5u);
  ASSERT_EQ(second.size(), 2u);
  EXPECT_EQ(second[4].velocity, every[4].velocity);
  EXPECT_EQ(every[3].velocity, Points3(0.5 * 24 * (every[4].x - every[2].x)));
  EXPECT_EQ(every[1].velocity, Points3(24 * (every[2].x - every[1].x)));
  EXPECT_EQ(every[5].velocity, Points3(24 * (every[5].x - every[4].x)));
  EXPECT_GT(every[3].velocity.rowwise().norm().maxCoeff(), 0.1);
}

TEST(RenderPassTest, WithoutFeaturesTheMeshHasNoVertexAtASingularPoint) {
  const Vector2d apex(0.0321, 0.0457);
  Sheet sheet = folded(0, 0.3);
  sheet.singular.push_back({apex, 1, "test"});
  ShotRecord record;
  AnimatedFrame frame;
  frame.frame = 1;
  frame.sheet = &sheet;
  record.add(frame);
  const Shot shot = test::blank_shot(test::rectangle(size, size));
  const auto distance = [&](MeshFeatures features) {
    const RenderPass pass({{&record, &shot}}, {Quality::draft, {1, 1, 1}, 24, 1, features});
    return (pass.pattern(0).rowwise() - apex.transpose()).rowwise().norm().minCoeff();
  };
  EXPECT_LT(distance(MeshFeatures::all), 1e-9);
  EXPECT_GT(distance(MeshFeatures::handles), 1e-6);
}

/// A sheet bent downwards like a gutter, in five flat strips; the lowest lies 0.01 mm above z = 0.
Sheet gutter() {
  constexpr double radius = 0.05;
  Sheet sheet;
  sheet.pattern.resize(12, 2);
  sheet.x.resize(12, 3);
  sheet.triangles.resize(10, 3);
  for (int v = 0; v < 12; ++v) {
    sheet.pattern.row(v) << size / 5 * (v / 2), size * (v % 2);
    const double angle = (sheet.pattern(v, 0) - size / 2) / radius;
    sheet.x.row(v) << radius * std::sin(angle), sheet.pattern(v, 1), radius * (1 - std::cos(angle));
  }
  sheet.x.col(2).array() += 1e-5 - sheet.x.col(2).minCoeff();
  for (int k = 0; k < 5; ++k) {
    sheet.triangles.row(2 * k) << 2 * k, 2 * k + 2, 2 * k + 3;
    sheet.triangles.row(2 * k + 1) << 2 * k, 2 * k + 3, 2 * k + 1;
  }
  return sheet;
}

/// The sheets are rendered as they are, the first as paper of this thickness [m].
std::vector<RenderedSheet> rendered_among(const std::vector<ColliderMesh>& colliders,
                                          const std::vector<Sheet>& sheets, Quality quality,
                                          double thickness = Paper().thickness) {
  Shot shot = test::blank_shot(test::rectangle(size, size));
  shot.colliders = test::all(colliders);
  Shot first = shot;
  first.paper.thickness = thickness;
  std::vector<ShotRecord> records(sheets.size());
  std::vector<RenderInput> inputs;
  for (std::size_t s = 0; s < sheets.size(); ++s) {
    AnimatedFrame frame;
    frame.frame = 1;
    frame.sheet = &sheets[s];
    records[s].add(frame);
    inputs.push_back({&records[s], s == 0 ? &first : &shot});
  }
  RenderPass pass(inputs, {quality, {1, 1, 1}, 24, 1});
  EXPECT_TRUE(pass.next());
  return pass.sheets();
}

/// The curved surface of the gutter hangs below its flat triangles.
TEST(RenderPassTest, PaperIsPushedOutOfAColliderByHalfItsThicknessInEveryQuality) {
  const double half_thickness = Paper().thickness / 2;
  const double free = rendered_among({test::box({1, 1, 1}, {2, 2, 2})}, {gutter()}, Quality::hero)
                          .front()
                          .mesh.x.col(2)
                          .minCoeff();
  ASSERT_LT(free, -2e-4) << "nothing has to be pushed out";
  for (const Quality quality : {Quality::draft, Quality::shot, Quality::hero}) {
    const RenderedSheet sheet = rendered_among({test::ground()}, {gutter()}, quality).front();
    // some is lost where lengths are restored
    EXPECT_GT(sheet.mesh.x.col(2).minCoeff(), 0.2 * half_thickness);
    EXPECT_LT(sheet.mesh.x.col(2).minCoeff(), 1.1 * half_thickness);
    EXPECT_EQ(sheet.judgement.inside, 0);
    EXPECT_LT(sheet.statistics.stretch_max, 0.03);
  }
}

Sheet flat_at(double z) {
  Sheet sheet = test::hex_sheet(size, size, 10);
  sheet.x.setZero();
  sheet.x.leftCols<2>() = sheet.pattern;
  sheet.x.col(2).setConstant(z);
  return sheet;
}

TEST(RenderPassTest, PaperThatIsNearerToAColliderThanHalfItsThicknessIsLifted) {
  const double half_thickness = Paper().thickness / 2;
  const auto height = [](double z) {
    return rendered_among({test::ground()}, {flat_at(z)}, Quality::draft)
        .front()
        .mesh.x.col(2)
        .eval();
  };
  EXPECT_LT((height(1e-5).array() - half_thickness).abs().maxCoeff(), 1e-9);
  EXPECT_LT((height(2e-4).array() - 2e-4).abs().maxCoeff(), 1e-9) << "it does not touch";
}

TEST(RenderPassTest, BetweenPlatesWithoutRoomForItsThicknessPaperIsInsideOfNeither) {
  const double gap = 2e-5;
  const auto lid = test::box({-1, -1, gap}, {1, 1, 0.01});
  const RenderedSheet sheet =
      rendered_among({test::ground(), lid}, {flat_at(gap / 2)}, Quality::draft).front();
  EXPECT_GT(sheet.mesh.x.col(2).minCoeff(), 1e-6);
  EXPECT_LT(sheet.mesh.x.col(2).maxCoeff(), gap - 1e-6);
}

/// A thick sheet would be lifted by 0.15 mm, through a thin one that slopes up from it.
TEST(RenderPassTest, PaperIsNotLiftedThroughTheSheetThatLiesOnIt) {
  Sheet upper = flat_at(6e-5);
  for (int v = 0; v < upper.x.rows(); ++v) upper.x(v, 2) += 3e-3 * upper.pattern(v, 0);
  const auto sheets =
      rendered_among({test::ground()}, {flat_at(5e-6), upper}, Quality::draft, 3e-4);
  for (const RenderedSheet& sheet : sheets) {
    EXPECT_EQ(sheet.statistics.crossings_with_others, 0);
    EXPECT_EQ(sheet.judgement.inside, 0);
  }
}

}  // namespace
}  // namespace paperbake
