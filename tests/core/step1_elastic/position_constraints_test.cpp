#include "core/step1_elastic/position_constraints.h"

#include "core/model/serializer.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace paperbake
