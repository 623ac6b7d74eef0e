// Variations of a scene: which there are, what they leave behind, and that it does not matter who
// bakes them.

#include "baker/studies/wedge.h"

#include "core/model/error.h"
#include "tests/baker/program_fixture.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iomanip>
#include <map>
#include <set>
#include <sstream>
#include <sys/file.h>
#include <sys/wait.h>

namespace paperbake {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using test::CommandLine;
using test::Ended;
using test::exit_code;
using test::is_error;
using test::lines_of;
using test::read;
using test::samples;
using test::start;
using test::Words;

Words values(const std::string& text) { return parse_axis(text).values; }

std::string message(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.code, ErrorCode::command);
    return error.what();
  }
  return "nothing was thrown";
}
bool says(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(WedgeAxesTest, RangesStepsAndValuesAreToldApart) {
  EXPECT_EQ(values("seed=1..4"), (Words{"1", "2", "3", "4"}));
  EXPECT_EQ(values("seed=7,1..5x2"), (Words{"7", "1", "3", "5"}));
  EXPECT_EQ(values("gravity=0..9.8x4.9"), (Words{"0.0", "4.9", "9.8"}))
      << "no step is lost to rounding";
  EXPECT_EQ(values("thickness=80e-6,95e-6").size(), 2u);
  EXPECT_EQ(values("preset=copy70,copy90"), (Words{"copy70", "copy90"}));
  EXPECT_EQ(values("frames=1-96x2"), (Words{"1-96x2"}));
  EXPECT_EQ(parse_axis("map-size=64").key, "map_size");
}

TEST(WedgeAxesTest, WhatCannotBeVariedIsRefusedWithPlaceAndRemedy) {
  EXPECT_TRUE(says(message([] { parse_axis("sed=1..4"); }), "Did you mean \"seed\"?"));
  EXPECT_TRUE(says(message([] { parse_axis("thicknes=90e-6"); }), "Did you mean \"thickness\"?"));
  EXPECT_TRUE(
      says(message([] { parse_axis("preset=copy70,copi90"); }), "Did you mean \"copy90\"?"));
  EXPECT_TRUE(says(message([] { parse_axis("seed=4..1"); }), "\"4..1\" is no range"));
  EXPECT_TRUE(says(message([] { parse_axis("seed=1..4x0"); }), "no range"));
  EXPECT_TRUE(says(message([] { parse_axis("seed=-1..2"); }), "--vary seed"));
  EXPECT_TRUE(says(message([] { parse_axis("seed=1..2x0.5"); }), "\"1.5\" is not"));
  EXPECT_TRUE(says(message([] { parse_axis("thickness=-1"); }), "--vary thickness"));
  EXPECT_TRUE(says(message([] { parse_axis("quality=draft,best"); }), "\"best\" is not"));
  EXPECT_TRUE(says(message([] { parse_axis("method=origami"); }), "Unknown method"));
  EXPECT_TRUE(says(message([] { parse_axis("seed="); }), "--vary seed"));
  EXPECT_TRUE(says(message([] { parse_axis("seed"); }), "key and its values"));
  EXPECT_TRUE(says(message([] { parse_axis("threads=1,2"); }), "in common"));
  EXPECT_TRUE(says(message([] { parse_axes({"seed=1..2", "seed=3"}); }), "twice"));
  EXPECT_TRUE(says(message([] {
                     parse_axes({"seed=1..200", "probe=1..200"});
                   }),
                   "40000 variations"));
  EXPECT_TRUE(says(message([] { parse_axis("seed=1..4000000000"); }), "10000"));
}

TEST(WedgeAxesTest, EveryValueMeetsEveryOtherAndTheLastKeyChangesFirst) {
  const auto axes = parse_axes({"seed=1..2", "preset=copy70,copy90", "thickness=9e-5"});
  std::set<Words> all;
  ASSERT_EQ(variations(axes), 4);
  for (int i = 1; i <= 4; ++i) all.insert(values_of(axes, i));
  EXPECT_EQ(all.size(), 4u);
  EXPECT_EQ(values_of(axes, 2), (Words{"1", "copy90", axes[2].values[0]}));
  const BakeSettings settings = varied({}, axes, 4);
  EXPECT_EQ(settings.seed, 2u);
  EXPECT_EQ(settings.preset, "copy90");
  ASSERT_EQ(settings.set.size(), 1u);
  EXPECT_EQ(settings.set[0].value, 9e-5);
}

class WedgeTest : public CommandLine {
 protected:
  Words words(const std::string& folder, const Words& more) const {
    Words all{"wedge",       samples + "/S4_crumple.glb",
              "-o",          folder,
              "--method",    "fem",
              "--triangles", "100",
              "--frames",    "1-2",
              "--quality",   "draft",
              "--progress",  "none"};
    all.insert(all.end(), more.begin(), more.end());
    if (std::find(all.begin(), all.end(), "--formats") == all.end())
      all.insert(all.end(), {"--formats", "cert"});
    return all;
  }
  Ended wedge(const Words& more) const { return run(words(output(), more)); }
  Ended wedge_in(const std::string& name, const Words& more) const {
    return run(words(folder / name, more));
  }
  fs::path out(const std::string& file) const { return fs::path(output()) / file; }

  /// What does not tell how long it took.
  static std::map<std::string, std::string> contents(const fs::path& folder) {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      const std::string path = fs::relative(entry, folder).string(), name = entry.path().filename();
      if (entry.is_regular_file() && !says(path, ".state") && name != "frames.jsonl" &&
          name != "summary.json")
        all[path] = read(entry.path());
    }
    return all;
  }
  static std::map<std::string, fs::file_time_type> times(const fs::path& folder) {
    std::map<std::string, fs::file_time_type> all;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
      if (entry.is_regular_file() && !says(entry.path().string(), ".state"))
        all[entry.path().string()] = entry.last_write_time();
    return all;
  }
};

