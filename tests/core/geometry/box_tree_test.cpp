#include "core/geometry/box_tree.h"

#include "core/geometry/box_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

namespace paperbake {
namespace {

using Eigen::Vector3d;
using Boxes = std::vector<Eigen::AlignedBox3d>;

/// Random numbers, points and boxes.
struct Dice {
  std::mt19937 random;
  explicit Dice(unsigned seed) : random(seed) {}
  double number() { return std::uniform_real_distribution<double>(-1, 1)(random); }
  Vector3d point() {
    const double x = number(), y = number();
    return {x, y, number()};
  }
  Eigen::AlignedBox3d box(double size) {
    const Vector3d at = point(), half = size * point().cwiseAbs();
    return {Vector3d(at - half), Vector3d(at + half)};
  }
  Boxes boxes(int n, double size) {
    Boxes all;
    for (int k = 0; k < n; ++k) all.push_back(box(size));
    return all;
  }
};

/// The sets of boxes that the tests are about: none, one, few, many, all at one place, and points
/// on a line.
std::vector<Boxes> sets_of_boxes() {
  Dice dice(3);
  std::vector<Boxes> sets{{}, dice.boxes(1, 0.2), dice.boxes(7, 0.3), dice.boxes(300, 0.1)};
  sets.emplace_back(20, dice.box(0.3));
  sets.emplace_back();
  for (int k = 0; k < 33; ++k)
    sets.back().emplace_back(Vector3d(0.1 * (k % 11) - 0.5, 0, 0),
                             Vector3d(0.1 * (k % 11) - 0.5, 0, 0));
  return sets;
}

std::vector<int> visited(const BoxTree& tree, const Eigen::AlignedBox3d& box) {
  std::vector<int> items;
  tree.visit(box, [&](int item) { items.push_back(item); });
  std::sort(items.begin(), items.end());
  return items;
}

std::vector<int> one_by_one(const Boxes& boxes, const Eigen::AlignedBox3d& box) {
  std::vector<int> items;
  for (std::size_t k = 0; k < boxes.size(); ++k)
    if (boxes[k].intersects(box)) items.push_back(static_cast<int>(k));
  return items;
}

TEST(BoxTreeTest, VisitsEveryItemWhoseBoxMeetsTheGivenOneOnceAndNoOther) {
  Dice dice(4);
  std::size_t met = 0;
  for (const Boxes& boxes : sets_of_boxes()) {
    BoxTree tree;
    tree.build(boxes);
    EXPECT_EQ(tree.empty(), boxes.empty());
    for (int k = 0; k < 100; ++k) {
      const Eigen::AlignedBox3d box = dice.box(0.5);
      const std::vector<int> expected = one_by_one(boxes, box);
      EXPECT_EQ(visited(tree, box), expected) << boxes.size() << " boxes";
      met += expected.size();
    }
    for (const Eigen::AlignedBox3d& box : boxes)  // which touch themselves
      EXPECT_EQ(visited(tree, box), one_by_one(boxes, box));
  }
  EXPECT_GT(met, 500u);
}

TEST(BoxTreeTest, ItemsThatWereMovedAreFoundWhereTheyAreNow) {
  Dice dice(5);
  BoxTree tree;
  for (const int n : {1, 2, 9, 200}) {
    tree.build(dice.boxes(n, 0.1));  // what was built before is gone
    for (int move = 0; move < 3; ++move) {
      const Boxes boxes = dice.boxes(n, 0.1 + move);
      tree.refit(boxes);
      for (int k = 0; k < 50; ++k) {
        const Eigen::AlignedBox3d box = dice.box(0.3);
        EXPECT_EQ(visited(tree, box), one_by_one(boxes, box)) << n << " boxes, move " << move;
      }
    }
  }
}

TEST(BoxTreeTest, KnowsWhetherABoxReachesAboveAPlane) {
  Dice dice(6);
  for (const Boxes& boxes : sets_of_boxes()) {
    BoxTree tree;
    tree.build(boxes);
    for (int k = 0; k < 50; ++k) {
      const Vector3d normal = dice.point();
      double highest = -std::numeric_limits<double>::infinity();
      for (const Eigen::AlignedBox3d& box : boxes)
        for (int corner = 0; corner < 8; ++corner)
          highest = std::max(
              highest,
              normal.dot(box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner))));
      for (const double level : {highest - 1e-9, highest + 1e-9, dice.number()})
        EXPECT_EQ(tree.reaches_above(normal, level), highest > level) << boxes.size() << " boxes";
    }
  }
}

