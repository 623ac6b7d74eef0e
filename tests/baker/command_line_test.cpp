// What the built program does with words: exit codes, messages, names of files. Everything is
// checked from outside.

#include "tests/baker/program_fixture.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <string>
#include <vector>

namespace paperbake {
namespace {

namespace fs = std::filesystem;
using CommandLineTest = test::CommandLine;
using test::Ended;
using test::fields_of;
using test::is_error;
using test::lines_of;
using test::read;
using test::samples;
using test::write;

TEST_F(CommandLineTest, WhatIsMissingIsNamedWithItsMeaning) {
  EXPECT_TRUE(is_error(run({}), 2, "command line", "names no command"));
  EXPECT_TRUE(is_error(run({"bake"}), 2, "command line", "bake needs SCENE: An .fbx"));
  EXPECT_TRUE(is_error(run({"bake", samples + "/S4_crumple.glb"}), 2, "command line", "--output"));
}

TEST_F(CommandLineTest, AnUnknownOptionEndsWithTwoAndIsNamed) {
  EXPECT_TRUE(is_error(bake({"--colour", "red"}), 2, "command line", "--colour"));
  EXPECT_TRUE(is_error(bake({"--stop", "soon"}), 2, "--stop", "soon"));
  EXPECT_TRUE(is_error(run({"bake", "scene.glb", "-o", output(), "--progress", "loud"}), 2,
                       "--progress", "loud"));
  EXPECT_FALSE(fs::exists(output()));
}

TEST_F(CommandLineTest, HelpAndVersionAreNoErrors) {
  const Ended help = run({"bake", "--help"}), version = run({"--version"});
  EXPECT_EQ(help.code, 0);
  for (const char* option : {"--preset", "--method", "--seed", "--triangles", "--gravity",
                             "--frames", "--strict", "--dry-run"})
    EXPECT_NE(help.out.find(option), std::string::npos) << option;
  EXPECT_EQ(version.code, 0);
  EXPECT_TRUE(
      std::regex_match(version.out, std::regex("paperbake [0-9]+\\.[0-9]+\\.[0-9]+\n"
                                               "commit ([0-9a-f]{12}(\\+changes)?|unknown)\n"
                                               "built with [^\n]*CHOLMOD [0-9][^\n]*\n")))
      << version.out;
}

TEST_F(CommandLineTest, AMisspeltOptionOrCommandGetsTheNearestName) {
  const auto suggests = [](const Ended& ended, const std::string& name) {
    return ended.err.find("Did you mean " + name + "?") != std::string::npos;
  };
  const Ended option = bake({"--qualty", "draft"}), command = run({"bakee", "scene.glb"}),
              joined = bake({"--sede=4"});
  EXPECT_TRUE(is_error(option, 2, "command line", "bake has no option --qualty"));
  EXPECT_TRUE(suggests(option, "--quality")) << option.err;
  EXPECT_TRUE(is_error(command, 2, "command line", "\"bakee\""));
  EXPECT_TRUE(suggests(command, "bake")) << command.err;
  EXPECT_TRUE(suggests(joined, "--seed")) << joined.err;
  const Ended value = run({"wedge", "--slurm", "--mem=2G", "--jobs", "x"});
  EXPECT_EQ(value.err.find("--mem"), std::string::npos) << "it is no option: " << value.err;
}

TEST_F(CommandLineTest, OfAnOptionThatIsGivenTwiceTheLastCounts) {
  const Ended ended = bake({"--seed", "7", "--strict", "--seed", "9", "--strict", "--set",
                            "thickness=1e-4", "--set", "friction=0.4", "--dry-run"});
  EXPECT_EQ(ended.code, 0) << ended.err;
  for (const char* line : {"seed = 9", "thickness = 0.0001", "friction = 0.4", "strict = true"})
    EXPECT_NE(ended.out.find(line), std::string::npos) << line << "\n" << ended.out;
}

TEST_F(CommandLineTest, AJobOverwritesAFileOnlyWhenToldAndTheSceneNever) {
  const fs::path scene = folder / "shot.glb", job = folder / "shot.toml";
  fs::copy(samples + "/S4_crumple.glb", scene);
  ASSERT_EQ(run({"bake", scene, "--write-job", job}).code, 0);
  write(job, "scene = \"shot.glb\"  # mine\n");
  EXPECT_TRUE(is_error(run({"bake", scene, "--write-job", job}), 2, job, "would overwrite"));
  EXPECT_EQ(read(job), "scene = \"shot.glb\"  # mine\n");
  EXPECT_EQ(run({"bake", scene, "--write-job", job, "--force"}).code, 0);
  EXPECT_EQ(read(job).rfind("# A job", 0), 0u);
  const std::string bytes = read(scene);
  EXPECT_TRUE(
      is_error(run({"bake", scene, "--write-job", scene, "--force"}), 2, scene, "scene itself"));
  EXPECT_EQ(read(scene), bytes);
  EXPECT_EQ(run({"bake", scene, "--write-job", "-"}).out.rfind("# A job", 0), 0u) << "to stdout";
}

TEST_F(CommandLineTest, FilesHaveTheNameThatIsGivenAndAJobOfNoNameThatOfItsScene) {
  ASSERT_EQ(bake({"--name", "sh010_v003", "--formats", "abc"}).code, 0);
  EXPECT_TRUE(fs::exists(fs::path(output()) / "sh010_v003.abc"));
  EXPECT_TRUE(is_error(bake({"--name", "a/b"}), 2, "--name", "a/b"));
  for (const char* name : {"job.toml", "take2.toml"}) {
    write(folder / name, "scene = \"" + samples + "/S4_crumple.glb\"\n");
    ASSERT_EQ(bake({"--formats", "abc"}, folder / name).code, 0);
  }
  EXPECT_TRUE(fs::exists(fs::path(output()) / "take2.abc"));
  EXPECT_FALSE(fs::exists(fs::path(output()) / "job.abc"));
}

TEST_F(CommandLineTest, TheRootOfTheUsdLayerIsThePathThatIsGiven) {
  const Ended ended = bake({"--formats", "usd", "--root", "/World/letter"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  const std::string layer = read(fs::path(output()) / "S4_crumple.usda");
  const std::size_t world = layer.find("def Xform \"World\""), letter = layer.find("\"letter\"");
  EXPECT_LT(world, letter);
  EXPECT_LT(letter, layer.find("def Mesh \"paper\""));
  EXPECT_NE(layer.find("defaultPrim = \"World\""), std::string::npos);
  EXPECT_EQ(layer.find("shot"), std::string::npos);
  EXPECT_TRUE(is_error(bake({"--root", "/1st take"}), 2, "--root", "1st take"));
}

TEST_F(CommandLineTest, AReversedRangeOfFramesIsTurnedRoundInTheRemedy) {
  const Ended ended = bake({"--frames", "10-5"});
  EXPECT_TRUE(is_error(ended, 2, "--frames", "ends before it begins"));
  EXPECT_NE(ended.err.find("Write 5-10."), std::string::npos) << ended.err;
}

TEST_F(CommandLineTest, LayersOfUsdNeedAFormatOfUsd) {
  EXPECT_TRUE(is_error(bake({"--usd-layers", "on", "--formats", "abc"}), 2, "--usd-layers",
                       "writes no USD"));
}

TEST_F(CommandLineTest, ValuesThatAreLikelyMeantInAnotherUnitAreQuestioned) {
  const auto warns = [&](const std::vector<std::string>& words, const std::string& of) {
    std::vector<std::string> all{"bake", samples + "/S4_crumple.glb", "--dry-run"};
    all.insert(all.end(), words.begin(), words.end());
    const Ended ended = run(all);
    EXPECT_EQ(ended.code, 0) << ended.err;
    return ended.err.find(of) != std::string::npos;
  };
  EXPECT_TRUE(warns({"--gravity", "9810"}, "Gravity is 9810 m/s2, 1000 times"));
  EXPECT_TRUE(warns({"--gravity", "-9.81"}, "pulls upwards"));
  EXPECT_FALSE(warns({"--gravity", "9.81"}, "Gravity"));
  EXPECT_TRUE(warns({"--fps", "9999"}, "9999 frames a second"));
  EXPECT_FALSE(warns({"--fps", "120"}, "is that meant?"));
  EXPECT_TRUE(warns({"--wind", "500,0,0"}, "blows at 500 m/s"));
  EXPECT_TRUE(warns({"--air", "1200"}, "The air has 1200 kg/m3"));
  EXPECT_FALSE(warns({"--wind", "20,0,0", "--air", "1.2"}, "is that meant?"));
}

TEST_F(CommandLineTest, AMeshThatCanHardlyBendIsAskedAbout) {
  const auto err = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"bake", samples + "/S4_crumple.glb", "-o", output(), "--dry-run"});
    const Ended ended = run(words);
    EXPECT_EQ(ended.code, 0) << ended.err;
    return ended.err;
  };
  const auto asks = [&](const std::string& text, const char* remedy) {
    return text.find("can hardly bend: is that meant? Leave " + std::string(remedy)) !=
           std::string::npos;
  };
  EXPECT_TRUE(asks(err({"--triangles", "5"}), "--triangles out, or give 60 or more."));
  EXPECT_TRUE(asks(err({"--method", "fem", "--triangles", "5"}), "--triangles"));
  EXPECT_TRUE(asks(err({"--base-triangles", "12"}), "--base-triangles"));
  EXPECT_EQ(err({"--triangles", "60"}).find("hardly bend"), std::string::npos);
}

TEST_F(CommandLineTest, FramesAfterTheLastKeyAreSaidToRest) {
  const auto plan = [&](const char* frames) {
    return run({"bake", samples + "/S4_crumple.glb", "-o", output(), "--dry-run", "--frames",
                frames})
        .out;
  };
  EXPECT_NE(plan("5-200").find("# command line; handles rest after frame 96, that of the last key"),
            std::string::npos)
      << plan("5-200");
  EXPECT_EQ(plan("5-96").find("handles rest"), std::string::npos);
}

TEST_F(CommandLineTest, AReleaseBeyondTheLastFrameIsSaid) {
  const fs::path job = folder / "late.toml";
  write(job, "scene = \"" + samples + "/S4_crumple.glb\"\n[handle.\"*\"]\nrelease_frame = 500\n");
  const auto says = [&](const char* frames) {
    const Ended ended = run({"bake", job, "-o", output(), "--dry-run", "--frames", frames});
    return ended.err.find("lets go at frame 500, after the last frame that is baked") !=
           std::string::npos;
  };
  EXPECT_TRUE(says("1-24"));
  EXPECT_FALSE(says("1-500"));
}

TEST_F(CommandLineTest, MapsOfFramesThatAreNotBakedAreSaidToBeMissing) {
  const auto warning = [&](const char* maps) {
    const std::string err = run({"bake", samples + "/S4_crumple.glb", "-o", output(), "--dry-run",
                                 "--frames", "1-24", "--map-frames", maps})
                                .err;
    const std::size_t at = err.find("--map-frames");
    return at == std::string::npos ? "" : err.substr(at, err.find('\n', at) - at);
  };
  const std::string baked = ": the bake has the frames 1-24.";
  EXPECT_EQ(warning("500-600"),
            "--map-frames asks for frames 500-600, of which none is baked" + baked);
  EXPECT_EQ(warning("1-12,30"), "--map-frames asks for frame 30, which is not baked" + baked);
  EXPECT_EQ(warning("20-30"),
            "--map-frames asks for frames 20-30, of which those after 24 are not baked" + baked);
  EXPECT_EQ(warning("1-24x6"), "");
}

TEST_F(CommandLineTest, WhatIsNoGlbIsToldByWhatItIs) {
  const fs::path scene = folder / "shot.glb";
  write(scene, "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n");
  EXPECT_TRUE(is_error(bake({}, scene), 3, scene, "pointer of Git LFS"));
  write(scene, "Dear artist,\nthis is no scene.\n");
  EXPECT_TRUE(is_error(bake({}, scene), 3, scene, "This is a text"));
  write(scene, "");
  EXPECT_TRUE(is_error(bake({}, scene), 3, scene, "empty"));
}

TEST_F(CommandLineTest, AMissingSceneEndsWithThree) {
  const std::string scene = folder / "nowhere.glb";
  EXPECT_TRUE(is_error(bake({}, scene), 3, scene, "no such file"));
  EXPECT_TRUE(is_error(run({"inspect", scene}), 3, scene, "no such file"));
  EXPECT_FALSE(fs::exists(output()));
}

TEST_F(CommandLineTest, ATextRenamedToFbxIsNoScene) {
  const std::string scene = folder / "letter.fbx";
  write(scene, "Dear artist,\nthis is no scene.\n");
  EXPECT_TRUE(is_error(bake({}, scene), 3, scene, ""));
  EXPECT_FALSE(fs::exists(output()));
}

TEST_F(CommandLineTest, AnUnknownPresetEndsWithTwoAndTheNearestName) {
  EXPECT_TRUE(
      is_error(bake({"--preset", "copy7O"}), 2, "preset \"copy7O\"", "Did you mean \"copy70\"?"));
  EXPECT_TRUE(
      is_error(run({"presets", "copi90"}), 2, "preset \"copi90\"", "Did you mean \"copy90\"?"));
}

TEST_F(CommandLineTest, AnUnknownMethodEndsWithTwo) {
  const Ended ended = bake({"--method", "origami"});
  EXPECT_TRUE(is_error(ended, 2, "--method", "origami"));
  EXPECT_NE(ended.err.find("fem"), std::string::npos) << "what there is should be listed";
}

TEST_F(CommandLineTest, PolishIsRefusedWhereItCanDoNothing) {
  EXPECT_TRUE(
      is_error(bake({"--method", "fem", "--polish", "3000"}), 2, "--polish", "nothing that fem"));
  EXPECT_TRUE(is_error(bake({"--polish", "3000", "--dynamics", "on"}), 2, "--polish", "at rest"));
  EXPECT_TRUE(
      is_error(bake({"--method", "hybrid+fem", "--polish", "0"}), 2, "--polish 0", "hybrid+fem"));
}

TEST_F(CommandLineTest, HeroAndHybridWithFemArePolishedUnlessSaidOtherwise) {
  const auto polished = [&](const std::vector<std::string>& options) {
    std::vector<std::string> words{"--dry-run"};
    words.insert(words.end(), options.begin(), options.end());
    const std::string out = bake(words).out;
    const std::size_t at = out.find("polish = ");
    return at == std::string::npos ? "" : out.substr(at + 9, out.find(' ', at + 9) - at - 9);
  };
  EXPECT_EQ(polished({}), "0");
  EXPECT_EQ(polished({"--quality", "hero"}), "6000");
  EXPECT_EQ(polished({"--quality", "hero", "--polish", "0"}), "0");
  EXPECT_EQ(polished({"--quality", "hero", "--method", "fem"}), "0");
  EXPECT_EQ(polished({"--method", "hybrid+fem"}), "6000");
  EXPECT_EQ(polished({"--method", "hybrid+fem", "--polish", "800"}), "800");
}

TEST_F(CommandLineTest, AnUnknownKeyOfSetEndsWithTwoAndTheNearestName) {
  EXPECT_TRUE(is_error(bake({"--set", "thicknes=9e-5"}), 2, "--set thicknes",
                       "Did you mean \"thickness\"?"));
  EXPECT_TRUE(is_error(bake({"--set", "thickness=thin"}), 2, "--set thickness",
                       "\"thin\" is not a number"));
  EXPECT_TRUE(is_error(bake({"--set", "thickness=-1"}), 2, "--set thickness", "-1"));
  EXPECT_TRUE(
      is_error(bake({"--set", "friction=-1"}), 2, "--set friction", "lies between 0 and 10."));
  EXPECT_TRUE(is_error(bake({"--set", "hardening=1"}), 2, "--set hardening", "cannot be 1"));
  EXPECT_TRUE(is_error(bake({"--set", "thickness"}), 2, "--set thickness", "value"));
}

TEST_F(CommandLineTest, AFrameRangeThatIsNoneEndsWithTwo) {
  for (const char* range : {"6-1", "one-six", "1-", "1-6x0", "1-6y2", "1-6 ", "1..6"}) {
    const Ended ended =
        run({"bake", samples + "/S4_crumple.glb", "-o", output(), "--frames", range});
    EXPECT_TRUE(is_error(ended, 2, "--frames", range));
  }
  EXPECT_TRUE(is_error(bake({"--map-frames", "1-6,7-"}), 2, "--map-frames", "7-"));
  EXPECT_FALSE(fs::exists(output()));
}

TEST_F(CommandLineTest, ANumberThatIsNoneEndsWithTwo) {
  for (const char* option : {"--stop", "--gravity", "--fps", "--max-stretch"})
    for (const char* text : {"nan", "inf", "soon"})
      EXPECT_TRUE(is_error(bake({option, text}), 2, option, text)) << option;
  EXPECT_TRUE(is_error(
      run({"bake", samples + "/S4_crumple.glb", "-o", output(), "--frames", "1-2000000000"}), 2,
      "--frames", "100000"));
  EXPECT_TRUE(is_error(bake({"--preset", "missing/copy70.toml"}), 2, "missing/copy70.toml",
                       "no such preset file"));
}

TEST_F(CommandLineTest, AProbeOfSheetsThatSwingEndsWithTwo) {
  EXPECT_TRUE(is_error(bake({"--probe", "6", "--dynamics", "on"}), 2, "--probe", "inertia"));
  EXPECT_TRUE(is_error(bake({"--probe", "-1"}), 2, "--probe", "-1"));
  const Ended ended = bake({"--dry-run", "--probe", "6"});
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_NE(ended.out.find("probe = 6  # command line"), std::string::npos) << ended.out;
}

TEST_F(CommandLineTest, AnUnknownFormatEndsWithTwo) {
  EXPECT_TRUE(is_error(bake({"--formats", "abc,gif"}), 2, "--formats", "gif"));
}

TEST_F(CommandLineTest, APointCacheOfAMeshThatChangesEndsWithTwoBeforeAnythingIsBaked) {
  EXPECT_TRUE(is_error(bake({"--method", "hybrid", "--formats", "pc2", "--mesh", "simulation"}), 2,
                       "--formats pc2", "one mesh"));
  EXPECT_FALSE(fs::exists(folder / "out"));
}

TEST_F(CommandLineTest, ADryRunPrintsTheJobAndWritesNothing) {
  const Ended ended = bake({"--dry-run", "--seed", "7", "--set", "thickness=1e-4"});
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_NE(ended.out.find("seed = 7  # command line"), std::string::npos) << ended.out;
  EXPECT_NE(ended.out.find("thickness = 0.0001  # command line"), std::string::npos) << ended.out;
  EXPECT_FALSE(fs::exists(folder / "out"));
  ASSERT_EQ(bake({"--seed", "7", "--set", "thickness=1e-4"}).code, 0);
  EXPECT_EQ(read(fs::path(output()) / "job.lock.toml"), ended.out)
      << "it is the job that would be baked";
}

TEST_F(CommandLineTest, TheCapOfAdaptiveIsThreeThousandTrianglesUnlessToldOtherwise) {
  const std::vector<std::string> job{
      "bake", samples + "/S1_push.glb", "-o", output(), "--dry-run", "--method", "adaptive"};
  EXPECT_NE(run(job).out.find("triangles = 3000  # default"), std::string::npos);
  std::vector<std::string> capped = job;
  capped.insert(capped.end(), {"--triangles", "500"});
  EXPECT_NE(run(capped).out.find("triangles = 500  # command line"), std::string::npos);
}

TEST_F(CommandLineTest, TheExperimentWritesAPointForEachSheetAndAPicture) {
  const std::string csv = folder / "scatter.csv";
  const Ended ended = run({"fit", "--experiment", "copy70", "--sheets", "2", "-o", csv});
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(ended.out, csv + "\n" + (folder / "scatter.png").string() + "\n");
  const std::vector<std::string> lines = lines_of(read(csv));
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0], "u,v,seed,frame");
  for (int sheet : {1, 2}) {
    const auto row = fields_of(lines[sheet]);
    EXPECT_NEAR(std::stod(row.at(0)), 0.05, 0.03);
    EXPECT_NEAR(std::stod(row.at(1)), 0.015, 0.03);
    EXPECT_EQ(row.at(2), std::to_string(sheet));
    EXPECT_GT(std::stoi(row.at(3)), 24) << "after the squeeze";
  }
  EXPECT_EQ(read(folder / "scatter.png").substr(1, 3), "PNG");
}