TEST_F(WedgeTest, EveryOptionForSlurmHasALineOfItsOwn) {
  wedge({"--vary", "seed=1..2", "--submit", "slurm", "--slurm",
         "--mem=2G --time=1:00:00 --partition farm"});
  const std::string script = read(out("wedge.sbatch"));  // whether there is a Slurm here or not
  for (const char* line :
       {"\n#SBATCH --mem=2G\n", "\n#SBATCH --time=1:00:00\n", "\n#SBATCH --partition farm\n"})
    EXPECT_NE(script.find(line), std::string::npos) << line << "\n" << script;
  const std::string command = script.substr(script.find("\nexec "));
  EXPECT_EQ(command.find("slurm'"), std::string::npos) << "that is not for a task: " << command;
  EXPECT_EQ(command.find("--mem"), std::string::npos) << command;
}

TEST_F(WedgeTest, EachVariationIsTheBakeThatItsWordsAskFor) {
  const Ended ended =
      wedge({"--vary", "seed=1..2", "--vary", "preset=copy70,copy90", "--jobs", "2"});
  ASSERT_EQ(ended.code, 0) << ended.err;
  Words plain =
      words(folder / "plain", {"--formats", "abc,cert", "--seed", "2", "--preset", "copy70"});
  plain[0] = "bake";
  ASSERT_EQ(run(plain).code, 0);
  EXPECT_EQ(contents(folder / "plain"), contents(out("0003")));
  EXPECT_EQ(run({"verify", out("0003")}).code, 0);

  const auto table = lines_of(read(out("wedge.csv")));
  ASSERT_EQ(table.size(), 5u);
  EXPECT_EQ(table[0],
            "index,seed,preset,exit_code,c_m_pct,worst_edge_pct,singular,energy_J,crease_length_m,"
            "job_hash,folder");
  EXPECT_EQ(table[3].rfind("3,2,copy70,0,", 0), 0u) << table[3];
  const Json json = Json::parse(read(out("wedge.json"))),
             summary = Json::parse(read(out("0003/cert/summary.json")));
  const Json& third = json["variations"][2];
  EXPECT_EQ(third["values"], (Json{{"seed", 2}, {"preset", "copy70"}}));
  EXPECT_EQ(third["job_hash"], summary["job_hash"]);
  EXPECT_EQ(third["worst_edge_pct"], summary["stretch_max_pct"]["max"]);
  EXPECT_GT(third["energy_J"].get<double>(), 0);
  EXPECT_EQ(third["energy_J"],
            Json::parse(lines_of(read(out("0003/cert/frames.jsonl"))).back())["energy_J"]);
  EXPECT_NE(json["variations"][0]["job_hash"], third["job_hash"]);
  EXPECT_EQ(read(out("wedge.png")).substr(1, 3), "PNG");
}