/// An item is a point: the middle of its box.
TEST(BoxTreeTest, FindsTheNearestItemAndAsksNoneThatIsFartherThanWhatIsKnown) {
  Dice dice(7);
  for (const Boxes& boxes : sets_of_boxes())
    for (int k = 0; k < 50; ++k) {
      BoxTree tree;
      tree.build(boxes);
      const Vector3d p = 1.5 * dice.point();
      const auto distance = [&](int item) { return (boxes[item].center() - p).norm(); };
      const double infinite = std::numeric_limits<double>::infinity();
      double nearest = infinite;
      for (std::size_t item = 0; item < boxes.size(); ++item)
        nearest = std::min(nearest, distance(static_cast<int>(item)));
      for (const double within : {infinite, 1.0001 * nearest, 0.9999 * nearest, 0.2}) {
        double known = within;
        std::vector<int> asked(boxes.size(), 0);
        tree.visit_nearest(p, within, [&](int item) {
          EXPECT_LE(boxes[item].exteriorDistance(p), known + 1e-11);
          ++asked[item];
          known = std::min(known, distance(item));
          return distance(item);
        });
        EXPECT_EQ(known, std::min(within, nearest)) << boxes.size() << " boxes";
        for (const int times : asked) EXPECT_LE(times, 1);
      }
    }
}

TEST(BoxTreeTest, AllItemsAtTheSameDistanceAreAskedWhateverTheRounding) {
  Boxes boxes;
  for (int k = 0; k < 24; ++k) {  // on a circle about p, and so are the points
    const Vector3d at(0.3 + std::cos(M_PI * k / 12), -0.2 + std::sin(M_PI * k / 12), 0.7);
    boxes.emplace_back(at, at);
  }
  BoxTree tree;
  tree.build(boxes);
  int asked = 0;
  tree.visit_nearest({0.3, -0.2, 0.7}, 2, [&](int) { return ++asked, 1.0; });
  EXPECT_EQ(asked, 24);
}

TEST(BoxTreeTest, AnItemInALargeTreeIsFoundWithoutAskingMost) {
  Dice dice(8);
  const Boxes boxes = dice.boxes(4096, 0.01);
  BoxTree tree;
  tree.build(boxes);
  int asked = 0;
  for (int k = 0; k < 100; ++k) {
    const Vector3d p = dice.point();
    tree.visit_nearest(p, 10, [&](int item) {
      ++asked;
      return (boxes[item].center() - p).norm();
    });
  }
  // boxes of 0.01 stand 0.12 apart: the nearest one, and the few between which it has to choose
  EXPECT_LT(asked / 100, 12);
  EXPECT_GE(asked, 100);
}

TEST(BoxTreeTest, ABoxOfPointsIsTheSmallestAndGrowsToAllSides) {
  Points3 x(3, 3);
  x << 1, 5, -2, 0, 6, -3, 2, 4, -1;
  const Eigen::AlignedBox3d box = box_of(x), larger = grown(box, 0.5);
  EXPECT_EQ(box.min(), Vector3d(0, 4, -3));
  EXPECT_EQ(box.max(), Vector3d(2, 6, -1));
  EXPECT_EQ(larger.min(), Vector3d(-0.5, 3.5, -3.5));
  EXPECT_EQ(larger.max(), Vector3d(2.5, 6.5, -0.5));
}

}  // namespace
}  // namespace paperbake
