// Which frames are told as leaps, and how.

#include "baker/output/leaps.h"

#include <gtest/gtest.h>

#include <cmath>

namespace paperbake {
namespace {

/// A sheet of 0.2 m that moves by so much in each frame from 1 on. [m]
struct Moved {
  BakePlan plan;
  std::vector<FrameRecord> frames;

  explicit Moved(const std::vector<double>& ways) {
    Shot shot;
    shot.sheet_name = "paper";
    shot.pattern.outline = {{0, 0}, {0.2, 0}, {0.2, 0.1}, {0, 0.1}};
    plan.shots = {shot};
    plan.animation.first_frame = 1;
    for (std::size_t k = 0; k < ways.size(); ++k) {
      FrameRecord record;
      record.frame = static_cast<int>(k) + 1;
      record.sheet = "paper";
      record.statistics.moved = ways[k];
      frames.push_back(record);
    }
  }
  std::vector<int> leaps() const {
    std::vector<int> found;
    for (const Leap& leap : find_leaps(frames, plan)) found.push_back(leap.frame);
    return found;
  }
};

using Frames = std::vector<int>;

TEST(LeapsTest, AFrameInWhichASheetMovesMuchFartherThanAroundItIsOne) {
  EXPECT_EQ(Moved({0, 0.001, 0.002, 0.03, 0.002, 0.001}).leaps(), Frames{4});
  EXPECT_EQ(Moved({0, 0.001, 0.002, 0.03, 0.02, 0.01}).leaps(), Frames{4}) << "it takes some time";
  EXPECT_EQ(Moved({0, 1e-5, 3.9e-3, 1e-5}).leaps(), Frames{}) << "2 % of the side hardly show";
  EXPECT_EQ(Moved({0, 0.03, 1e-4}).leaps(), Frames{2}) << "from the shape as it was modelled";
  EXPECT_EQ(Moved({0, 1e-4, 0.03}).leaps(), Frames{3}) << "in the last frame";
}

TEST(LeapsTest, NoneIsWhereWhatDrivesTheSheetIsAsSudden) {
  Moved pulled({0, 0.001, 0.002, 0.03, 0.002, 0.001});
  for (FrameRecord& f : pulled.frames) f.statistics.driven = 0.003;
  EXPECT_EQ(pulled.leaps(), Frames{4}) << "driven evenly";
  pulled.frames[3].statistics.touching_others = 1;
  EXPECT_EQ(pulled.leaps(), Frames{}) << "another sheet may drive it";
  pulled.frames[3].statistics.touching_others = 0;
  pulled.frames[3].statistics.driven = 0.04;
  EXPECT_EQ(pulled.leaps(), Frames{}) << "keyed so";
  for (FrameRecord& f : pulled.frames) f.statistics.driven = 0.031;
  EXPECT_EQ(pulled.leaps(), Frames{}) << "what has been coming has met it";
}

TEST(LeapsTest, NoneIsWhereAHandleLetsGo) {
  Moved sprung({0, 0.001, 0.002, 0.03, 0.002, 0.001});
  sprung.plan.shots[0].handles.resize(1);
  sprung.plan.shots[0].handles[0].release_frame = 4;
  EXPECT_EQ(sprung.leaps(), Frames{});
  sprung.plan.shots[0].handles[0].release_frame = 3;
  EXPECT_EQ(sprung.leaps(), Frames{4}) << "it has sprung in the frame before";
}

TEST(LeapsTest, ASheetWithInertiaMayGatherSpeed) {
  Moved falls({0, 0.001, 0.002, 0.03, 0.011, 0.001}), snaps({0, 0.001, 0.002, 0.03, 0.002, 0.001});
  for (Moved* moved : {&falls, &snaps})
    for (FrameRecord& f : moved->frames) f.statistics.inertia = true;
  EXPECT_EQ(falls.leaps(), Frames{});
  EXPECT_EQ(snaps.leaps(), Frames{4});
}

TEST(LeapsTest, TheSentenceNamesTheLongest) {
  const Moved twice({0, 0.001, 0.03, 0.001, 0.001, 0.05, 0.002});
  EXPECT_EQ(
      describe(find_leaps(twice.frames, twice.plan)),
      "in frame 6 the sheet \"paper\" leaps by 50.0 mm, where it moves by 1.0 mm in the "
      "frames beside it and nothing drives it so fast; frame 3 is like it. If it shows, try "
      "--dynamics on without --polish, with which a snap takes time, more --base-triangles, or "
      "slower keys.");
  Moved swings({0, 0.001, 0.002, 0.03, 0.002, 0.001});
  for (FrameRecord& f : swings.frames) f.statistics.inertia = true;
  EXPECT_EQ(describe(find_leaps(swings.frames, swings.plan)).find("--dynamics"), std::string::npos)
      << "it has inertia";
  EXPECT_EQ(describe(std::vector<Leap>()), "");
  Moved bent({0, 0.03, 1e-4, 1e-4});
  EXPECT_NE(describe(find_leaps(bent.frames, bent.plan)).find("Model it as it lies at rest"),
            std::string::npos);
  for (FrameRecord& f : bent.frames) f.frame += 9;
  EXPECT_EQ(describe(find_leaps(bent.frames, bent.plan)).find("Model it"), std::string::npos)
      << "the frames that are written begin later";
  for (FrameRecord& f : bent.frames) f.frame -= 9;
  for (FrameRecord& f : bent.frames) f.statistics.driven = 0.001;
  EXPECT_NE(describe(find_leaps(bent.frames, bent.plan)).find("or slower keys"), std::string::npos)
      << "handles that begin fast may be what throws it";
  Moved crumpled = twice;
  for (FrameRecord& f : crumpled.frames) f.statistics.singular = 3;
  EXPECT_EQ(crumpled.leaps().size(), 2u);
  EXPECT_EQ(describe(find_leaps(crumpled.frames, crumpled.plan)), "") << "crumples snap";
}

}  // namespace
}  // namespace paperbake
