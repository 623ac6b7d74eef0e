#include "baker/job/file_names.h"

#include <gtest/gtest.h>

#include <set>

namespace paperbake {
namespace {

TEST(FileNames, ASingleSheetNeedsNone) {
  EXPECT_EQ(sheet_file_suffixes({"paper.A"}), std::vector<std::string>{""});
  EXPECT_TRUE(describe_shared_names({"paper.A"}).empty());
}

TEST(FileNames, SheetsWhoseNamesDifferOnlyInWhatFilesMayNotHaveGetNumbers) {
  const std::vector<std::string> names{
      "paper.a b", "paper_a.b", "paper_a_b_2", "paper:a/b", std::string("paper\0A", 7), "paper\nA"};
  const std::vector<std::string> suffixes = sheet_file_suffixes(names);
  EXPECT_EQ(suffixes[0], ".paper_a_b");
  EXPECT_EQ(suffixes[1], ".paper_a_b_2");
  EXPECT_EQ(suffixes[2], ".paper_a_b_2_2");
  EXPECT_EQ(suffixes[3], ".paper_a_b_3");
  EXPECT_EQ(suffixes[4], ".paper_A");
  EXPECT_EQ(suffixes[5], ".paper_A_2");
  EXPECT_EQ(std::set<std::string>(suffixes.begin(), suffixes.end()).size(), names.size());
  const std::vector<std::string> told = describe_shared_names(names);
  ASSERT_EQ(told.size(), 4u);
  EXPECT_EQ(
      told[0],
      "The files of sheet \"paper_a.b\" would have the names of those of sheet \"paper.a b\": "
      "they have \"paper_a_b_2\" in their names instead.");
}

TEST(FileNames, LongNamesAreCutAtACharacterAndStayDifferent) {
  const std::string umlauts = "paper" + std::string(100, 'x') + "\u00e4";
  std::string many;
  for (int k = 0; k < 60; ++k) many += "\u00e4";  // two bytes each
  const std::vector<std::string> suffixes =
      sheet_file_suffixes({umlauts, umlauts + "b", "a" + many});
  EXPECT_EQ(suffixes[0].size(), 81u);
  EXPECT_EQ(suffixes[1], suffixes[0] + "_2");
  EXPECT_EQ(suffixes[2], ".a" + many.substr(0, 78)) << "no half of an umlaut";
  const std::string shot = legal_shot_name(std::string(300, 's') + "\n", suffixes);
  EXPECT_EQ(shot.size() + suffixes[1].size() + std::string(".preview.png.part").size(), 255u);
  EXPECT_EQ(legal_shot_name("shot\n#SBATCH \"x\"", {""}), "shot_#SBATCH \"x\"");
}

TEST(FileNames, SheetsOfDifferentNamesKeepTheirs) {
  EXPECT_EQ(sheet_file_suffixes({"paper.A", "paper.B"}),
            (std::vector<std::string>{".paper_A", ".paper_B"}));
  EXPECT_TRUE(describe_shared_names({"paper.A", "paper.B"}).empty());
}

}  // namespace
}  // namespace paperbake
