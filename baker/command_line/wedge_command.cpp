#include "baker/command_line/command.h"
#include "baker/command_line/parsed_options.h"
#include "baker/job/plan.h"
#include "baker/output/say.h"
#include "baker/studies/wedge_jobs.h"

#include <memory>
#include <optional>

namespace paperbake {
namespace {

struct WedgeArguments : ParsedOptions {
  std::vector<std::string> vary;
  int jobs = 1;
  std::optional<int> index;
  std::optional<std::string> submit;
  std::string slurm;
};

void add_wedge(CLI::App& app, WedgeArguments& parsed) {
  parsed.command =
      app.add_subcommand("wedge",
                         "Bake variations of a scene, each in a folder of its own, and "
                         "compare them: wedge.csv, wedge.json, wedge.png");
  add_all_options(parsed);
  CLI::App& wedge = *parsed.command;
  wedge.add_option(
      "--vary", parsed.vary,
      "key=values: any option above or number of the paper, for instance seed=1..16, "
      "gravity=0..9.8x2.45, "
      "preset=copy70,copy90; every value of a key is baked with every one of the others");
  wedge
      .add_option("--jobs", parsed.jobs,
                  "How many are baked at a time; each has one thread, the last ones those that are "
                  "free, unless --threads says otherwise")
      ->capture_default_str()
      ->check(CLI::Range(1, 1024));
  CLI::Option* const index = wedge.add_option(
      "--index", parsed.index,
      "Bake this variation only, from 1; the last one to be done writes the table");
  CLI::Option* const submit =
      wedge
          .add_option(
              "--submit", parsed.submit,
              "slurm: write DIR/wedge.sbatch, an array of jobs with --index, and hand it to sbatch")
          ->excludes(index)
          ->check(CLI::IsMember({"slurm"}));
  wedge
      .add_option("--slurm", parsed.slurm,
                  "Further options of sbatch for --submit slurm, in quotes: \"--mem=2G "
                  "--time=1:00:00\"")
      ->needs(submit);
}

/// arguments  of the program, as they were given
int run_wedge(const WedgeArguments& parsed, const std::vector<std::string>& arguments) {
  BakeSettings settings;
  apply_command_line(parsed, settings);
  require_output(settings);
  const Wedge wedge(settings, parse_axes(parsed.vary));
  if (parsed.index) {
    const int code = bake_variation(wedge, *parsed.index, is_stop_asked);
    finish_wedge(wedge);
    return code;
  }
  plan_bake(wedge.settings(1));  // a scene that cannot be used is said so before a folder is made
  if (parsed.submit) {
    submit_wedge(wedge, arguments, parsed.slurm);
    return 0;
  }
  const WedgeOutcome outcome = bake_wedge(wedge, parsed.jobs, arguments, is_stop_asked);
  const bool is_read =
      settings.progress == ProgressMode::automatic || settings.progress == ProgressMode::plain;
  if (is_read && !outcome.table.empty()) say_line(outcome.table);
  for (const auto& file : outcome.files) list_line(file.string());
  return outcome.exit_code;
}

}  // namespace

Command wedge_command(CLI::App& app, const std::vector<std::string>& arguments) {
  const auto parsed = std::make_shared<WedgeArguments>();
  add_wedge(app, *parsed);
  return {parsed->command, [=] { return run_wedge(*parsed, arguments); },
          // longer than each of the bakes that it waits for
          [=] { return std::chrono::milliseconds(parsed->index ? 850 : 950); }};
}

}  // namespace paperbake
