#include "baker/studies/chart.h"

#include "baker/studies/chart_picture.h"
#include "tests/baker/program_fixture.h"
#include "tests/formats/scene/gltf_fixture.h"

#include <gtest/gtest.h>

#include <cmath>

namespace paperbake {
namespace {

using ChartCommandTest = test::CommandLine;
using test::Ended;
using test::fields_of;
using test::is_error;
using test::lines_of;
using test::read;

ChartPoint point(const std::string& method, int size, double ms, double rms) {
  ChartPoint p;
  p.method = method;
  p.size = size;
  p.triangles = size;
  p.elastic_ms = ms;
  p.rms_pct = rms;
  p.c_m_pct = 0.01;
  p.energy_rel = 1;
  return p;
}

TEST(ChartTest, RichardsonFindsTheErrorOfAPowerLaw) {
  for (const double q : {0.5, 1.0, 1.7}) {
    const auto error = [&](double n) { return 30 * std::pow(n, -q); };
    EXPECT_NEAR(richardson_error(error(1500) - error(6000), error(3000) - error(6000)), error(6000),
                1e-9 * error(6000))
        << q;
  }
  // no convergence: slow at best
  EXPECT_NEAR(richardson_error(1.0, 1.0), 1 / (std::exp2(0.25) - 1), 1e-12);
}

TEST(ChartTest, TheFrontHasThePointsThatNoOtherBeatsInBoth) {
  ChartPoint failed = point("fem", 50, 0.1, 0.01);
  failed.failure = "out of time";
  const std::vector<ChartPoint> points{point("fem", 6000, 100, 0),  point("fem", 1500, 20, 0.02),
                                       point("hybrid", 90, 1, 0.2), point("hybrid", 60, 0.5, 0.4),
                                       point("fem", 200, 2, 0.3),   failed};
  EXPECT_EQ(pareto_front(points), (std::vector<int>{3, 2, 1}));
}

TEST(ChartTest, ThePictureNamesEveryMethodAndSaysWhatDidNotFinish) {
  Chart chart;
  chart.scene = "folds & <creases>";
  chart.points = {point("fem", 6000, 100, 0), point("fem", 1500, 20, 0.02),
                  point("hybrid", 90, 1, 0.2)};
  chart.reference_error_pct = 0.004;
  const std::string whole = chart_svg(chart);
  EXPECT_NE(whole.find("folds &amp; &lt;creases&gt;"), std::string::npos);
  EXPECT_NE(whole.find(">hybrid</text>"), std::string::npos);
  EXPECT_EQ(whole.find("unfinished"), std::string::npos);
  chart.points[1].failure = "out of time at frame 3";
  EXPECT_NE(chart_svg(chart).find(">1500 unfinished</text>"), std::string::npos);
}

TEST_F(ChartCommandTest, AChartHasARowForEveryRunAndTheHybridComesNearTheReference) {
  const Ended ended = run({"chart", test::samples + "/S1_push.glb", "-o", output(), "--frames",
                           "1-12", "--reference", "800", "--repeat", "1", "--budget", "60"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const std::vector<std::string> rows = lines_of(read(output() + "/chart.csv"));
  ASSERT_GT(rows.size(), 6u);
  EXPECT_EQ(rows[0],
            "method,size,seed,triangles,elastic_ms,geometry_ms,total_ms,worst_frame_ms,c_m_pct,max_"
            "stretch_pct,rms_pct,energy_rel,not_converged,failed");
  int hybrids = 0;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const std::vector<std::string> f = fields_of(rows[k]);
    ASSERT_EQ(f.size(), 14u);
    EXPECT_EQ(f[13], "0") << rows[k];
    EXPECT_GT(std::stod(f[6]), 0) << rows[k];
    if (k == 1) {
      EXPECT_EQ(f[0] + f[10], "fem0.000000");
      continue;
    }
    EXPECT_GT(std::stod(f[10]), 0) << rows[k];
    if (f[0] != "hybrid") continue;
    ++hybrids;
    EXPECT_LT(std::stod(f[10]), 1) << rows[k];  // % of the sheet; it is pushed by 8 %
  }
  EXPECT_EQ(hybrids, 4);  // no singular point, so one seed
  EXPECT_NE(read(output() + "/chart.svg").find("</svg>"), std::string::npos);
  EXPECT_EQ(lines_of(read(output() + "/statistics.csv")).size(), rows.size());
}

TEST_F(ChartCommandTest, AChartOfASheetThatSwingsLeavesOutWhatIsAtRest) {
  test::GltfFixture scene;
  scene.mesh("paper", test::grid(2, 2, 0.1, 0.1));
  for (const Vector3d& at : {Vector3d(0, 0, 0), Vector3d(0, 0.1, 0)})
    scene.move(scene.node(fmt::format("handle_{}", at.y()), at), {1, 4}, {at, at});
  const Ended ended = run({"chart", scene.write("swings.gltf"), "-o", output(), "--gravity", "9.81",
                           "--reference", "400", "--repeat", "1", "--budget", "60"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_NE(read(output() + "/chart.csv").find("\nhybrid,"), std::string::npos);
  EXPECT_EQ(read(output() + "/chart.csv").find("\nhybrid+fem,"), std::string::npos);
  EXPECT_NE(read(output() + "/chart.svg").find("hybrid+fem left out"), std::string::npos);
}

TEST_F(ChartCommandTest, AChartOfAnUnknownMethodOrSceneEndsWithTwoOrThree) {
  EXPECT_TRUE(is_error(
      run({"chart", test::samples + "/S1_push.glb", "-o", output(), "--methods", "hybrid,spline"}),
      2, "--methods", "spline"));
  EXPECT_TRUE(
      is_error(run({"chart", "nowhere.glb", "-o", output()}), 3, "nowhere.glb", "no such file"));
  EXPECT_FALSE(test::fs::exists(output() + "/chart.csv"));
}

TEST_F(ChartCommandTest, AChartWithoutTimeForItsReferenceSaysSo) {
  const Ended ended = run({"chart", test::samples + "/S4_crumple.glb", "-o", output(),
                           "--reference", "6000", "--budget", "0.02"});
  EXPECT_EQ(ended.code, 1) << ended.err;
  EXPECT_NE(ended.err.find("--budget"), std::string::npos) << ended.err;
}

}  // namespace
}  // namespace paperbake
