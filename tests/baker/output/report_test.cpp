// report.html as text; that browsers draw it is judged by tests/interop/report_judge.py.

#include "tests/baker/program_fixture.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>

namespace paperbake {
namespace {

namespace fs = std::filesystem;
using ReportTest = test::CommandLine;
using test::Ended;
using test::read;

nlohmann::json data_of(const std::string& page) {
  const std::string mark = "<script id=\"data\" type=\"application/json\">";
  const std::size_t from = page.find(mark) + mark.size();
  return nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from));
}

std::size_t bytes_in_base64(const std::string& text) {
  return text.size() / 4 * 3 - std::count(text.end() - 2, text.end(), '=');
}

TEST_F(ReportTest, AReportHoldsEveryFrameItsCurvesAndSettingsAndNeedsNothingElse) {
  const Ended ended = run(crumple("1-8", {"--mesh", "simulation", "--formats", "cert,report"}));
  ASSERT_EQ(ended.code, 0) << ended.err;
  const std::string page = read(fs::path(output()) / "report.html");
  EXPECT_EQ(page.find("src=\"http"), std::string::npos);
  EXPECT_EQ(page.find("@DATA@"), std::string::npos);
  const auto data = data_of(page);
  EXPECT_EQ(data["frames"].size(), 8u);
  EXPECT_EQ(data["sheets"].size(), 1u);
  const auto& sheet = data["sheets"][0];
  ASSERT_EQ(sheet["frames"].size(), 8u);
  EXPECT_EQ(sheet["meshes"].size(), 1u);
  const std::size_t vertices = bytes_in_base64(sheet["frames"][0]["x"]) / 6,
                    triangles = bytes_in_base64(sheet["meshes"][0]) / 12;
  EXPECT_NEAR(double(triangles), 200, 20);
  EXPECT_GT(vertices, triangles / 2);
  EXPECT_LT(vertices, triangles);
  EXPECT_NE(sheet["frames"][0]["x"], sheet["frames"][7]["x"]);
  for (const auto& curve : data["curves"])
    for (const auto& line : curve["lines"]) EXPECT_EQ(line["values"].size(), 8u) << line["name"];
  EXPECT_GT(data["settings"].size(), 10u);
  EXPECT_TRUE(data["missed"].empty());
  EXPECT_NE(data["good"].at(0).get<std::string>().find("keeps its size"), std::string::npos);
}

TEST_F(ReportTest, AReportOpensAtTheFrameInWhichThePaperIsFoldedMost) {
  // S3 is pushed until frame 60, and springs back when its borders are let go at 61
  const Ended ended = run({"bake", test::samples + "/S3_unload.glb", "-o", output(), "--method",
                           "fem", "--triangles", "200", "--mesh", "simulation", "--frames", "1-70",
                           "--formats", "report", "--progress", "none"});
  ASSERT_TRUE(ended.code == 0 || ended.code == 4) << ended.err;
  const auto data = data_of(read(fs::path(output()) / "report.html"));
  const int begin = data["frames"].at(data["begin"].get<std::size_t>());
  EXPECT_GE(begin, 50);
  EXPECT_LE(begin, 60);
}

}  // namespace
}  // namespace paperbake
