#include "core/geometry/singular_vertices.h"

#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

TEST(SingularVertices, AreThoseAtSingularPointsAndNoOthers) {
  Sheet sheet = test::strip_sheet(0.1, 0.02, 5);
  sheet.singular = {{sheet.pattern.row(5), 1, ""}, {sheet.pattern.row(2), 4, ""}};
  sheet.singular.push_back({sheet.pattern.row(7).transpose() + Vector2d(1e-6, 0), 5, ""});
  const std::vector<char> singular = singular_vertices(sheet);
  ASSERT_EQ(static_cast<long>(singular.size()), sheet.pattern.rows());
  for (int v = 0; v < sheet.pattern.rows(); ++v) EXPECT_EQ(singular[v], v == 5 || v == 2) << v;
  EXPECT_TRUE(is_at_vertex(sheet.singular[1], sheet, 2));
  EXPECT_FALSE(is_at_vertex(sheet.singular[2], sheet, 7));
}

}  // namespace
}  // namespace paperbake
