#include "core/step1_elastic/position_constraints.h"

#include "core/model/serializer.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

namespace paperbake {
namespace {

const PositionConstraints three{
    {7, Vector3d(1, 2, 3)}, {2, Vector3d(4, 5, 6), 0.5}, {9, Vector3d(7, 8, 9)}};

TEST(PositionConstraintsTest, EachIsHardOrSoftAndTheirOrderStays) {
  EXPECT_EQ(vertices_of(three), (std::vector<int>{7, 2, 9}));
  EXPECT_EQ(vertices_of(hard_constraints(three)), (std::vector<int>{7, 9}));
  EXPECT_EQ(hard_constraints(three)[1].target, Vector3d(7, 8, 9));
  ASSERT_EQ(vertices_of(soft_constraints(three)), std::vector<int>{2});
  EXPECT_EQ(soft_constraints(three)[0].stiffness, 0.5);
}

TEST(PositionConstraintsTest, ComeBackAsTheyWereWritten) {
  PositionConstraints written = three, read;
  Serializer out;
  out(written);
  Serializer in(out.bytes());
  in(read);
  in.end();
  ASSERT_EQ(vertices_of(read), vertices_of(three));
  for (std::size_t k = 0; k < read.size(); ++k) {
    EXPECT_EQ(read[k].target, three[k].target);
    EXPECT_EQ(read[k].stiffness, three[k].stiffness);
  }
}

TEST(PositionConstraintsTest, HeldVerticesThatKeepTheirDistancesMoveAsOneBody) {
  const Points3 x = (Points3(4, 3) << 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0.5).finished();
  const Eigen::Isometry3d way =
      Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(1.1, Vector3d(1, -2, 0.5).normalized());
  PositionConstraints held;
  for (const int v : {0, 1, 2}) held.push_back({v, way * Vector3d(x.row(v).transpose())});
  const auto motion = rigid_motion_of(x, held, 1e-9);
  ASSERT_TRUE(motion);
  EXPECT_LT(((*motion)(x.row(3)) - way * Vector3d(x.row(3).transpose())).norm(), 1e-12);

  EXPECT_FALSE(rigid_motion_of(x, {held[0], held[1]}, 1e-9)) << "two are in one line";
  PositionConstraints soft = held;
  soft[1].stiffness = 10;
  EXPECT_FALSE(rigid_motion_of(x, soft, 1e-9));
  PositionConstraints other = held;
  other[2].target.x() += 0.1;
  EXPECT_FALSE(rigid_motion_of(x, other, 0.01));
  EXPECT_TRUE(rigid_motion_of(x, other, 0.1));
}

}  // namespace
}  // namespace paperbake
