#include "core/step1_elastic/contact/barrier.h"

#include <gtest/gtest.h>

#include <cmath>

namespace paperbake {
namespace {

TEST(BarrierTest, SlopeAndSecondAreDerivativesOfTheValue) {
  const double dhat = 2e-3, step = 1e-9;
  for (const double d : {1e-5, 2e-4, 1e-3, 1.9e-3}) {
    const Barrier b = barrier(d, dhat);
    ASSERT_LT(b.slope, -1e-6);
    EXPECT_NEAR((barrier(d + step, dhat).value - barrier(d - step, dhat).value) / (2 * step),
                b.slope, 1e-5 * std::abs(b.slope) + 1e-7);
    EXPECT_NEAR((barrier(d + step, dhat).slope - barrier(d - step, dhat).slope) / (2 * step),
                b.second, 1e-5 * b.second + 1e-4);
    EXPECT_GE(b.second, 0);
  }
  EXPECT_EQ(barrier(dhat, dhat).value, 0);
  EXPECT_EQ(barrier(dhat, dhat).slope, 0);
}

}  // namespace
}  // namespace paperbake
