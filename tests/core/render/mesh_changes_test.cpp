#include "core/render/mesh_changes.h"

#include "core/geometry/measure.h"
#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace paperbake {
namespace {

/// A sheet that rises by 1 mm a frame, and by 2 mm more at every change of its mesh.
class RisingSheet {
 public:
  void add(bool changes, double rise = 0.001) {
    if (changes) {
      mesh_ = mesh_ == 8 ? 9 : 8;
      jumped_ += 0.002;
    }
    Sheet sheet = test::hex_sheet(0.1, 0.1, mesh_);
    AnimatedFrame frame;
    frame.frame = ++frame_;
    frame.sheet = &sheet;
    frame.handles.resize(1);
    frame.handles[0].state = held_ ? HandleFrame::held : HandleFrame::free;
    if (changes) {
      frame.carried = sheet.x;
      frame.carried.col(2).setConstant(risen_ + jumped_);
    }
    risen_ += rise;
    sheet.x.col(2).setConstant(risen_ + jumped_);
    record.add(frame);
    shown_.push_back(risen_ + jumped_);
  }
  void add(int frames) {
    for (int f = 0; f < frames; ++f) add(false);
  }
  void hold() { held_ = true; }

  /// [m] how high frame k is drawn
  double height(std::size_t k, int half) const {
    double z = shown_.at(k);
    for (const ChangeShare& change : mesh_changes_near(record, k, half)) z += 0.002 * change.share;
    return z;
  }
  ShotRecord record;

 private:
  int mesh_ = 8, frame_ = 0;
  bool held_ = false;
  double risen_ = 0, jumped_ = 0;
  std::vector<double> shown_;
};

TEST(MeshChangesTest, ASheetThatRisesSteadilyIsNeverShownJumping) {
  RisingSheet sheet;
  sheet.add(10);
  sheet.add(true);
  sheet.add(9);
  constexpr int half = 4;
  double all = 0, fastest = 0;
  for (std::size_t k = 1; k < 20; ++k) {
    const double rise = sheet.height(k, half) - sheet.height(k - 1, half);
    EXPECT_GE(rise, 0.001 - 1e-12) << k;
    all += rise - 0.001;
    fastest = std::max(fastest, rise - 0.001);
  }
  EXPECT_NEAR(all, 0.002, 1e-12) << "all of it is shown, if not at once";
  // 15/8 of the mean rate, in the middle
  EXPECT_LT(fastest, 1.9 * 0.002 / (2 * half - 1));
  EXPECT_TRUE(mesh_changes_near(sheet.record, 9 - half, half).empty());
  EXPECT_TRUE(mesh_changes_near(sheet.record, 10 + half, half).empty());
}

TEST(MeshChangesTest, SharesBeforeAndAfterMeet) {
  RisingSheet sheet;
  sheet.add(10);
  sheet.add(true);
  sheet.add(9);
  for (std::size_t k = 0; k < 20; ++k)
    for (const ChangeShare& change : mesh_changes_near(sheet.record, k, 4)) {
      EXPECT_EQ(change.frame, 10u);
      EXPECT_EQ(change.share > 0, k < 10);
      EXPECT_LE(std::abs(change.share), 0.5 + 1e-12) << k;
    }
}

TEST(MeshChangesTest, ASheetAtRestIsNotMoved) {
  RisingSheet sheet;
  for (int f = 0; f < 6; ++f) sheet.add(false, 0);
  sheet.add(2);
  sheet.add(true);
  sheet.add(2);
  for (int f = 0; f < 6; ++f) sheet.add(false, 0);
  const std::size_t last = sheet.record.frames().size() - 1;
  for (std::size_t k = 0; k < 6; ++k) EXPECT_TRUE(mesh_changes_near(sheet.record, k, 8).empty());
  for (std::size_t k = last - 5; k <= last; ++k)
    EXPECT_TRUE(mesh_changes_near(sheet.record, k, 8).empty());
  EXPECT_FALSE(mesh_changes_near(sheet.record, 7, 8).empty());
  EXPECT_FALSE(mesh_changes_near(sheet.record, 9, 8).empty());
}

TEST(MeshChangesTest, NothingIsSpreadAcrossFramesInWhichOtherHandlesHold) {
  RisingSheet sheet;
  sheet.add(6);
  sheet.add(true);
  sheet.add(2);
  sheet.hold();
  sheet.add(6);
  EXPECT_FALSE(mesh_changes_near(sheet.record, 7, 8).empty());
  for (std::size_t k = 9; k < sheet.record.frames().size(); ++k)
    EXPECT_TRUE(mesh_changes_near(sheet.record, k, 8).empty());
  sheet.add(true);
  EXPECT_FALSE(mesh_changes_near(sheet.record, sheet.record.frames().size() - 2, 8).empty());
}

TEST(MeshChangesTest, ADisplacementTurnsWithTheSheet) {
  Sheet sheet = test::hex_sheet(0.1, 0.1, 8);
  test::roll(sheet, 0.03);
  Points3 displacement(sheet.x.rows(), 3);
  for (int v = 0; v < sheet.x.rows(); ++v)
    displacement.row(v) << 1e-3 * sheet.pattern(v, 0), 2e-3 * sheet.pattern(v, 1), 1e-4;
  const Points3 seen = seen_by_triangles(sheet.triangles, sheet.x, displacement);
  EXPECT_LT((seen_from_outside(sheet.triangles, sheet.x, seen) - displacement)
                .rowwise()
                .norm()
                .maxCoeff(),
            1e-12);
  const Eigen::Matrix3d turn(Eigen::AngleAxisd(1.9, Vector3d(1, 2, 3).normalized()));
  const Points3 turned = sheet.x * turn.transpose();
  EXPECT_LT((seen_from_outside(sheet.triangles, turned, seen) - displacement * turn.transpose())
                .rowwise()
                .norm()
                .maxCoeff(),
            1e-12);
}

}  // namespace
}  // namespace paperbake