TEST_F(CommandLineTest, AGradeThatFitsMeasuredPointsCanBeBakedWith) {
  const std::string csv = folder / "scatter.csv", mine = folder / "mine.toml";
  write(csv, "u,v\n0.049,0.012\n0.05,0.018\n0.047,0.014\n0.044,0.015\n");
  const Ended ended = run({"fit", csv, "--from", "copy90", "--sheets", "2", "-o", mine});
  ASSERT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(ended.out, mine + "\n" + (folder / "mine.png").string() + "\n");
  EXPECT_NE(ended.err.find("p = "), std::string::npos) << ended.err;
  EXPECT_NE(bake({"--preset", mine, "--dry-run"}).out.find("preset = \"mine\"  # command line"),
            std::string::npos);
}

TEST_F(CommandLineTest, FittingNeedsPointsAndAGrade) {
  EXPECT_TRUE(is_error(run({"fit", "-o", folder / "my.toml"}), 2, "fit", "nothing to fit"));
  EXPECT_TRUE(is_error(run({"fit", "points.csv", "--from", "copy70", "-o", folder / "my.toml"}), 2,
                       "points.csv", "cannot be read"));
  EXPECT_TRUE(is_error(run({"fit", "--experiment", "copi70", "-o", folder / "a.csv"}), 2,
                       "preset \"copi70\"", "Did you mean"));
  EXPECT_TRUE(is_error(run({"fit", "--experiment", "copy70", "-o", folder / "missing" / "a.csv"}),
                       6, folder / "missing" / "a.csv", ""));
}

TEST_F(CommandLineTest, PresetsAreListedAndOnePrintedIsAPresetFile) {
  const Ended list = run({"presets"}), one = run({"presets", "copy70"});
  EXPECT_EQ(list.code, 0);
  EXPECT_TRUE(std::regex_search(list.out, std::regex("(^|\n)copy70 "))) << list.out;
  EXPECT_TRUE(std::regex_search(list.out, std::regex("(^|\n)copy90 "))) << list.out;
  ASSERT_EQ(one.code, 0) << one.err;
  std::string text = one.out;
  const std::size_t at = text.find("2.7e-4");
  ASSERT_NE(at, std::string::npos) << text;
  write(folder / "mine.toml", text.replace(at, 6, "3.1e-4"));
  const Ended job = bake({"--dry-run", "--preset", folder / "mine.toml"});
  EXPECT_EQ(job.code, 0) << job.err;
  EXPECT_NE(job.out.find("bending_stiffness = 0.00031  # preset"), std::string::npos) << job.out;
}

}  // namespace
}  // namespace paperbake