TEST_F(WedgeTest, TheTableIsShownWhereProgressIs) {
  const Words varied{"--vary", "seed=1..2", "--vary", "preset=copy70,copy90"};
  Words shown = varied;
  shown.insert(shown.end(), {"--progress", "plain"});
  EXPECT_EQ(wedge(varied).err.find("exit_code"), std::string::npos);
  const std::vector<std::string> lines = lines_of(wedge(shown).err);
  const auto head = std::find_if(lines.begin(), lines.end(), [](const std::string& line) {
    return line.rfind("folder", 0) == 0;
  });
  ASSERT_EQ(lines.end() - head, 5);
  for (int row = 1; row <= 4; ++row) EXPECT_EQ(head[row].size(), head[0].size()) << head[row];
  const Json third = Json::parse(read(out("wedge.json")))["variations"][2];
  std::istringstream row(head[3]);
  std::string folder_name, seed, preset;
  row >> folder_name >> seed >> preset;
  EXPECT_EQ(folder_name + " " + seed + " " + preset, "0003 2 copy70");
  std::ostringstream energy;
  energy << std::setprecision(4) << third["energy_J"].get<double>();
  EXPECT_NE(head[3].find(energy.str()), std::string::npos) << head[3] << energy.str();
}

TEST_F(WedgeTest, ProgramsAreToldOfEveryVariationInJson) {
  const Ended ended = wedge(
      {"--vary", "seed=1..2", "--vary", "max-stretch=1e-9,5", "--jobs", "2", "--progress", "json"});
  ASSERT_EQ(ended.code, 4) << ended.err;
  std::map<int, Json> begun, over;
  int count = 0;
  for (const std::string& line : lines_of(ended.err)) {
    const Json record = Json::parse(line);
    EXPECT_EQ(record.at("variations"), 4) << line;
    const int index = record.at("index");
    if (record.at("type") == "variation_start") {
      EXPECT_TRUE(begun.emplace(index, record).second) << line;
      continue;
    }
    EXPECT_EQ(record.at("type"), "variation_end");
    EXPECT_EQ(begun.count(index), 1u) << "it begins before it ends";
    EXPECT_EQ(record.at("ended"), ++count);
    EXPECT_TRUE(record.at("error").is_null()) << line;
    over[index] = record;
  }
  ASSERT_EQ(begun.size(), 4u) << ended.err;
  ASSERT_EQ(over.size(), 4u) << ended.err;
  EXPECT_EQ(begun[3].at("values"), (Json{{"seed", 2}, {"max_stretch", 1e-9}}));
  EXPECT_EQ(begun[3].at("folder"), out("0003").string());
  EXPECT_EQ(over[3].at("exit_code"), 4);
  EXPECT_EQ(over[4].at("exit_code"), 0);
}

