// The sentences about gates: the worst frame, its place, and which other frames miss it.

#include "baker/output/gates.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

FrameRecord rendered(int frame) {
  FrameRecord record;
  record.frame = frame;
  record.sheet = "paper";
  record.statistics.render.emplace();
  return record;
}

TEST(Gates, ARenderedEdgeThatIsOffIsNamedWithItsPlaceThoughTheSimulatedOnesAreGood) {
  std::vector<FrameRecord> frames{rendered(81), rendered(82), rendered(83), rendered(84)};
  EXPECT_TRUE(missed_gates({}, frames, {}).empty());
  frames[1].statistics.render->stretch_max = 0.74;
  frames[1].worst.stretch_at << 0.0312, 0.1184;
  EXPECT_EQ(
      missed_gates({}, frames, {}),
      std::vector<std::string>{"Frame 82: an edge of the rendered mesh is off by 74.00 %, more "
                               "than 5 %, at (31.2, 118.4) mm of the pattern."});
  frames[2].statistics.render->stretch_max = 0.06;
  EXPECT_NE(missed_gates({}, frames, {}).at(0).find("Frame 83 misses this gate, too."),
            std::string::npos);
  frames[3].statistics.render->stretch_max = 0.06;
  EXPECT_NE(missed_gates({}, frames, {}).at(0).find("2 more frames from 83 to 84 miss this gate."),
            std::string::npos);
}

TEST(Gates, TheMeanStretchOfTheRenderedMeshIsOne) {
  std::vector<FrameRecord> frames{rendered(3)};
  frames[0].statistics.render->stretch_mean = 0.021;
  EXPECT_EQ(missed_gates({}, frames, {}),
            std::vector<std::string>{
                "Frame 3: mean stretch of the rendered mesh 2.10 %, more than 2 %."});
}

TEST(Gates, ASheetInsideAColliderByMoreThanItsThicknessMissesOne) {
  std::vector<FrameRecord> frames{rendered(5)};
  frames[0].statistics.inside = 0.99e-4;
  EXPECT_TRUE(missed_gates({}, frames, {}).empty());
  frames[0].statistics.inside = 9.561e-3;
  frames[0].worst.inside_of = "collider.top";
  frames[0].worst.inside_at << 0.075, 0.07;
  EXPECT_EQ(
      missed_gates({}, frames, {}),
      std::vector<std::string>{"Frame 5: the sheet is 9.56 mm inside the collider "
                               "\"collider.top\", more than 0.1 mm, at (75.0, 70.0) mm of the "
                               "pattern."});
}

TEST(Gates, OfSeveralSheetsTheSentenceNamesTheOne) {
  BakePlan plan;
  plan.shots.resize(2);
  std::vector<FrameRecord> frames{rendered(5), rendered(5)};
  frames[1].sheet = "paper.B";
  frames[1].statistics.render->stretch_max = 0.1;
  EXPECT_EQ(missed_gates({}, frames, plan).at(0).rfind("Frame 5, sheet \"paper.B\": an edge", 0),
            0u);
}

}  // namespace
}  // namespace paperbake
