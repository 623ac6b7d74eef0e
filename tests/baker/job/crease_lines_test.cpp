#include "baker/job/crease_lines.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

/// A page with three creases: one elsewhere, one that is drawn so far [m] beside a line along which
/// hands fold it, and one that ends there.
SceneSheet page_with_creases(double beside) {
  SceneSheet sheet;
  sheet.name = "page";
  sheet.pattern.outline = {{0, 0}, {0.21, 0}, {0.21, 0.3}, {0, 0.3}};
  // the last one ends on the second one, which takes its end along
  const Vector2d end(0.1, 0.1 + (1 - 1.5 * 0.1 / 0.21) * beside);
  sheet.pattern.prescribed_creases = {{{{0, 0.25}, {0.21, 0.25}}},
                                      {{{0, 0.1 + beside}, {0.21, 0.1 - 0.5 * beside}}},
                                      {{end, {0.1, 0.2}}}};
  sheet.crease_origin = {"edges", "edges", "edges"};
  sheet.handles.resize(2);
  return sheet;
}

std::vector<ExpectedCrease> fold_at_100_mm() {
  ExpectedCrease fold;
  fold.line = {{0, 0.1}, {0.21, 0.1}};
  fold.creases = {1};
  fold.turn = {2};
  fold.plate = {0};
  fold.other = {1};
  return {fold};
}

TEST(CreaseLines, TellHowFarADrawnCreaseWasMoved) {
  const std::vector<CreaseLine> lines = crease_lines(page_with_creases(0.002), fold_at_100_mm());
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0].moved, 0);
  EXPECT_EQ(lines[2].moved, 0) << "only its end was, to stay on the other one";
  EXPECT_NEAR(lines[2].line.front().y(), 0.1, 1e-9);
  EXPECT_NEAR(lines[1].moved, 0.002, 1e-9);
  const std::vector<std::string> sentences = describe_moved("page", 0.3, lines);
  ASSERT_EQ(sentences.size(), 1u);
  EXPECT_EQ(sentences[0].find("Crease 2 of \"page\" is moved by up to 2.0 mm"), 0u) << sentences[0];
}

TEST(CreaseLines, AreNotSaidToBeMovedByWhatHandlesMayBeOff) {
  const std::vector<CreaseLine> lines = crease_lines(page_with_creases(0.001), fold_at_100_mm());
  EXPECT_NEAR(lines.at(1).moved, 0.001, 1e-9) << "half a percent of the side is 1.5 mm";
  EXPECT_TRUE(describe_moved("page", 0.3, lines).empty());
}

}  // namespace
}  // namespace paperbake