TEST_F(WedgeTest, FoldersOfAnEarlierWedgeAreNamedAndStay) {
  const auto left = [&](const std::string& seeds, const char* progress) {
    const Ended ended = wedge({"--vary", "seed=" + seeds, "--progress", progress});
    EXPECT_EQ(ended.code, 0) << ended.err;
    for (const std::string& line : lines_of(ended.err))
      if (says(line, "earlier wedge")) return line;
    return std::string();
  };
  EXPECT_EQ(left("1..4", "plain"), "");
  fs::create_directories(out("0009"));  // somebody else's
  const std::string sentence =
      "Left from an earlier wedge and not part of this one: the folders 0003, 0004.";
  EXPECT_EQ(left("1..2", "plain"), sentence);
  EXPECT_EQ(Json::parse(left("1..2", "json")), (Json{{"type", "message"}, {"message", sentence}}));
  EXPECT_EQ(left("1..2", "none"), "");
  EXPECT_EQ(left("1..3", "plain"),
            "Left from an earlier wedge and not part of this one: the folder 0004.");
  EXPECT_TRUE(fs::exists(out("0004/S4_crumple.abc")));
  EXPECT_EQ(left("1..4", "plain"), "");
}

TEST_F(WedgeTest, WhatIsBakedIsNotBakedAgainAndWhatIsMissingIs) {
  const Words seeds{"--vary", "seed=1..2"};
  ASSERT_EQ(wedge(seeds).code, 0);
  const auto before = times(output());
  ASSERT_EQ(wedge(seeds).code, 0);
  EXPECT_EQ(times(output()), before);

  fs::remove(out("0002/S4_crumple.abc"));
  ASSERT_EQ(wedge({"--vary", "seed=1..3"}).code, 0);
  EXPECT_EQ(fs::last_write_time(out("0001/S4_crumple.abc")), before.at(out("0001/S4_crumple.abc")));
  EXPECT_TRUE(fs::exists(out("0002/S4_crumple.abc")));
  EXPECT_EQ(lines_of(read(out("wedge.csv"))).size(), 4u);

  ASSERT_EQ(wedge({"--vary", "seed=1..3", "--gravity", "1"}).code, 0);
  EXPECT_NE(fs::last_write_time(out("0001/S4_crumple.abc")), before.at(out("0001/S4_crumple.abc")))
      << "another job";
}

TEST_F(WedgeTest, OneByOneInAnyOrderTheyAreTheSameAndTheLastWritesTheTable) {
  const auto one = [&](const std::string& index) {
    return wedge({"--vary", "seed=1..3", "--index", index}).code;
  };
  EXPECT_EQ(one("3"), 0);
  EXPECT_EQ(one("1"), 0);
  EXPECT_FALSE(fs::exists(out("wedge.csv")));
  EXPECT_EQ(one("2"), 0);
  EXPECT_TRUE(fs::exists(out("wedge.csv")));
  ASSERT_EQ(wedge_in("together", {"--vary", "seed=1..3", "--jobs", "3"}).code, 0);
  EXPECT_EQ(contents(output()), contents(folder / "together"));
  EXPECT_TRUE(is_error(wedge({"--vary", "seed=1..3", "--index", "4"}), 2, "--index 4", "1 to 3"));
}

TEST_F(WedgeTest, TheExitCodeIsFourForGatesElseTheWorst) {
  const Ended gate = wedge({"--vary", "seed=1..2", "--max-stretch", "1e-9"});
  EXPECT_EQ(gate.code, 4);
  EXPECT_EQ(Json::parse(read(out("wedge.json")))["variations"][0]["exit_code"], 4);

  // with inertia nothing can be probed
  const Ended mixed = wedge_in("mixed", {"--vary", "probe=0,1", "--dynamics", "on"});
  EXPECT_EQ(mixed.code, 2) << mixed.err;
  const Json rows = Json::parse(read(folder / "mixed" / "wedge.json"))["variations"];
  EXPECT_EQ(rows[0]["exit_code"], 0);
  EXPECT_EQ(rows[1]["exit_code"], 2);
  EXPECT_TRUE(rows[1]["c_m_pct"].is_null());
  EXPECT_TRUE(says(rows[1]["message"], "--probe"));
}

