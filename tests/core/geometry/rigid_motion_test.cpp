#include "core/geometry/rigid_motion.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <random>

namespace paperbake {
namespace {

using Eigen::Matrix3d;

/// Random points, turns and motions.
struct Dice {
  std::mt19937 random{11};
  double number() { return std::uniform_real_distribution<double>(-1, 1)(random); }
  Vector3d point() {
    const double x = number(), y = number();
    return {x, y, number()};
  }
  Points3 points(int n) {
    Points3 x(n, 3);
    for (int k = 0; k < n; ++k) x.row(k) = point();
    return x;
  }
  RigidMotion motion(double angle) {
    const Matrix3d turn = Eigen::AngleAxisd(angle, point().normalized()).toRotationMatrix();
    return {turn, point()};
  }
};

double off(const RigidMotion& a, const RigidMotion& b) {
  return (a.turn - b.turn).norm() + (a.shift - b.shift).norm();
}

/// Sum of the squares that the nearest motion minimises.
double misfit(const RigidMotion& motion, const Points3& points, const Points3& targets,
              const Eigen::VectorXd& weights) {
  return weights.dot((moved(motion, points) - targets).rowwise().squaredNorm());
}

void expect_rigid(const RigidMotion& motion) {
  EXPECT_LT((motion.turn.transpose() * motion.turn - Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_NEAR(motion.turn.determinant(), 1, 1e-12);
}

TEST(RigidMotionTest, HalfOfAMotionDoneTwiceIsTheMotion) {
  Dice dice;
  for (const double angle : {0.0, 1e-9, 0.3, M_PI / 2, 3.0, M_PI - 1e-6}) {
    const RigidMotion motion = dice.motion(angle), half = half_of(motion);
    expect_rigid(half);
    EXPECT_LT(off({half.turn * half.turn, half(half.shift)}, motion), 1e-12) << angle;
    EXPECT_NEAR(Eigen::AngleAxisd(half.turn).angle(), angle / 2, 1e-7) << "the shorter way round";
  }
}

TEST(RigidMotionTest, HalfWayOfAPointThatTheMotionTakesToItsTargetIsOnTheArc) {
  // a quarter turn about the z axis
  const RigidMotion quarter{Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitZ()).toRotationMatrix(),
                            Vector3d(0, 0, 0)};
  const Vector3d from(1, 0, 0), half(std::sqrt(0.5), std::sqrt(0.5), 0), rest(0.1, 0.2, -0.3);
  EXPECT_LT((half_way(quarter, from, {0, 1, 0}) - half).norm(), 1e-14);
  EXPECT_LT((half_way(quarter, from, Vector3d(0, 1, 0) + rest) - half - rest / 2).norm(), 1e-14)
      << "straight for what is left";
}

TEST(RigidMotionTest, MovedPointsAreWhereTheMotionTakesEach) {
  Dice dice;
  const RigidMotion motion = dice.motion(1.3);
  const Points3 x = dice.points(5), y = moved(motion, x);
  for (int k = 0; k < 5; ++k)
    EXPECT_LT((y.row(k).transpose() - motion.turn * x.row(k).transpose() - motion.shift).norm(),
              1e-14);
}

TEST(RigidMotionTest, TheMotionBetweenPointsThatMovedAsOneBodyIsTheirs) {
  Dice dice;
  for (const double angle : {0.0, 0.7, 2.5, M_PI})
    for (const int n : {3, 4, 20}) {
      const RigidMotion motion = dice.motion(angle);
      Points3 x = dice.points(n);
      if (n == 4) x.col(2).setZero();  // in a plane, as a sheet on its pattern
      EXPECT_LT(off(nearest_rigid_motion(x, moved(motion, x)), motion), 1e-12) << angle;
    }
}

TEST(RigidMotionTest, NoMotionNearTheNearestOneIsNearer) {
  Dice dice;
  for (int k = 0; k < 50; ++k) {
    const Points3 x = dice.points(6);
    Points3 to = dice.points(6);         // anywhere
    if (k % 2) to = x, to.col(0) *= -1;  // in the mirror, where no turn takes them
    const Eigen::VectorXd weights = dice.points(6).col(0).cwiseAbs(), equal = weights.Ones(6);
    for (const Eigen::VectorXd& w : {weights, equal}) {
      const RigidMotion best =
          w == equal ? nearest_rigid_motion(x, to) : nearest_rigid_motion(x, to, w);
      expect_rigid(best);
      const double least = misfit(best, x, to, w);
      ASSERT_GT(least, 1e-2);
      for (int i = 0; i < 60; ++i) {  // nearby, and all others
        const RigidMotion by = dice.motion(i < 30 ? 1e-3 : M_PI * dice.number());
        const RigidMotion other{by.turn * best.turn, best.shift + (i < 30 ? 1e-3 : 1) * by.shift};
        EXPECT_GT(misfit(other, x, to, w), least) << k;
      }
    }
  }
}

TEST(RigidMotionTest, AWeightIsANumberOfEqualPoints) {
  Dice dice;
  const Points3 x = dice.points(4), to = dice.points(4);
  Points3 more_x(7, 3), more_to(7, 3);
  more_x << x, x.row(1), x.row(1), x.row(3);
  more_to << to, to.row(1), to.row(1), to.row(3);
  EXPECT_LT(off(nearest_rigid_motion(x, to, Eigen::Vector4d(1, 3, 1, 2)),
                nearest_rigid_motion(more_x, more_to)),
            1e-12);
}

TEST(RigidMotionTest, ThereIsAMotionBetweenPointsThatAreNoFartherOffThanTheSlack) {
  Dice dice;
  const Points3 x = dice.points(8);
  const RigidMotion motion = dice.motion(1);
  // one of three points is pulled away along their line by 0.3: the nearest motion makes up for 0.1
  Points3 line(3, 3), to(3, 3);
  line << 0, 0, 0, 1, 0, 0, 2, 0, 0;
  to << 0, 0, 0, 1, 0, 0, 2.3, 0, 0;
  EXPECT_TRUE(rigid_motion_between(line, moved(motion, to), 0.2001));
  EXPECT_FALSE(rigid_motion_between(line, moved(motion, to), 0.1999));
  const auto found = rigid_motion_between(x, moved(motion, x), 1e-12);
  ASSERT_TRUE(found);
  EXPECT_LT(off(*found, motion), 1e-12);
  Points3 broken = moved(motion, x);
  broken(3, 1) = std::nan("");
  EXPECT_FALSE(rigid_motion_between(x, broken, 1e9)) << "nothing is known of one of them";
}

TEST(RigidMotionTest, HeldPointsTakeTheWholeSheetWithThem) {
  Dice dice;
  const Points3 x = dice.points(200);
  const RigidMotion motion = dice.motion(2);
  Points3 to = x;  // all others stay where they are
  const std::vector<int> held{3, 50, 51, 120};
  for (const int v : held) to.row(v) = motion(x.row(v).transpose());
  const RigidMotion whole = motion_with_held(x, to, held);
  // four points against the 196 that count as a thousandth of one
  EXPECT_LT(off(whole, motion), 5e-3);
  EXPECT_GT(off(nearest_rigid_motion(x, to), motion), 1);
}

TEST(RigidMotionTest, AHeldPointCountsAThousandTimesAsMuchAsAllFreeOnes) {
  // a cross whose middle is held while its ends want to go up
  Points3 x(5, 3), to(5, 3);
  x << 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0;
  to = x;
  to.bottomRows(4).col(2).array() += 1;
  const RigidMotion motion = motion_with_held(x, to, {0});
  EXPECT_LT((motion.turn - Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_LT((motion.shift - Vector3d(0, 0, 4 / (1000 * 5 + 4.0))).norm(), 1e-12);
}

TEST(RigidMotionTest, FreePointsSayHowTheSheetTurnsAboutThoseThatAreHeld) {
  Dice dice;
  Points3 x = dice.points(30);
  x.topRows(2).rightCols(2).setZero();  // two on the x axis, which stay
  const RigidMotion about{Eigen::AngleAxisd(1.2, Vector3d::UnitX()).toRotationMatrix(),
                          Vector3d(0, 0, 0)};
  EXPECT_LT(off(motion_with_held(x, moved(about, x), {0, 1}), about), 1e-10);
}

}  // namespace
}  // namespace paperbake
