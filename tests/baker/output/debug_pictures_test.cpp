#include "baker/output/debug_pictures.h"

#include "tests/baker/output/image_pixels.h"
#include "tests/core/test_meshes.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

using test::count;
using test::orange;

/// The arch of a sheet wound to a radius, held at one corner.
struct Wound {
  Shot shot;
  Sheet sheet;
  AnimatedFrame frame;

  explicit Wound(double radius)
      : shot(test::blank_shot(test::rectangle(0.1, 0.1))), sheet(test::hex_sheet(0.1, 0.1, 12)) {
    test::roll(sheet, radius);
    shot.handles.push_back(test::bare_handle("handle", {0, 0}, 1));
    frame.sheet = &sheet;
    frame.handles.push_back({HandleFrame::held, sheet.x.row(0), sheet.x.row(0)});
  }
  Image draw() const { return debug_picture(shot, frame, "wound"); }
};

bool reddish(const Colour& c) { return c.red > c.blue + 60 && c.red > c.green + 60; }
bool bluish(const Colour& c) { return c.blue > c.red + 60 && c.blue > c.green + 20; }
bool magenta(const Colour& c) { return c == Colour{200, 0, 170}; }
int different(const Image& a, const Image& b) {
  int n = 0;
  for (std::size_t k = 0; k < a.pixels.size(); ++k) n += !(a.pixels[k] == b.pixels[k]);
  return n;
}

TEST(DebugPictureTest, BulgesAreRedAndHollowsBlue) {
  Wound wound(0.02);
  const Image out = wound.draw();
  wound.sheet.x.col(2) *= -1;
  const Image in = wound.draw();
  const int red = count(out, reddish), blue = count(in, bluish);
  const int more_than_the_legend = 100000;  // the panel has 480,000 px
  EXPECT_TRUE(
      (red > more_than_the_legend && blue > more_than_the_legend) ||
      (count(out, bluish) > more_than_the_legend && count(in, reddish) > more_than_the_legend))
      << red << " " << blue;
}

TEST(DebugPictureTest, SingularPointsAreSeenOnPatternAndSheetWithTheirNumbers) {
  Wound wound(0.05);
  EXPECT_EQ(count(wound.draw(), magenta), 0);
  wound.sheet.singular.push_back({{0.03, 0.05}, 1, "test"});
  const Image one = wound.draw();
  EXPECT_GT(count(one, magenta), 100);
  wound.sheet.singular.push_back({{0.07, 0.05}, 1, "test"});
  EXPECT_GT(count(wound.draw(), magenta), 1.8 * count(one, magenta));
}

TEST(DebugPictureTest, AJammedHandleHasAnotherColourThanAHeldOne) {
  Wound wound(0.05);
  EXPECT_EQ(count(wound.draw(), orange), 0);
  wound.frame.handles[0].state = HandleFrame::jammed;
  EXPECT_GT(count(wound.draw(), orange), 50);
}

TEST(DebugPictureTest, RulingsAndRegionsOfAMethodAreDrawnOnThePattern) {
  Wound wound(0.05);
  const Image plain = wound.draw();
  wound.frame.parts.rulings.push_back({{0.05, 0}, {0.05, 0.1}});
  EXPECT_GT(different(plain, wound.draw()), 690);  // a line from top to bottom of the panel
  wound.frame.parts = {};
  wound.frame.parts.region.assign(wound.sheet.triangles.rows(), -1);
  EXPECT_EQ(different(plain, wound.draw()), 0);
  wound.frame.parts.region[0] = 3;
  EXPECT_GT(different(plain, wound.draw()), 500);  // a triangle of 690/12 px
}

}  // namespace
}  // namespace paperbake
