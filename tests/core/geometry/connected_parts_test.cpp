#include "core/geometry/connected_parts.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

TEST(ConnectedPartsTest, VerticesThatTrianglesConnectHaveTheLowestOfThemInCommon) {
  Triangles triangles(4, 3);  // the last one joins the parts of the first two; 5 is in none
  triangles << 9, 8, 7, 2, 3, 4, 0, 1, 6, 4, 7, 3;
  EXPECT_EQ(connected_parts(triangles, 10), (std::vector<int>{0, 0, 2, 2, 2, 5, 0, 2, 2, 2}));
  EXPECT_TRUE(connected_parts(Triangles(0, 3), 0).empty());
}

}  // namespace
}  // namespace paperbake
