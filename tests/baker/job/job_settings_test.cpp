// Job files through the built program: what they say, how they fail, who wins. Everything is
// checked from outside.

#include "baker/job/job_settings.h"
#include "tests/baker/program_fixture.h"
#include "tests/own_folder.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <regex>
#include <string>

namespace paperbake {
namespace {

namespace fs = std::filesystem;
using test::CommandLine;
using test::Ended;
using test::is_error;
using test::read;
using test::samples;
using test::Words;
using test::write;

class JobSettingsTest : public CommandLine {
 protected:
  /// A job of S4 in the test's folder; dry.
  Ended dry(const std::string& lines, const Words& more = {}) const {
    write(folder / "shot.toml", "scene = \"" + samples + "/S4_crumple.glb\"\n" + lines);
    Words words{"bake", folder / "shot.toml", "--dry-run", "--progress", "none"};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  }
  std::string place(int line, int column) const {
    return fmt::format("{}:{}:{}", (folder / "shot.toml").string(), line, column);
  }
};

testing::AssertionResult says(const Ended& ended, const std::string& line) {
  if (ended.code == 0 && ended.out.find("\n" + line + "\n") != std::string::npos)
    return testing::AssertionSuccess();
  return testing::AssertionFailure() << "no line " << line << " in\n" << ended.out << ended.err;
}

TEST_F(JobSettingsTest, TheLaterOfDefaultSceneJobAndCommandLineWins) {
  EXPECT_TRUE(says(dry(""), "max_stretch = 5.0  # default"));
  EXPECT_TRUE(says(dry("max_stretch = 7"), "max_stretch = 7.0  # job"));
  EXPECT_TRUE(
      says(dry("max_stretch = 7", {"--max-stretch", "6"}), "max_stretch = 6.0  # command line"));
  EXPECT_TRUE(says(dry("gravity = 1.5\nfps = 25"), "gravity = 1.5  # job"));
  EXPECT_TRUE(says(dry("fps = 25"), "fps = 25.0  # job"));
  EXPECT_TRUE(says(dry("[paper]\nthickness = 95e-6"), "thickness = 9.5e-05  # job"));
  EXPECT_TRUE(says(dry("[paper]\nthickness = 95e-6", {"--set", "thickness=96e-6"}),
                   "thickness = 9.6e-05  # command line"));
}

TEST_F(JobSettingsTest, APresetReplacesWhatThoseBeforeItSayOfThePaper) {
  const std::string sheet = "[sheet.\"PAPER\"]\ngsm = 140\nseed = 9\n";
  EXPECT_TRUE(says(dry(sheet), "area_density = 0.14  # job"));
  EXPECT_TRUE(says(dry(sheet), "seed = 9  # job"));
  EXPECT_TRUE(says(dry(sheet, {"--seed", "3"}), "seed = 3  # command line"));
  EXPECT_TRUE(says(dry("preset = \"copy90\"\n"), "preset = \"copy90\"  # job"));
  EXPECT_TRUE(says(dry("preset = \"copy90\"\n" + sheet), "area_density = 0.14  # job"))
      << "a sheet's own value counts for more than one for all";
  EXPECT_TRUE(says(dry(sheet, {"--preset", "copy90"}), "area_density = 0.09  # preset"));
  EXPECT_TRUE(says(dry("[paper]\nthickness = 95e-6", {"--preset", "copy70"}),
                   "thickness = 9e-05  # preset"));
  EXPECT_TRUE(says(dry("[sheet.\"PAPER\"]\nfriction = 0.2\n"), "friction = 0.2  # job"));
  EXPECT_TRUE(says(dry("[sheet.\"PAPER\"]\nfriction = 0.2\n", {"--set", "friction=0"}),
                   "friction = 0.0  # command line"));
  EXPECT_TRUE(says(dry("preset = \"copy70\"\n[sheet.\"p*\"]\npreset = \"copy90\"\n"),
                   "preset = \"copy90\"  # job"));
}

TEST_F(JobSettingsTest, AMistakeEndsWithTwoAndSaysLineColumnAndWhatIsMeant) {
  EXPECT_TRUE(is_error(dry("map_sise = 8"), 2, place(2, 1), "Did you mean \"map_size\"?"));
  EXPECT_TRUE(
      is_error(dry("map_size = 0"), 2, place(2, 12), "a whole number from 1 to 8192, not 0"));
  EXPECT_TRUE(is_error(dry("map_size = 8.5"), 2, place(2, 12), "a whole number"));
  EXPECT_TRUE(is_error(dry("stop = 0"), 2, place(2, 8), "a number above zero"));
  EXPECT_TRUE(is_error(dry("stop = nan"), 2, place(2, 8), "a number above zero"));
  EXPECT_TRUE(is_error(dry("strict = \"yes\""), 2, place(2, 10), "true or false"));
  EXPECT_TRUE(is_error(dry("quality = \"heroic\""), 2, place(2, 11), "Did you mean \"hero\"?"));
  EXPECT_TRUE(is_error(dry("method = \"origami\""), 2, place(2, 10), "origami"));
  EXPECT_TRUE(is_error(dry("formats = [\"abc\", \"gif\"]"), 2, place(2, 11), "gif"));
  EXPECT_TRUE(is_error(dry("frames = \"6-1\""), 2, place(2, 10), "6-1"));
  EXPECT_TRUE(is_error(dry("[paper]\nthickness = 1"), 2, place(3, 13), "5e-06"));
  EXPECT_TRUE(is_error(dry("[handle.\"handle*\"]\nmod = \"relative\""), 2, place(3, 1),
                       "Did you mean \"mode\"?"));
  EXPECT_TRUE(is_error(dry("[handle.\"handle*\"]\nradius = -1"), 2, place(3, 10), "from 0 on"));
  EXPECT_TRUE(is_error(dry("[handle]\nmode = \"relative\""), 2, place(3, 1), "under their names"));
  EXPECT_TRUE(is_error(dry("[sheet.paper]\nsingular_keep = [[0.1, 0.1, 0.1]]"), 2, place(3, 18),
                       "points [u, v]"));
  EXPECT_TRUE(is_error(dry("[sheet.paper]\nsingular_keep = [[0.1, 3]]"), 2, place(2, 1),
                       "(0.1, 3) m is not on the sheet"));
  EXPECT_TRUE(
      is_error(dry("[sheet.paper]\ncrease = [{line = [[0, 0]]}]"), 2, place(3, 19), "two points"));
  EXPECT_TRUE(is_error(dry("x = ["), 2, place(2, 6), "not TOML"));
}

TEST_F(JobSettingsTest, ASectionThatMeansNothingSaysWhatThereIs) {
  const Ended ended = dry("[handle.\"grip*\"]\nmode = \"relative\"");
  EXPECT_TRUE(is_error(ended, 2, place(2, 1), "No handle of the scene has a name like \"grip*\"."));
  EXPECT_NE(ended.err.find("\"handle.corner.0\""), std::string::npos) << ended.err;
  EXPECT_TRUE(is_error(dry("[sheet.\"card\"]\ngsm = 90"), 2, place(2, 1), "\"card\""));
}

TEST_F(JobSettingsTest, HandlesAreMeantByNameAndTheJobWinsOverTheScene) {
  dry("[handle.\"HANDLE_corner-?\"]\nmode = \"relative\"\nrelease_frame = "
      "50\n[handle.\"*.2\"]\nrelease_frame = 40\n[handle.\"handle.edge*\"]\nignore = true\n");
  const Ended ended = run({"inspect", folder / "shot.toml", "--json"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const auto handles = nlohmann::json::parse(ended.out).at("sheets")[0].at("handles");
  ASSERT_EQ(handles.size(), 4u) << handles;
  for (const auto& handle : handles) {
    EXPECT_EQ(handle.at("mode"), "relative") << handle;
    EXPECT_EQ(handle.at("release_frame"), handle.at("name") == "handle.corner.2" ? 40 : 50)
        << handle;
  }
  EXPECT_TRUE(is_error(dry("[handle.\"*\"]\nignore = true\n"), 3, "S4_crumple.glb", "All handles"));
}

TEST_F(JobSettingsTest, AWrittenJobGivesTheSameBytes) {
  const Words given{"--seed", "7",      "--set",     "thickness=95e-6",
                    "--stop", ".00002", "--formats", "abc,cert"};
  Words words = given;
  words.insert(words.end(), {"--write-job", folder / "again.toml"});
  ASSERT_EQ(bake(words).code, 0);
  const Ended again = run({"bake", folder / "again.toml", "-o", folder / "second"});
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(read(fs::path(output()) / "S4_crumple.abc"), read(folder / "second" / "again.abc"))
      << "named after the job";
  const std::string text = read(folder / "again.toml");
  EXPECT_NE(text.find("\nseed = 7\n"), std::string::npos) << text;
  EXPECT_NE(text.find("\n# probe = 0\n"), std::string::npos) << text;
  EXPECT_NE(text.find("\n# [handle.\"handle.corner.0\"]"), std::string::npos) << text;
  EXPECT_NE(text.find("output = \"out/shot\"\n"), std::string::npos)
      << "paths from the folder of the job: " << text;
}

TEST_F(JobSettingsTest, AllThatAWrittenJobLeavesOutMayBeUncommented) {
  ASSERT_EQ(run({"bake", samples + "/S4_crumple.glb", "--write-job", folder / "all.toml"}).code, 0);
  std::string open;
  for (const std::string& line : test::lines_of(read(folder / "all.toml"))) {
    const bool value = std::regex_search(line, std::regex("^# ([a-z_]+ = |\\[)"));
    const bool other_scene = line.rfind("# take", 0) == 0 ||
                             line.find("singular") != std::string::npos ||
                             line.find("crease") != std::string::npos;
    if (line.rfind("# A job", 0) != 0 && !other_scene)
      open += (value ? line.substr(2) : line) + "\n";
  }
  write(folder / "all.toml", open);
  const Ended ended = run({"bake", folder / "all.toml", "--dry-run", "--progress", "none"});
  EXPECT_EQ(ended.code, 0) << ended.err << open;
  EXPECT_NE(ended.out.find("mode = \"absolute\"  # job"), std::string::npos) << ended.out;
}

TEST_F(JobSettingsTest, TheSampleWithPinsIsBaked) {
  const Ended ended = run({"bake", samples + "/S8_pinned.toml", "-o", folder / "out", "--frames",
                           "1-2", "--formats", "cert", "--progress", "none"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_NE(read(folder / "out" / "singular.csv").find("\n1,paper,1,0.065,0.03,kept here"),
            std::string::npos)
      << read(folder / "out" / "singular.csv");
  EXPECT_NE(read(folder / "out" / "job.lock.toml").find("apex_scatter = 0.003  # job"),
            std::string::npos);
  // its crease goes through handles: slivers there store kilojoules
  for (const std::string& line : test::lines_of(read(folder / "out" / "cert" / "frames.jsonl"))) {
    const std::string key = "\"energy_J\":";
    ASSERT_NE(line.find(key), std::string::npos) << line;
    EXPECT_LT(std::stod(line.substr(line.find(key) + key.size())), 1e-3);
  }
}

TEST_F(JobSettingsTest, APresetOfTheCommandLineThatReplacesNumbersOfTheJobIsAWarning) {
  const auto told = [&](const Words& more) {
    Words words{"bake", samples + "/S8_pinned.toml", "--dry-run"};
    words.insert(words.end(), more.begin(), more.end());
    const Ended ended = run(words);
    EXPECT_EQ(ended.code, 0) << ended.err;
    EXPECT_EQ(ended.out.find("apex_scatter = 0.003") == std::string::npos,
              ended.err.find("also apex_scatter of its [paper]") != std::string::npos)
        << ended.out << ended.err;
    return ended.err.find("replaces the paper of the job") != std::string::npos;
  };
  EXPECT_FALSE(told({}));
  EXPECT_TRUE(told({"--preset", "copy70"}));
  EXPECT_FALSE(told({"--preset", "copy70", "--set", "apex_scatter=0.003"}));
}

TEST_F(JobSettingsTest, APresetOfTheCommandLineThatReplacesThePaperOfASheetIsAWarning) {
  const auto told = [&](const std::string& lines, const Words& more) {
    write(folder / "shot.toml", "scene = \"" + samples + "/S4_crumple.glb\"\nfps = 24\n" + lines);
    Words words{"bake", folder / "shot.toml", "--dry-run", "--progress", "plain"};
    words.insert(words.end(), more.begin(), more.end());
    const Ended ended = run(words);
    EXPECT_EQ(ended.code, 0) << ended.err;
    return ended.err;
  };
  const std::string sheet = "[sheet.\"PAPER\"]\npreset = \"copy90\"\nthickness = 1e-4\nseed = 9\n";
  EXPECT_EQ(told(sheet, {}), "");
  EXPECT_EQ(told("[sheet.\"PAPER\"]\nseed = 9\n", {"--preset", "copy70"}), "")
      << "a seed is not of the paper";
  EXPECT_NE(told(sheet, {"--preset", "copy70"})
                .find("also preset, thickness of its [sheet.\"PAPER\"]. Give"),
            std::string::npos);
  const Words set{"--preset", "copy70", "--set", "thickness=1e-4", "--set", "area_density=0.08"};
  EXPECT_NE(told(sheet, set).find("also preset of its [sheet."), std::string::npos);
  EXPECT_EQ(told("[sheet.\"PAPER\"]\ngsm = 80\n", set), "") << "given again with --set";
  EXPECT_NE(told("[paper]\nfriction = 0.3\n" + sheet, {"--preset", "copy70"})
                .find("also friction of its [paper] and preset, thickness of its [sheet."),
            std::string::npos);
}

/// The number behind the first place that begins so.
double value_of(const std::string& text, const std::string& beginning) {
  const std::size_t at = text.find(beginning);
  EXPECT_NE(at, std::string::npos) << beginning << text;
  return at == std::string::npos ? 0 : std::stod(text.substr(text.find('=', at) + 1));
}

TEST_F(JobSettingsTest, TheTemplateHasTheNumbersOfThePreset) {
  ASSERT_EQ(run({"bake", samples + "/S4_crumple.glb", "--preset", "card300", "--write-job",
                 folder / "card.toml"})
                .code,
            0);
  const std::string written = read(folder / "card.toml"), card = run({"presets", "card300"}).out;
  for (const std::string key : {"friction", "thickness"})
    EXPECT_EQ(value_of(written, "\n# " + key + " = "), value_of(card, "[" + key + "]\nvalue = "))
        << key;
}

TEST_F(JobSettingsTest, TheTemplateHasTheNumbersOfThePresetThatTheSceneNames) {
  const auto written = [&](const std::string& sample, const Words& more) {
    Words words{"bake", samples + "/" + sample, "--write-job", "-"};
    words.insert(words.end(), more.begin(), more.end());
    const Ended ended = run(words);
    EXPECT_EQ(ended.code, 0) << ended.err;
    return ended.out;
  };
  const std::string text = written("G1_newspaper.glb", {}),
                    newsprint = run({"presets", "newsprint45"}).out;
  EXPECT_NE(text.find("here those of newsprint45.\n"), std::string::npos) << text;
  EXPECT_NE(text.find("\n# preset = \"newsprint45\"\n"), std::string::npos) << text;
  for (const std::string key : {"friction", "thickness", "area_density"})
    EXPECT_EQ(value_of(text, "\n# " + key + " = "), value_of(newsprint, "[" + key + "]\nvalue = "))
        << key;
  const std::string of_sheet = text.substr(text.find("\n# [sheet."));
  EXPECT_EQ(value_of(of_sheet, "\n# gsm = "),
            1e3 * value_of(newsprint, "[area_density]\nvalue = "));
  EXPECT_EQ(value_of(of_sheet, "\n# thickness = "), value_of(newsprint, "[thickness]\nvalue = "));
  // the command line says more than the scene
  const std::string card = written("G1_newspaper.glb", {"--preset", "card300"});
  EXPECT_NE(card.find("here those of card300.\n"), std::string::npos) << card;
  EXPECT_NE(card.find("\n# preset = \"card300\"\n"), std::string::npos) << card;
}

TEST_F(JobSettingsTest, WithoutAnOutputFolderItEndsWithTwo) {
  write(folder / "shot.toml", "scene = \"" + samples + "/S4_crumple.glb\"\n");
  EXPECT_TRUE(is_error(run({"bake", folder / "shot.toml"}), 2, "command line", "--output"));
  write(folder / "shot.toml", "output = \"out\"\n");
  EXPECT_TRUE(is_error(run({"bake", folder / "shot.toml"}), 2, folder / "shot.toml", "scene"));
  EXPECT_TRUE(
      is_error(run({"bake", folder / "none.toml"}), 2, folder / "none.toml", "cannot be read"));
}

TEST(JobSections, PresetFilesOfSheetsAreNamedFromTheWorkingDirectoryToo) {
  const std::filesystem::path preset = test::own_folder() / "soft.toml";
  std::ofstream(preset) << "thickness = 1e-4\n";
  BakeSettings settings;
  JobSection section;
  section.pattern = "*";
  section.values = {{"preset", preset.string(), ""}};
  settings.sheets = {section};
  for (const char* folder : {"", "."})
    EXPECT_NE(sections_text(settings, folder).find("soft.toml"), std::string::npos) << folder;
  EXPECT_NE(sections_text(settings, preset.parent_path()).find("preset = \"soft.toml\""),
            std::string::npos);
}

}  // namespace
}  // namespace paperbake