TEST_F(WedgeTest, NothingIsWrittenWhenWordsOrSceneAreWrong) {
  EXPECT_TRUE(is_error(wedge({"--vary", "sed=1..2"}), 2, "--vary sed", "Did you mean \"seed\"?"));
  EXPECT_TRUE(is_error(wedge({"--vary", "triangles=1..3"}), 2, "--vary triangles", "\"1\" is not"));
  EXPECT_TRUE(is_error(run({"wedge", folder / "none.glb", "-o", output(), "--vary", "seed=1..2"}),
                       3, folder / "none.glb", "no such file"));
  EXPECT_FALSE(fs::exists(output()));
}

TEST_F(WedgeTest, OptionsForSlurmAloneBakeNothing) {
  const Ended ended = wedge({"--vary", "seed=1..2", "--slurm", "--mem=2G"});
  EXPECT_TRUE(is_error(ended, 2, "command line", "--slurm requires --submit"));
  EXPECT_FALSE(fs::exists(output()));
}

TEST_F(WedgeTest, WithoutSbatchTheScriptIsWrittenAllTheSame) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", folder.c_str(), 1);
  const Ended ended = wedge({"--vary", "seed=1..4", "--jobs", "2", "--submit", "slurm"});
  setenv("PATH", path.c_str(), 1);
  EXPECT_TRUE(is_error(ended, 2, "--submit slurm", "sbatch"));
  const std::string script = read(out("wedge.sbatch"));
  EXPECT_TRUE(says(script, "#SBATCH --array=1-4\n"));
  EXPECT_TRUE(says(script, "'--vary' 'seed=1..4' ")) << script;
  EXPECT_TRUE(says(script, " --index \"$SLURM_ARRAY_TASK_ID\"\n")) << script;
  for (const char* of_all : {"--submit", "--jobs", "slurm'"})
    EXPECT_FALSE(says(script, of_all)) << of_all;
}

TEST_F(WedgeTest, AnInterruptEndsTheChildrenAfterTheirFrame) {
  const pid_t program =
      start(folder, {"wedge", samples + "/S4_crumple.glb", "-o", output(), "--triangles", "8000",
                     "--method", "fem", "--vary", "seed=1..4", "--jobs", "2"});
  // it bakes for half a minute from here on
  while (!fs::exists(out("0001/.state/lock"))) usleep(1000);
  kill(program, SIGINT);
  EXPECT_EQ(exit_code(program), 5);
  const int lock = open(out("0001/.state/lock").c_str(), O_RDWR);
  ASSERT_GE(lock, 0);
  EXPECT_EQ(flock(lock, LOCK_EX | LOCK_NB), 0) << "a child still bakes";
  close(lock);
  EXPECT_FALSE(fs::exists(out("wedge.csv")));
}

TEST_F(WedgeTest, AVariationThatIsKilledDoesNotShowHowItEndedBefore) {
  fs::create_directories(out(".state"));
  std::ofstream(out(".state/0001.json")) << "{}";
  const pid_t program =
      start(folder, {"wedge", samples + "/S4_crumple.glb", "-o", output(), "--method", "fem",
                     "--triangles", "3000", "--vary", "seed=1..2", "--index", "1"});
  while (!fs::exists(out("0001/.state/lock"))) usleep(1000);
  kill(program, SIGKILL);
  waitpid(program, nullptr, 0);
  EXPECT_FALSE(fs::exists(out(".state/0001.json")));
}

TEST_F(WedgeTest, AVariationThatIsStoppedKeepsItsFrames) {
  const pid_t program =
      start(folder, {"wedge", samples + "/S4_crumple.glb", "-o", output(), "--method", "fem",
                     "--triangles", "3000", "--vary", "seed=1..2", "--index", "1"});
  while (!fs::exists(out("0001/.state/checkpoint.current"))) usleep(1000);
  kill(program, SIGTERM);
  EXPECT_EQ(exit_code(program), 5);
  bool kept = false;
  for (const auto& entry : fs::directory_iterator(out("0001/.state")))
    kept |= entry.path().filename().string().rfind("checkpoint.", 0) == 0;
  EXPECT_TRUE(kept);
  EXPECT_FALSE(fs::exists(out(".state/0001.json"))) << "stopped is no end";
}

}  // namespace
}  // namespace paperbake
