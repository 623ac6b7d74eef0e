#include "core/step1_elastic/energies/crease_law.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace paperbake {
namespace {

constexpr double degrees = M_PI / 180;

const CreaseLaw law = crease_law(Paper{});
const std::array<double, 5> rests{0, 0.7, -0.7, 2.2, -2.2};  // [rad]

/// [rad] Angles beyond which a crease with this rest angle yields: k (theta - rest) - H rest is M_s
/// or -M_s there.
double yields_above(double rest) {
  return rest + (law.yield_moment + law.hardening * rest) / law.stiffness;
}
double yields_below(double rest) {
  return rest - (law.yield_moment - law.hardening * rest) / law.stiffness;
}

/// Calls test(rest, theta) for angles on both branches and on both sides, none of them at a yield
/// point.
template <class Test>
void for_all_states(const Test& test) {
  for (const double rest : rests) {
    const double low = yields_below(rest), high = yields_above(rest);
    for (const double theta : {low - 1.3, low - 0.01, low + 0.01, 0.5 * (low + high), high - 0.01,
                               high + 0.01, high + 1.3})
      test(rest, theta);
  }
}

TEST(CreaseLawTest, OfficePaperHasTheValuesOfTheDocumentation) {
  const Paper paper;
  EXPECT_DOUBLE_EQ(law.stiffness, paper.bending_stiffness / 13.5e-3);
  EXPECT_DOUBLE_EQ(law.yield_moment, 0.6 * paper.bending_stiffness * 100);  // first yield: 100 1/m
  EXPECT_DOUBLE_EQ(law.hardening, 0.03 * law.stiffness);
}

TEST(CreaseLawTest, BelowItsYieldMomentACreaseIsASpringAboutItsRestAngle) {
  for (const double rest : rests)
    for (const double share : {-0.99, -0.5, 0.0, 0.5, 0.99}) {
      const double bound = share > 0 ? yields_above(rest) : yields_below(rest),
                   theta = rest + std::abs(share) * (bound - rest), turn = theta - rest;
      const CreaseResponse response = turn_crease(law, rest, theta);
      EXPECT_DOUBLE_EQ(response.moment, law.stiffness * turn);
      EXPECT_DOUBLE_EQ(response.energy,
                       0.5 * law.stiffness * turn * turn + 0.5 * law.hardening * rest * rest);
      EXPECT_EQ(response.tangent, law.stiffness);
      EXPECT_EQ(response.rest, rest);
    }
}

TEST(CreaseLawTest, BeyondItTheMomentIsTheYieldMomentAndTheHardeningOfTheRestAngle) {
  for (const double rest : rests)
    for (const double beyond : {0.05, 0.5, 2.0})
      for (const double sign : {-1.0, 1.0}) {
        const double theta = (sign > 0 ? yields_above(rest) : yields_below(rest)) + sign * beyond,
                     p = (law.stiffness * theta - sign * law.yield_moment) /
                         (law.stiffness + law.hardening);
        const CreaseResponse response = turn_crease(law, rest, theta);
        ASSERT_GT(sign * (p - rest), 0.04);
        EXPECT_NEAR(response.rest, p, 1e-14);
        EXPECT_NEAR(response.moment, law.stiffness * (theta - p), 1e-15);
        EXPECT_NEAR(response.moment, sign * law.yield_moment + law.hardening * p, 1e-15);
        EXPECT_NEAR(response.tangent,
                    law.stiffness * law.hardening / (law.stiffness + law.hardening), 1e-15);
      }
}

TEST(CreaseLawTest, TheRestAngleIsTheOneThatNeedsTheLeastEnergy) {
  int tried = 0;
  for_all_states([&](double rest, double theta) {
    const CreaseResponse response = turn_crease(law, rest, theta);
    const auto needed = [&](double p) {
      return 0.5 * law.stiffness * (theta - p) * (theta - p) + 0.5 * law.hardening * p * p +
             law.yield_moment * std::abs(p - rest);
    };
    EXPECT_NEAR(needed(response.rest), response.energy, 1e-15);
    for (double p = -4; p <= 4; p += 1e-3) {
      EXPECT_GE(needed(p), response.energy - 1e-15) << rest << " " << theta << " " << p;
      ++tried;
    }
  });
  EXPECT_GT(tried, 10000);
}

TEST(CreaseLawTest, MomentAndTangentAreTheDerivativesOfTheEnergy) {
  const double h = 2e-5;
  double most = 0;
  for_all_states([&](double rest, double theta) {
    for (const bool pressed : {false, true}) {
      const auto at = [&](double angle) {
        return pressed ? press_crease(law, rest, 0.9, angle) : turn_crease(law, rest, angle);
      };
      const CreaseResponse up = at(theta + h), down = at(theta - h), here = at(theta);
      most = std::max(most, std::abs(here.moment));
      // both branches are parabolas: only rounding is left, 1e-15 N / 2e-5
      EXPECT_NEAR((up.energy - down.energy) / (2 * h), here.moment, 1e-10);
      EXPECT_NEAR((up.moment - down.moment) / (2 * h), here.tangent, 1e-10);
    }
  });
  ASSERT_GT(most, law.yield_moment);
}

TEST(CreaseLawTest, TheEnergyIsConvexAcrossItsYieldPoints) {
  for (const double rest : rests) {
    double last = -std::numeric_limits<double>::infinity();
    for (double theta = -4; theta <= 4; theta += 1e-3) {
      const CreaseResponse response = turn_crease(law, rest, theta);
      EXPECT_GT(response.tangent, 0);
      EXPECT_GT(response.moment, last) << rest << " " << theta;
      last = response.moment;
    }
  }
}

TEST(CreaseLawTest, AStepInPiecesLeavesTheSameRestAngleAsTheWholeStep) {
  int yielded = 0;
  for_all_states([&](double rest, double theta) {
    double after = rest;
    for (int piece = 1; piece <= 7; ++piece)
      after = turn_crease(law, after, rest + (theta - rest) * piece / 7).rest;
    const CreaseResponse whole = turn_crease(law, rest, theta);
    EXPECT_NEAR(after, whole.rest, 1e-13) << rest << " " << theta;
    EXPECT_NEAR(turn_crease(law, after, theta).moment, whole.moment, 1e-15);
    yielded += whole.rest != rest;
  });
  EXPECT_GT(yielded, 10);
}

TEST(CreaseLawTest, CopyPaperThatWasFoldedFlatKeepsARightAngleOrMoreWhenItIsLetGo) {
  for (const double sign : {-1.0, 1.0}) {
    const double kept = turn_crease(law, 0, sign * M_PI).rest;
    const CreaseResponse free = turn_crease(law, kept, kept);
    EXPECT_EQ(free.moment, 0);
    EXPECT_EQ(free.rest, kept) << "and does not creep back";
    EXPECT_GT(sign * kept, 90 * degrees);
    EXPECT_LT(sign * kept, 130 * degrees);
  }
}

TEST(CreaseLawTest, HandsPressACreaseToTheirAngleWhileItsRestAngleYieldsAsWithoutThem) {
  for_all_states([&](double rest, double theta) {
    for (const double pressed : {-1.0, 0.0, 3.0}) {
      const CreaseResponse response = press_crease(law, rest, pressed, theta);
      const double off = theta - pressed;
      EXPECT_DOUBLE_EQ(response.energy, 0.5 * law.pressing * off * off);
      EXPECT_DOUBLE_EQ(response.moment, law.pressing * off);
      EXPECT_EQ(response.tangent, law.pressing);
      EXPECT_DOUBLE_EQ(response.rest, turn_crease(law, rest, theta).rest);
    }
  });
}

}  // namespace
}  // namespace paperbake
