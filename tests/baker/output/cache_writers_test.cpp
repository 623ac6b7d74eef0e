// Two sheets in one scene: one .abc and .usda for both, maps and point caches for each, numbers
// that agree.

#include "formats/cache/alembic_reader.h"
#include "tests/baker/program_fixture.h"
#include "tests/formats/maps/crease_map_fixture.h"
#include "tests/formats/scene/gltf_fixture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <string>

namespace paperbake {
namespace {

namespace fs = std::filesystem;
using CacheWritersTest = test::CommandLine;
using test::Ended;
using test::fields_of;
using test::lines_of;
using test::read;

/// Two sheets beside each other, each crumpled by eight handles in 24 frames, one a little farther
/// than the other.
fs::path two_crumples() {
  test::GltfFixture scene;
  for (int s = 0; s < 2; ++s) {
    const double left = 0.6 * s;
    scene.mesh(s ? "paper.right" : "paper.left",
               test::grid(4, 4, 0.2, 0.2, nullptr,
                          [&](double u, double v) { return Vector3d(left + u, v, 0); }));
    for (int h = 0; h < 8; ++h) {
      const double turn = h * M_PI / 4, far = h % 2 ? 0.125 : 0.09;
      const Vector3d middle(left + 0.1, 0.1, 0),
          at = middle + far * Vector3d(std::cos(turn), std::sin(turn), 0);
      const int node = scene.node((s ? "handle.right." : "handle.left.") + std::to_string(h), at);
      scene.move(
          node, {1, 25},
          {at, middle + (s ? 0.5 : 0.55) * (at - middle) + Vector3d(0, 0, h % 3 ? 0.01 : -0.015)});
    }
  }
  return scene.write("two_crumples.gltf");
}

TEST_F(CacheWritersTest,
       TwoSheetsAreInEveryFormatAndTheirMapsNumberTheirSingularPointsAsTheListDoes) {
  const Ended ended = run({"bake", two_crumples(), "-o", output(), "--fps", "24", "--frames",
                           "1-24", "--quality", "draft", "--map-size", "256", "--formats",
                           "abc,maps,cert,report,usd,pc2", "--max-stretch", "30"});
  ASSERT_TRUE(ended.code == 0 || ended.code == 4) << ended.err;
  const fs::path out = output();
  const AlembicReader cache(out / "two_crumples.abc");
  ASSERT_EQ(cache.sheets().size(), 2u);
  for (std::size_t s = 0; s < 2; ++s) EXPECT_EQ(cache.sheets()[s].frames, 24u);
  EXPECT_GT(cache.frame(1, 23).x.col(0).minCoeff(), cache.frame(0, 23).x.col(0).maxCoeff());
  const std::string layer = read(out / "two_crumples.usda"), page = read(out / "report.html");
  for (const char* name : {"paper_left", "paper_right"})
    EXPECT_NE(layer.find("def Mesh \"" + std::string(name) + "\""), std::string::npos);
  EXPECT_NE(page.find("paper.left: creases"), std::string::npos);
  EXPECT_NE(page.find("paper.right: creases"), std::string::npos);
  EXPECT_EQ(run({"verify", output()}).code, 0);

  std::map<std::string, std::vector<std::pair<unsigned, Vector2d>>> points;
  for (const std::string& line : lines_of(read(out / "singular.csv")))
    if (const auto row = fields_of(line); row[0] != "id")
      points[row[1]].push_back(
          {static_cast<unsigned>(std::stoul(row[0])), {std::stod(row[3]), std::stod(row[4])}});
  for (const std::string side : {"left", "right"}) {
    const std::string stem = "two_crumples.paper_" + side;
    EXPECT_EQ(fs::file_size(out / (stem + ".pc2")),
              32 + 24u * 12 * cache.frame(side == "right", 0).x.rows());
    EXPECT_TRUE(fs::is_regular_file(out / (stem + ".rest.obj")));
    EXPECT_TRUE(fs::is_regular_file(out / "maps" / (stem + ".0001.exr")));
    const test::Image map = test::read_image(out / "maps" / (stem + ".final.exr"));
    const auto& of_sheet = points["paper." + side];
    ASSERT_GT(of_sheet.size(), 1u) << "without points this proves nothing";
    int seen = 0;
    for (const auto& [id, at] : of_sheet) {
      const int i = std::clamp<int>(at.x() / 0.2 * 256, 0, 255),
                j = std::clamp<int>(256 - at.y() / 0.2 * 256, 0, 255);
      double nearest = 1;
      for (const auto& [other, place] : of_sheet)
        if (other != id) nearest = std::min(nearest, (place - at).norm());
      if (nearest < 2 * 0.2 / 256) continue;  // two of them share the texel
      EXPECT_EQ(map.at(i, j).apex_id, id) << side;
      ++seen;
    }
    EXPECT_GT(seen, 0);
  }
}

}  // namespace
}  // namespace paperbake
