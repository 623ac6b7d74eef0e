// The contact sheet of a bake: which frames, what is seen of paper and handles, and the file that
// the program writes.

#include "baker/output/preview.h"

#include "tests/baker/output/image_pixels.h"
#include "tests/baker/program_fixture.h"
#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

namespace paperbake {
namespace {

namespace fs = std::filesystem;
using PreviewCommandTest = test::CommandLine;
using test::count;
using test::Ended;
using test::orange;
using test::read;

CacheFrame flat(const Vector3d& shift = {0, 0, 0}) {
  const Sheet sheet = test::hex_sheet(0.1, 0.1, 8);
  CacheFrame frame;
  frame.x = sheet.x.rowwise() + shift.transpose();
  frame.triangles = sheet.triangles;
  return frame;
}

Panel panel(CacheFrame frame) { return {{"1"}, {std::move(frame)}, {}, {}}; }

bool warm(const Colour& c) { return c.red > 100 && c.red > c.blue + 3; }  // of the front
bool cool(const Colour& c) { return c.red > 60 && c.blue > c.red + 10; }  // of the back
bool green(const Colour& c) { return c == Colour{10, 170, 70}; }

TEST(PreviewTest, FramesAreEvenlyApartEndWithTheLastAndAreSixteenAtMost) {
  for (const FrameSpan& frames : std::vector<FrameSpan>{
           {1, 96, 1}, {1, 17, 1}, {5, 5, 1}, {3, 140, 4}, {1, 1000, 1}, {10, 25, 1}}) {
    const FrameSpan shown = preview_frames(frames);
    const int last = frames.last - (frames.last - frames.first) % frames.step,
              panels = (shown.last - shown.first) / shown.step + 1;
    EXPECT_EQ(shown.last, last);
    EXPECT_EQ((shown.last - shown.first) % shown.step, 0);
    for (int f = shown.first; f <= shown.last; f += shown.step)
      EXPECT_TRUE(frames.contains(f)) << f;
    EXPECT_LT(shown.first - frames.first, shown.step)
        << "one more would have fitted before the first";
    EXPECT_LE(panels, 16);
    EXPECT_GE(panels, std::min(9, (last - frames.first) / frames.step + 1));
  }
  EXPECT_EQ(preview_frames({1, 16, 1}).step, 1);
}

TEST(PreviewTest, TheBackOfPaperIsBluerThanItsFront) {
  CacheFrame turned = flat();
  turned.triangles.col(1).swap(turned.triangles.col(2));
  const Image front = contact_sheet("", {panel(flat())}), back = contact_sheet("", {panel(turned)});
  EXPECT_GT(count(front, warm), 100000);
  EXPECT_EQ(count(front, cool), 0);
  EXPECT_GT(count(back, cool), 100000);
}

TEST(PreviewTest, ACreasePartsLightFromDark) {
  CacheFrame roof = flat();
  for (Eigen::Index v = 0; v < roof.x.rows(); ++v)
    roof.x(v, 2) = -0.5 * std::abs(roof.x(v, 0) - 0.05);
  const Image image = contact_sheet("", {panel(roof)});
  const int lit = count(image, [](const Colour& c) { return c.red > 200; });
  const int shaded =
      count(image, [](const Colour& c) { return c.red > 70 && c.red < 150 && c.red >= c.blue; });
  EXPECT_GT(lit, 50000);
  EXPECT_GT(shaded, 50000);
}

TEST(PreviewTest, OneCameraSeesAllPanels) {
  const Image image = contact_sheet("", {panel(flat()), panel(flat({0.1, 0, 0}))});
  // of the paper in these columns [px], from the first of them
  const auto middle = [&](int from, int to) {
    double sum = 0, n = 0;
    for (int row = 0; row < image.height; ++row)
      for (int column = from; column < to; ++column)
        if (warm(image.at(column, row))) {
          sum += column - from;
          ++n;
        }
    return sum / n;
  };
  EXPECT_GT(middle(654, 1300), middle(8, 654) + 100)
      << "what moves to the right must do so in the picture";
}

TEST(PreviewTest, HandlesAreGreenWhereTheyHoldAndOrangeWhereJammed) {
  Panel held = panel(flat());
  HandleRecord handle;
  handle.held = {0.05, 0.05, 0};
  handle.state = HandleFrame::held;
  EXPECT_EQ(count(contact_sheet("", {held}), green), 0);
  held.handles = {handle};
  EXPECT_GT(count(contact_sheet("", {held}), green), 5);
  held.handles[0].state = HandleFrame::jammed;
  EXPECT_GT(count(contact_sheet("", {held}), orange), 5);
  const int seen = count(contact_sheet("", {held}), orange);
  held.handles[0].held.z() = -0.05;
  EXPECT_LT(count(contact_sheet("", {held}), orange), seen) << "behind the paper";
}

/// A square plane of this half side at this height, under or over the middle of the paper.
PlacedCollider plane(double half, double height) {
  PlacedCollider made{Points3(4, 3), Triangles(2, 3)};
  made.x << 0.05 - half, 0.05 - half, height, 0.05 + half, 0.05 - half, height, 0.05 + half,
      0.05 + half, height, 0.05 - half, 0.05 + half, height;
  made.triangles << 0, 1, 2, 0, 2, 3;
  return made;
}

TEST(PreviewTest, CollidersAreBlueGreyBesideThePaperAndChangeNothingOfItsSize) {
  const auto solid = [](const Colour& c) {
    return c.red > 70 && c.red < 150 && c.blue > c.red + 8;
  };
  Panel with = panel(flat());
  const Image without = contact_sheet("", {with});
  with.colliders = {plane(10, -0.01)};
  const Image image = contact_sheet("", {with});
  EXPECT_LT(count(without, solid), 100);  // rims of letters
  EXPECT_GT(count(image, solid), 100000);
  EXPECT_EQ(image.height, without.height);
  EXPECT_NEAR(count(image, warm), count(without, warm), 0.03 * count(without, warm));
}

TEST(PreviewTest, APlaneBeforeThePaperDoesNotHideIt) {
  Panel with = panel(flat());
  const int seen = count(contact_sheet("", {with}), warm);
  with.colliders = {plane(10, 0.05)};
  const Image image = contact_sheet("", {with});
  // lighter than any collider
  const int through = count(image, [](const Colour& c) { return c.red > 150; });
  EXPECT_GT(through, 0.9 * seen);
}

TEST(PreviewTest, CollidersStayInTheirPanel) {
  Panel with = panel(flat());
  const Panel without = with;
  with.colliders = {plane(10, -0.01)};
  const Image one = contact_sheet("", {without, without}),
              image = contact_sheet("", {with, without});
  for (int row = 0; row < image.height; ++row)
    for (int column = 654; column < 1300; ++column)
      ASSERT_EQ(image.at(column, row), one.at(column, row)) << column << " " << row;
}

TEST_F(PreviewCommandTest, APreviewAloneIsOnePictureAndTheSameWithOneThreadAndTwo) {
  const auto preview = [&](const std::string& threads) {
    const Ended ended = run(crumple("1-6", {"--formats", "preview", "--quality", "draft",
                                            "--threads", threads, "--progress", "none"}));
    EXPECT_EQ(ended.code, 0) << ended.err;
    for (const char* other : {"S4_crumple.abc", "maps", "cert", "report.html"})
      EXPECT_FALSE(fs::exists(fs::path(output()) / other)) << other;
    return read(fs::path(output()) / "S4_crumple.preview.png");
  };
  const std::string one = preview("1");
  EXPECT_EQ(one.substr(1, 3), "PNG");
  EXPECT_EQ(one, preview("2"));
}

TEST_F(PreviewCommandTest, APreviewBesideACacheLeavesEveryFrameInTheCertificateRendered) {
  const Ended ended = run(crumple(
      "1-20", {"--formats", "abc,cert,preview", "--quality", "draft", "--progress", "none"}));
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_TRUE(fs::exists(fs::path(output()) / "S4_crumple.preview.png"));
  EXPECT_EQ(read(fs::path(output()) / "cert" / "frames.jsonl").find("\"render_triangles\":null"),
            std::string::npos);
  EXPECT_EQ(run({"verify", output()}).code, 0);
}

TEST_F(PreviewCommandTest, APreviewAndACertificateAloneRenderOnlyWhatIsShown) {
  const Ended ended = run(
      crumple("1-20", {"--formats", "cert,preview", "--quality", "draft", "--progress", "none"}));
  ASSERT_EQ(ended.code, 0) << ended.err;
  const auto lines = test::lines_of(read(fs::path(output()) / "cert" / "frames.jsonl"));
  ASSERT_EQ(lines.size(), 20u);
  for (std::size_t k = 0; k < lines.size(); ++k)
    EXPECT_EQ(lines[k].find("\"render_triangles\":null") == std::string::npos, k % 2 == 1)
        << lines[k];
  EXPECT_EQ(run({"verify", output()}).code, 4) << "a picture cannot be verified";
}

TEST(PreviewTest, TheTitleSaysWhetherAGateWasMissed) {
  Preview preview("shot", {1, 1, 1}, nullptr, 1);
  CacheFrame frame;
  frame.x = Points3::Zero(3, 3);
  frame.x(1, 0) = frame.x(2, 2) = 0.1;
  frame.triangles = Triangles(1, 3);
  frame.triangles << 0, 1, 2;
  frame.normal = Points3::Constant(3, 3, 0.5);
  frame.normal_of_corner = frame.triangles;
  preview.add_frame(1, frame);
  const Image good = preview.picture(""), bad = preview.picture(", gate missed");
  ASSERT_EQ(good.pixels.size(), bad.pixels.size());
  constexpr int title_height = 30;
  int changed = 0;
  for (std::size_t k = 0; k < good.pixels.size(); ++k) {
    const bool is_same = good.pixels[k] == bad.pixels[k];
    changed += !is_same;
    EXPECT_TRUE(is_same || static_cast<int>(k) / good.width < title_height) << k;
  }
  EXPECT_GT(changed, 100);
}

}  // namespace
}  // namespace paperbake
