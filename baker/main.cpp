#include "baker/bake/bake.h"
#include "baker/check/error_estimate.h"
#include "baker/check/inspect.h"
#include "baker/check/verify.h"
#include "baker/job/job_settings.h"
#include "baker/job/options.h"
#include "baker/output/output_folder.h"
#include "baker/studies/chart.h"
#include "baker/studies/chart_picture.h"
#include "baker/studies/fit_command.h"
#include "baker/studies/wedge_jobs.h"
#include "core/model/error.h"
#include "formats/config/preset_file.h"
#include "formats/files/atomic_file.h"

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <csignal>
#include <fmt/format.h>
#include <malloc.h>
#include <nlohmann/json.hpp>

// The command line: words in, exit code out. What the commands do lies behind bake.h, chart.h,
// inspect.h, verify.h, wedge_jobs.h and fit_command.h.

namespace paperbake {
namespace {

constexpr int gate_missed = 4;

void say_on_stderr(const std::string& sentence) { fmt::print(stderr, "{}\n", sentence); }

volatile std::sig_atomic_t stop_asked = 0;

/// The first Ctrl-C or SIGTERM asks a bake to end after its frame; the next one ends it at once.
void let_signals_ask() {
  struct sigaction action {};
  action.sa_handler = [](int) { stop_asked = 1; };
  action.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
}

const CLI::Validator positive(
    [](std::string& text) {
      double value;
      return CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0
                 ? std::string()
                 : "\"" + text + "\" is not a number above zero";
    },
    "", "positive");

/// What a command was told of the options of the table.
struct OptionWords {
  CLI::App* command = nullptr;
  std::map<std::string, std::string> text;  // by option, of those that the command has
  std::vector<std::string> set;
};

constexpr std::array reading_options = {"fps", "start_frame", "unit_scale", "take"};

void add_option(OptionWords& words, const std::string& name, const std::string& flags = {}) {
  const Option& o = option(name);
  std::string& text = words.text[name];
  const std::string& spelled = flags.empty() ? o.flags : flags;
  if (o.kind == JobKey::flag) {
    words.command->add_flag(spelled, text, o.meaning);
    return;
  }
  CLI::Option* added = words.command->add_option(spelled, text, o.meaning);
  if (!o.usual.empty()) added->default_str(o.usual);
  if (o.kind == JobKey::word)
    added->type_name(fmt::format("{}", fmt::join(o.words, "|")));
  else if (o.kind != JobKey::list)
    added->type_name(o.kind == JobKey::number ? "NUMBER" : o.kind == JobKey::whole ? "N" : "TEXT");
}

void add_set(OptionWords& words) {
  words.command->add_option("--set", words.set,
                            "key=value: one number of the paper, over preset and scene; "
                            "friction=0.4: its layers rub on each other");
}

/// What was said: first by the job file, when the scene is one, then by the command line.
void understand(const OptionWords& words, BakeSettings& settings) {
  const auto scene = words.text.find("scene");
  const bool job = scene != words.text.end() && is_job(scene->second);
  if (job) take_job(settings, scene->second);
  for (const Option& o : options()) {
    const CLI::Option* given =
        words.text.count(o.name)
            ? words.command->get_option_no_throw(o.name == "scene" ? "SCENE" : o.flags)
            : nullptr;
    if (given && given->count() > 0 && !(job && o.name == "scene"))
      say(settings, o, words.text.at(o.name), o.flags, Origin::command);
  }
  for (const std::string& text : words.set) settings.set.push_back(parse_set(text));
}

/// Of `bake` beyond the options of the table.
struct BakeWords : OptionWords {
  std::optional<std::filesystem::path> write_job;
  bool dry_run = false;
};

/// SCENE and all options of the table, and --set.
void add_all_options(OptionWords& words) {
  add_option(words, "scene", "SCENE");
  words.command->get_option("SCENE")->required()->description(
      "An .fbx, .glb or .gltf file with a sheet and animated handles, or a job file (.toml)");
  add_option(words, "output", "-o,--output");
  for (const Option& o : options())
    if (o.name != "scene" && o.name != "output") add_option(words, o.name);
  add_set(words);
}

void add_bake(CLI::App& app, BakeWords& words) {
  words.command = app.add_subcommand(
      "bake", "Simulate the sheets of a scene and write cache, maps and certificate");
  add_all_options(words);
  words.command->add_flag("--dry-run", words.dry_run,
                          "Check everything and print the job, but write nothing");
  words.command->add_option("--write-job", words.write_job,
                            "Write a job file that says the same, with all that it could say; "
                            "without -o that is all that is done");
}

int run_bake(const BakeWords& words) {
  BakeSettings settings;
  understand(words, settings);
  if (settings.output.empty() && !words.write_job && !words.dry_run)
    throw Error(Fault::command, "command line", "--output is required: the folder to write to.",
                "Write -o DIR, or output = \"DIR\" in the job file.");
  const BakePlan plan = plan_bake(settings);
  if (words.write_job) {
    write_atomically(*words.write_job, job_text(settings, *words.write_job));
    if (settings.output.empty()) {
      fmt::print("{}\n", words.write_job->string());
      return plan.impossible.empty() ? 0 : gate_missed;
    }
  }

  if (words.dry_run) {
    Progress progress(settings.progress, 0, passes_of(settings));
    say_warnings(plan, progress);
    fmt::print("{}", lock_text(plan));
    return plan.impossible.empty() ? 0 : gate_missed;
  }
  let_signals_ask();
  const BakeOutcome outcome = bake_and_tell(settings, plan, [] { return stop_asked != 0; });
  for (const auto& file : outcome.files) fmt::print("{}\n", file.string());
  return outcome.exit_code;
}

struct WedgeWords : OptionWords {
  std::vector<std::string> vary;
  int jobs = 1;
  std::optional<int> index;
  std::optional<std::string> submit;
};

void add_wedge(CLI::App& app, WedgeWords& words) {
  words.command = app.add_subcommand("wedge",
                                     "Bake variations of a scene, each in a folder of its own, and "
                                     "compare them: wedge.csv, wedge.json, wedge.png");
  add_all_options(words);
  CLI::App& wedge = *words.command;
  wedge.add_option(
      "--vary", words.vary,
      "key=values: any option above or number of the paper, for instance seed=1..16, "
      "gravity=0..9.8x2.45, "
      "preset=copy70,copy90; every value of a key is baked with every one of the others");
  wedge
      .add_option("--jobs", words.jobs,
                  "How many are baked at a time; each has one thread, the last ones those that are "
                  "free, unless --threads says otherwise")
      ->capture_default_str()
      ->check(CLI::Range(1, 1024));
  CLI::Option* index = wedge.add_option(
      "--index", words.index,
      "Bake this variation only, from 1; the last one to be done writes the table");
  wedge
      .add_option(
          "--submit", words.submit,
          "slurm: write DIR/wedge.sbatch, an array of jobs with --index, and hand it to sbatch")
      ->excludes(index)
      ->check(CLI::IsMember({"slurm"}));
}

/// said: the words of the command line
int run_wedge(const WedgeWords& words, const std::vector<std::string>& said) {
  BakeSettings settings;
  understand(words, settings);
  if (settings.output.empty())
    throw Error(Fault::command, "command line", "--output is required: the folder to write to.",
                "Write -o DIR.");
  const Wedge wedge(settings, parse_axes(words.vary));
  if (words.index) {
    let_signals_ask();
    const int code = bake_variation(wedge, *words.index, [] { return stop_asked != 0; });
    finish_wedge(wedge);
    return code;
  }
  plan_bake(wedge.settings(1));  // a scene that cannot be used is said so before a folder is made
  if (words.submit) {
    submit_wedge(wedge, said);
    return 0;
  }
  const WedgeOutcome outcome = bake_wedge(wedge, words.jobs, said);
  for (const auto& file : outcome.files) fmt::print("{}\n", file.string());
  return outcome.exit_code;
}

int run_inspect(const std::filesystem::path& file, const OptionWords& words, bool json,
                const std::optional<std::string>& tracks) {
  BakeSettings settings;
  const bool job = is_job(file);
  if (job)
    take_job(settings, file);
  else
    settings.scene = file;
  understand(words, settings);
  if (tracks) {
    const std::string csv = tracks_csv(settings.scene, settings.reading);
    if (*tracks == "-")
      fmt::print("{}", csv);
    else
      write_atomically(*tracks, csv);
    return 0;
  }
  const bool cache = file.extension() == ".abc";
  fmt::print("{}", cache ? inspect_cache(file, json)
                   : job ? inspect_job(settings, json)
                         : inspect_scene(file, settings.reading, json));
  return 0;
}

int run_presets(const std::optional<std::string>& name, bool json) {
  if (name && !json) {
    fmt::print("{}", read_preset(*name).text);
    return 0;
  }
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  std::vector<std::string> grades = name ? std::vector<std::string>{*name} : preset_names();
  if (!name)  // those of the user stand for those built in of the same name
    for (const std::string& own : user_preset_names())
      if (std::find(grades.begin(), grades.end(), own) == grades.end()) grades.push_back(own);
  for (const std::string& grade : grades) {
    const Preset preset = read_preset(grade);
    nlohmann::ordered_json entries = nlohmann::ordered_json::object();
    for (const Preset::Entry& e : preset.entries)
      entries[e.key] = {
          {"value", e.value}, {"unit", e.unit}, {"source", e.source}, {"mark", e.mark}};
    all.push_back({{"name", preset.paper.name}, {"file", preset.file}, {"values", entries}});
    if (!json)
      fmt::print("{:<12} {:>4g} g/m2  {:>4g} um  D {:<8g} N m  {}\n", grade,
                 1e3 * preset.paper.area_density, 1e6 * preset.paper.thickness,
                 preset.paper.bending_stiffness, preset.file);
  }
  if (json) fmt::print("{}\n", (name ? all.front() : all).dump(1));
  return 0;
}

struct ChartWords : OptionWords {
  std::string methods;
};

void add_chart(CLI::App& app, ChartSettings& s, ChartWords& words) {
  CLI::App& chart = *app.add_subcommand("chart",
                                        "Run the methods on a scene at several sizes: speed "
                                        "against accuracy, as chart.csv and chart.svg");
  words.command = &chart;
  add_option(words, "scene", "SCENE");
  chart.get_option("SCENE")->required();
  add_option(words, "output", "-o,--output");
  words.methods = fmt::format("{}", fmt::join(s.methods, ","));
  chart.add_option("--methods", words.methods, "Which, separated by commas")->capture_default_str();
  chart.add_option("--repeat", s.repeat, "Runs of each; times are medians")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  chart
      .add_option("--reference", s.reference,
                  "Triangles of the fem that the others are compared with; half as many as long as "
                  "it does not come to an end")
      ->capture_default_str()
      ->check(CLI::Range(100, 400000));
  chart.add_option("--budget", s.budget, "Seconds for everything")
      ->capture_default_str()
      ->check(positive);
  for (const char* name : {"preset", "seed", "gravity", "stop", "frames", "threads"})
    add_option(words, name);
  add_set(words);
  for (const char* name : reading_options) add_option(words, name);
}

int run_chart(ChartSettings settings, const ChartWords& words) {
  understand(words, settings.job);
  if (settings.job.output.empty())
    throw Error(Fault::command, "command line", "--output is required: the folder to write to.",
                "Write -o DIR.");
  settings.methods.clear();
  for (const std::string& name : CLI::detail::split(words.methods, ','))
    settings.methods.push_back(name);
  plan_bake(settings.job);  // a scene that cannot be used is said so before a folder is made
  const OutputFolder folder(settings.job.output);
  const Chart result = chart(settings, say_on_stderr);
  for (const std::string& remark : result.remarks) fmt::print(stderr, "{}\n", remark);
  const std::pair<const char*, std::string> files[] = {{"chart.csv", chart_csv(result)},
                                                       {"chart.svg", chart_svg(result)},
                                                       {"statistics.csv", statistics_csv(result)}};
  for (const auto& [name, text] : files) {
    write_atomically(folder.path() / name, text);
    fmt::print("{}\n", (folder.path() / name).string());
  }
  return 0;
}

void add_fit(CLI::App& app, FitWords& words) {
  CLI::App& fit = *app.add_subcommand("fit",
                                      "Fit a grade to where the first singular points of measured "
                                      "sheets lie; or repeat that experiment");
  CLI::Option* scatter = fit.add_option("SCATTER", words.scatter,
                                        "Measured points: a .csv with columns u and v, in metres");
  CLI::Option* from = fit.add_option("--from", words.from, "The grade to begin with");
  fit.add_option("--experiment", words.experiment,
                 "Push sheets of this grade until their first singular point")
      ->excludes(scatter)
      ->excludes(from);
  fit.add_option("--sheets", words.sheets, "How many are simulated")
      ->capture_default_str()
      ->check(CLI::Range(1, 100000));
  fit.add_option("-o,--output", words.output,
                 "The fitted grade (.toml), or u,v,seed,frame of each sheet (.csv); a picture "
                 "beside it (.png)")
      ->required();
}

int run_verify(const std::filesystem::path& folder, bool json, bool estimate) {
  const Verification verification = verify(folder);
  std::optional<ErrorEstimates> estimates;
  if (estimate) estimates = estimate_errors(folder);
  if (json) {
    fmt::print("{}", verification_json(verification, estimates));
  } else {
    fmt::print("{}", verification_text(folder, verification));
    if (estimates) fmt::print("{}", estimates_text(*estimates));
  }
  return verification.differences.empty() ? 0 : gate_missed;
}

int run(int argc, char** argv) {
  CLI::App app("Bakes paper animation from handles keyed in a DCC.", "paperbake");
  app.set_version_flag("--version", "paperbake " PAPERBAKE_VERSION);
  app.require_subcommand(1);

  BakeWords words;
  add_bake(app, words);

  WedgeWords wedge_words;
  add_wedge(app, wedge_words);

  ChartSettings charted;
  ChartWords chart_words;
  add_chart(app, charted, chart_words);

  CLI::App& inspect = *app.add_subcommand(
      "inspect",
      "What is in a scene or a baked cache, what is wrong with it, where each value came from");
  std::filesystem::path inspected;
  OptionWords reading;
  reading.command = &inspect;
  bool json = false;
  std::optional<std::string> tracks;
  inspect
      .add_option("FILE", inspected,
                  "An .fbx, .glb or .gltf scene, a job file (.toml), or an .abc cache")
      ->required();
  inspect.add_flag("--json", json, "As JSON");
  inspect.add_option(
      "--tracks", tracks,
      "Write frame,node,x,y,z of every node to this file (world, z up, metres); - for stdout");
  for (const char* name : reading_options) add_option(reading, name);

  FitWords fit;
  add_fit(app, fit);

  CLI::App& judged = *app.add_subcommand(
      "verify", "Compare a baked folder with its certificate, from the files alone");
  std::filesystem::path folder;
  bool verdict_json = false, estimate = false;
  judged.add_option("DIR", folder, "The output folder of a bake")->required();
  judged.add_flag("--json", verdict_json, "As JSON");
  judged.add_flag("--estimate", estimate,
                  "How far every 12th frame moves when a finer mesh goes on from it: its error "
                  "within its branch");

  CLI::App& presets =
      *app.add_subcommand("presets", "List the paper grades, or print one with its sources");
  std::optional<std::string> grade;
  bool grades_json = false;
  presets.add_option("NAME", grade, "A grade or a preset file");
  presets.add_flag("--json", grades_json, "As JSON");

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // help and version
    throw Error(Fault::command, "command line", fmt::format("{}.", error.what()),
                "paperbake --help and paperbake COMMAND --help say what there is.");
  }
  if (app.got_subcommand("bake")) return run_bake(words);
  if (app.got_subcommand("wedge")) return run_wedge(wedge_words, {argv + 1, argv + argc});
  if (app.got_subcommand("chart")) return run_chart(std::move(charted), chart_words);
  if (app.got_subcommand("inspect")) return run_inspect(inspected, reading, json, tracks);
  if (app.got_subcommand("fit")) return run_fit(fit);
  if (app.got_subcommand("verify")) return run_verify(folder, verdict_json, estimate);
  return run_presets(grade, grades_json);
}

}  // namespace
}  // namespace paperbake

int main(int argc, char** argv) {
  // factors come and go by the megabyte: keep their memory instead of asking the kernel for zeroed
  // pages every time
  mallopt(M_MMAP_THRESHOLD, 1 << 28);
  mallopt(M_TRIM_THRESHOLD, 1 << 28);
  // a file that may grow no more is an error like a full disk, not the end
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    return paperbake::run(argc, argv);
  } catch (const paperbake::Error& error) {
    fmt::print(stderr, "paperbake: {}\n", error.what());
    return static_cast<int>(error.fault);
  } catch (const std::exception& error) {
    fmt::print(stderr, "paperbake: {}\n", error.what());
    return static_cast<int>(paperbake::Fault::simulation);
  }
}
