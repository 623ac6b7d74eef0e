// The judge of what is handed on, on meshes whose faults are known.

#include "baker/output/cache_judge.h"

#include "core/geometry/measure.h"
#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace paperbake {
namespace {

constexpr double side = 0.2;  // [m]

CacheJudge judge_of(const Sheet& sheet,
                    std::shared_ptr<const JudgedColliders> colliders = nullptr) {
  return CacheJudge(sheet.pattern / side, sheet.triangles, side, std::move(colliders));
}

TEST(CacheJudge, LengthsAreThoseThatTheMeasureOfASheetFinds) {
  Sheet sheet = test::hex_sheet(side, side, 30, 0.3);
  for (int v = 0; v < sheet.x.rows(); ++v)
    sheet.x.row(v) << 1.02 * sheet.pattern(v, 0), sheet.pattern(v, 1),
        0.01 * std::sin(40 * sheet.pattern(v, 0));
  const LengthDistortion truth = length_distortion(sheet);
  const Judgement found = judge_of(sheet)(sheet.x, 0);
  ASSERT_GT(truth.largest, 0.02);
  EXPECT_NEAR(found.length.largest, truth.largest, 1e-5);  // positions have 32 bits
  EXPECT_NEAR(found.length.mean, truth.mean, 1e-5);
  EXPECT_LT((found.length.where - truth.where).norm(), 1e-6);
  EXPECT_EQ(found.crossings, 0);
}

TEST(CacheJudge, OnePulledVertexIsFoundWhereItIs) {
  Sheet sheet = test::hex_sheet(side, side, 30);
  const CacheJudge judge = judge_of(sheet);
  const int v = judge.vertex_at({0.12, 0.05});
  EXPECT_LT((sheet.pattern.row(v).transpose() - Vector2d(0.12, 0.05)).norm(), 0.005);
  sheet.x(v, 0) += 0.004;
  const Judgement found = judge(sheet.x, 0);
  EXPECT_GT(found.length.largest, 0.3);
  EXPECT_LT((found.length.where - sheet.pattern.row(v).transpose()).norm(), 0.005);
}

TEST(CacheJudge, ASheetFoldedThroughItselfCrosses) {
  Sheet sheet = test::hex_sheet(side, side, 30);
  for (int v = 0; v < sheet.x.rows(); ++v)
    if (const double s = sheet.pattern(v, 0); s > 0.1)
      sheet.x.row(v) << 0.2013 - s, sheet.pattern(v, 1) + 0.0011, 0.02 * std::sin(60 * (s - 0.1));
  EXPECT_GT(judge_of(sheet)(sheet.x, 0).crossings, 20);
}

TEST(CacheJudge, CollidersAreWhereTheyAreInThatFrame) {
  ColliderMesh plate{"plate", Points3(8, 3), Triangles(12, 3), {}};
  for (int v = 0; v < 8; ++v)
    plate.x.row(v) << (v & 1 ? 0.3 : -0.1), (v & 2 ? 0.3 : -0.1), (v & 4 ? -0.01 : -0.05);
  plate.triangles << 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4,
      6, 0, 6, 2, 1, 3, 7, 1, 7, 5;
  for (const double up : {0.0, 0.005, 0.012, 0.02})
    plate.frames.own().push_back(plate.x.rowwise() + Eigen::RowVector3d(0, 0, up));
  const Sheet sheet = test::hex_sheet(side, side, 30);
  const CacheJudge judge =
      judge_of(sheet, std::make_shared<const JudgedColliders>(std::vector<ColliderMesh>{plate}));
  EXPECT_EQ(judge(sheet.x, 0).inside, 0);
  EXPECT_EQ(judge(sheet.x, 1).inside, 0);
  EXPECT_NEAR(judge(sheet.x, 2).inside, 0.002, 2e-5);
  EXPECT_EQ(judge(sheet.x, 2).inside_of, "plate");
  EXPECT_NEAR(judge(sheet.x, 3).inside, 0.01, 1e-4);
  EXPECT_NEAR(judge(sheet.x, 99).inside, 0.01, 1e-4) << "after its last key it stands still";
}

TEST(CacheJudge, TheVerdictIsEnteredWithANoteWhereTheSheetIsVisiblyInside) {
  FrameRecord line;
  line.note = "a snap";
  enter({{}, 0, 9e-5, {0.1, 0.1}, "ground"}, line);
  EXPECT_EQ(line.note, "a snap");
  enter({{}, 0, 2.5e-3, {0.1, 0.1}, "ground"}, line);
  EXPECT_EQ(line.note, "a snap; inside \"ground\" by 2.50 mm");
  EXPECT_EQ(line.statistics.inside, 2.5e-3);
}

}  // namespace
}  // namespace paperbake
