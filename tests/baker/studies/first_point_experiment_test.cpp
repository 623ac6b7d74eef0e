#include "baker/studies/first_point_experiment.h"

#include "formats/config/preset_file.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

// the core of positive Gauss curvature that fine finite elements have there: (50 +- 2, 10-20) mm
TEST(FirstPointExperimentTest, TheMeanOfTheLawLiesInTheCoreThatFineFiniteElementsHave) {
  for (const char* grade : {"copy70", "copy90"}) {
    Paper paper = read_preset(grade).paper;
    paper.apex_scatter = 0;  // the mean itself is drawn
    const auto point = first_singular_point(paper, 1);
    ASSERT_TRUE(point) << grade;
    EXPECT_NEAR(point->pattern.x(), 0.050, 0.002) << grade;
    EXPECT_NEAR(point->pattern.y(), 0.015, 0.005) << grade;
    EXPECT_GT(point->frame, 24) << grade;
  }
}

TEST(FirstPointExperimentTest, SheetsDifferByTheDrawAlone) {
  const Paper paper = read_preset("copy70").paper;
  const auto one = first_singular_point(paper, 1), again = first_singular_point(paper, 1),
             other = first_singular_point(paper, 2);
  ASSERT_TRUE(one && again && other);
  EXPECT_TRUE(one->pattern == again->pattern);
  EXPECT_GT((one->pattern - other->pattern).norm(), 1e-4);
  EXPECT_EQ(one->frame, other->frame);
}

TEST(FirstPointExperimentTest, ScatterIsTheDeviationOfBothDirections) {
  const std::vector<FirstPoint> points{{{0.05, 0.01}, 1, 40},
                                       {{0.05, 0.02}, 2, 41},
                                       {{0.044, 0.015}, 3, 40},
                                       {{0.056, 0.015}, 4, 40}};
  const Scatter scatter = scatter_of(points);
  EXPECT_NEAR(scatter.mean.x(), 0.05, 1e-15);
  EXPECT_NEAR(scatter.mean.y(), 0.015, 1e-15);
  EXPECT_NEAR(scatter.deviation, std::sqrt((2 * 25 + 2 * 36) / 6.0) * 1e-3, 1e-12);
  EXPECT_EQ(scatter_csv(points).substr(0, 30), "u,v,seed,frame\n0.05,0.01,1,40\n");
}

}  // namespace
}  // namespace paperbake
