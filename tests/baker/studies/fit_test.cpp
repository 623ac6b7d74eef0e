#include "baker/studies/fit.h"

#include "core/geometry/random.h"
#include "core/model/error.h"
#include "tests/own_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

namespace paperbake {
namespace {

const Vector2d law(0.048, 0.014);

std::vector<Vector2d> sample(unsigned seed, int sheets, const Vector2d& mean, double deviation) {
  std::vector<Vector2d> points;
  for (int k = 0; k < sheets; ++k)
    points.push_back(mean + deviation * gaussian({seed, static_cast<std::uint32_t>(k), 0}, 0));
  return points;
}

// 95 of 100 trials: of 1,000 between 930 and 970 (three deviations of the count)
TEST(FitTest, IntervalsHoldTheTruthInNineteenOfTwentyTrials) {
  const Vector2d truth(0.002, -0.001);
  constexpr double deviation = 0.004;
  int in_u = 0, in_v = 0, in_deviation = 0;
  for (unsigned trial = 0; trial < 1000; ++trial) {
    const ScatterFit fit = fit_scatter(sample(trial, 20, law + truth, deviation), law);
    in_u += fit.offset_u.holds(truth.x());
    in_v += fit.offset_v.holds(truth.y());
    in_deviation += fit.deviation_within.holds(deviation);
  }
  for (const int held : {in_u, in_v, in_deviation}) EXPECT_NEAR(held, 950, 21);
}

TEST(FitTest, LikeliestDeviationIsTheRootMeanSquareAboutTheMean) {
  const ScatterFit fit = fit_scatter({law + Vector2d(3e-3, 0), law - Vector2d(3e-3, 0),
                                      law + Vector2d(0, 4e-3), law - Vector2d(0, 4e-3)},
                                     law);
  EXPECT_LT(fit.offset.norm(), 1e-15);
  EXPECT_NEAR(fit.likeliest, 2.5e-3, 1e-12);  // sum 50 mm2 over 2 n = 8
  EXPECT_NEAR(fit.deviation, std::sqrt(50.0 / 6) * 1e-3, 1e-12);
  // chi squared of 6 degrees: 1.2373, 14.4494
  EXPECT_NEAR(fit.deviation_within.low, std::sqrt(50 / 14.4494) * 1e-3, 1e-8);
  EXPECT_NEAR(fit.deviation_within.high, std::sqrt(50 / 1.2373) * 1e-3, 1e-6);
  // Student's t of 6 degrees
  EXPECT_NEAR(fit.offset_u.high, 2.4469 * fit.deviation / 2, 1e-7);
}

TEST(FitTest, SamplesOfOneLawAreNotToldApartAndOthersAre) {
  int alike = 0;
  for (unsigned trial = 0; trial < 40; ++trial)
    alike +=
        compare_samples(sample(trial, 20, law, 0.005), sample(trial + 1000, 20, law, 0.005)).p >
        0.05;
  EXPECT_GE(alike, 34);  // 38 expected
  EXPECT_LT(
      compare_samples(sample(1, 20, law, 0.005), sample(2, 20, law + Vector2d(0.005, 0.005), 0.005))
          .p,
      0.01);
  EXPECT_LT(compare_samples(sample(1, 30, law, 0.005), sample(2, 30, law, 0.0015)).p, 0.01);
}

TEST(FitTest, FittedGradeReadsAsThePresetItIs) {
  const ScatterFit fit = fit_scatter(sample(7, 20, law, 0.003), law);
  const Preset mine = with_scatter(read_preset("copy70"), "mine", fit, "points \"a\".csv");
  const auto path = test::own_folder() / "paperbake_fit_mine.toml";
  std::ofstream(path) << preset_text(mine);
  const Preset read = read_preset(path.string());
  EXPECT_EQ(read.paper.name, "mine");
  EXPECT_NEAR(read.paper.apex_scatter, fit.deviation, 1e-6);
  EXPECT_EQ(read.paper.bending_stiffness, 2.7e-4);
  EXPECT_EQ(read.description, read_preset("copy70").description);
  ASSERT_EQ(read.entries.size(), mine.entries.size());
  for (const Preset::Entry& e : read.entries) {
    if (e.key != "apex_scatter") continue;
    EXPECT_EQ(e.mark, "derived");
    EXPECT_NE(e.source.find("points \"a\".csv"), std::string::npos);
  }
}

TEST(FitTest, BadFilesAreNamedWithTheirLine) {
  const auto path = test::own_folder() / "paperbake_fit_points.csv";
  const auto error = [&](const std::string& text) {
    std::ofstream(path) << text;
    try {
      read_scatter(path);
    } catch (const Error& e) {
      EXPECT_EQ(e.code, ErrorCode::command);
      return std::string(e.what());
    }
    return std::string("read");
  };
  EXPECT_NE(error("").find("empty"), std::string::npos);
  EXPECT_NE(error("u,w\n").find(":1\n  There is no column \"v\""), std::string::npos);
  EXPECT_NE(error("u,v\n0.05,0.01\n0.05,x\n").find(":3\n  \"x\" is no number"), std::string::npos);
  EXPECT_NE(error("u,v\n0.05\n").find(":2\n"), std::string::npos);
  EXPECT_NE(error("u,v\n50,10\n").find("beside the sheet"), std::string::npos);
  EXPECT_NE(error("u,v\nnan,0.01\n").find("beside the sheet"), std::string::npos);
  EXPECT_NE(error("u,v\n0.05,0.01\n").find("1 points say nothing"), std::string::npos);
  EXPECT_EQ(error("name, u ,\"v\"\r\na,0.05,0.01\r\n\nb,0.05,0.012\nc,0.04,0.01\n"), "read");
}

}  // namespace
}  // namespace paperbake
