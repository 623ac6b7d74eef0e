#include "baker/bake/bake.h"
#include "baker/bake/stop_signals.h"
#include "baker/check/compare_reports.h"
#include "baker/check/error_estimate.h"
#include "baker/check/inspect.h"
#include "baker/check/verify.h"
#include "baker/job/job_settings.h"
#include "baker/job/options.h"
#include "baker/job/used_values.h"
#include "baker/job/version.h"
#include "baker/output/output_folder.h"
#include "baker/output/say.h"
#include "baker/studies/accuracy_search.h"
#include "baker/studies/chart.h"
#include "baker/studies/chart_picture.h"
#include "baker/studies/fit_command.h"
#include "baker/studies/wedge_jobs.h"
#include "core/model/error.h"
#include "formats/config/preset_file.h"
#include "formats/files/atomic_file.h"
#include "formats/files/json.h"

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <csignal>
#include <fcntl.h>
#include <fmt/format.h>
#include <malloc.h>
#include <unistd.h>

// The command line: words in, exit code out. What the commands do lies behind bake.h, chart.h,
// inspect.h, verify.h, compare_reports.h, wedge_jobs.h and fit_command.h.

namespace paperbake {
namespace {

constexpr int gate_missed = 4;

/// For a bake, which completes what it can when it is asked to stop.
bool is_stop_asked() { return StopSignals::asked(); }

const CLI::Validator positive(
    [](std::string& text) {
      double value;
      return CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0
                 ? std::string()
                 : "\"" + text + "\" is not a number above zero";
    },
    "", "positive");

/// What a command was told of the options of the table.
struct ParsedOptions {
  CLI::App* command = nullptr;
  std::map<std::string, std::string> text;  // by option, of those that the command has
  std::vector<std::string> set;
};

constexpr std::array reading_options = {"fps", "start_frame", "unit_scale", "take",
                                        "allow_outside"};

void add_option(ParsedOptions& parsed, const std::string& name, const std::string& flags = {}) {
  const Option& o = option(name);
  std::string& text = parsed.text[name];
  const std::string& spelled = flags.empty() ? o.flags : flags;
  if (o.kind == JobKey::flag) {
    parsed.command->add_flag(spelled, text, o.help);
    return;
  }
  CLI::Option* added = parsed.command->add_option(spelled, text, o.help);
  if (!o.default_value.empty()) added->default_str(o.default_value);
  if (o.kind == JobKey::word)
    added->type_name(fmt::format("{}", fmt::join(o.words, "|")));
  else if (o.kind != JobKey::list)
    added->type_name(o.kind == JobKey::number ? "NUMBER" : o.kind == JobKey::whole ? "N" : "TEXT");
}

void add_set(ParsedOptions& parsed) {
  parsed.command->add_option("--set", parsed.set,
                             "key=value: one number of the paper, over preset and scene; "
                             "friction=0: its layers slide freely");
}

/// What was said: first by the job file, when the scene is one, then by the command line.
void apply_command_line(const ParsedOptions& parsed, BakeSettings& settings) {
  const auto scene = parsed.text.find("scene");
  const bool job = scene != parsed.text.end() && is_job(scene->second);
  if (job) load_job(settings, scene->second);
  for (const Option& o : options()) {
    const CLI::Option* given =
        parsed.text.count(o.name)
            ? parsed.command->get_option_no_throw(o.name == "scene" ? "SCENE" : o.flags)
            : nullptr;
    if (given && given->count() > 0 && !(job && o.name == "scene"))
      apply_option(settings, o, parsed.text.at(o.name), o.flags, Origin::command);
  }
  for (const std::string& text : parsed.set) settings.set.push_back(parse_set(text));
}

/// Of `bake` beyond the options of the table.
struct BakeArguments : ParsedOptions {
  std::optional<std::filesystem::path> write_job, log;
  bool dry_run = false, force = false;
};

/// SCENE and all options of the table, and --set.
void add_all_options(ParsedOptions& parsed) {
  add_option(parsed, "scene", "SCENE");
  parsed.command->get_option("SCENE")->required()->description(
      "An .fbx, .glb or .gltf file with a sheet and animated handles, or a job file (.toml)");
  add_option(parsed, "output", "-o,--output");
  for (const Option& o : options())
    if (o.name != "scene" && o.name != "output") add_option(parsed, o.name);
  add_set(parsed);
}

void add_bake(CLI::App& app, BakeArguments& parsed) {
  parsed.command = app.add_subcommand(
      "bake", "Simulate the sheets of a scene and write cache, maps and certificate");
  add_all_options(parsed);
  parsed.command->add_flag("--dry-run", parsed.dry_run,
                           "Check everything and print the job, but write nothing");
  parsed.command->add_option("--write-job", parsed.write_job,
                             "Write a job file that says the same, with all that it could say; "
                             "without -o that is all that is done. Refuses to overwrite a file");
  parsed.command->add_flag("--force", parsed.force, "Let --write-job overwrite a file");
  parsed.command->add_option(
      "--log", parsed.log,
      "Append every line of progress, every warning and the end to this file, with times (UTC)");
}

/// throws Error(ErrorCode::command) when the job would overwrite something, such as the scene
void write_job(const BakeArguments& parsed, const BakeSettings& settings) {
  std::error_code none;
  if (!parsed.force && std::filesystem::exists(*parsed.write_job, none))
    throw Error(ErrorCode::command, parsed.write_job->string(),
                "There is a file of this name; --write-job would overwrite it.",
                "Choose another name, or add --force.");
  if (std::filesystem::equivalent(*parsed.write_job, settings.scene, none))
    throw Error(ErrorCode::command, parsed.write_job->string(),
                "This is the scene itself; --write-job would overwrite it.",
                "Choose another name, such as shot.toml.");
  write_atomically(*parsed.write_job, job_text(settings, *parsed.write_job));
}

int run_bake(const BakeArguments& parsed) {
  BakeSettings settings;
  apply_command_line(parsed, settings);
  settings.log = parsed.log;
  if (settings.output.empty() && !parsed.write_job && !parsed.dry_run)
    throw Error(ErrorCode::command, "command line", "--output is required: the folder to write to.",
                "Write -o DIR, or output = \"DIR\" in the job file.");
  if (parsed.write_job) {
    const BakePlan plan = plan_bake(settings);  // what cannot be baked is not written
    write_job(parsed, settings);
    if (settings.output.empty()) {
      fmt::print("{}\n", parsed.write_job->string());
      return plan.impossible.empty() ? 0 : gate_missed;
    }
  }

  const BakePlan plan = plan_with_accuracy(settings, [&](const std::string& sentence) {
    Progress(settings.progress, 0, passes_of(settings)).message(sentence);
  });
  if (parsed.dry_run) {
    Progress progress(settings.progress, 0, passes_of(settings));
    print_warnings(plan, progress);
    fmt::print("{}", lock_text(plan));
    return plan.impossible.empty() ? 0 : gate_missed;
  }
  const BakeOutcome outcome = bake_with_progress(settings, plan, is_stop_asked);
  for (const auto& file : outcome.files) list_line(file.string());
  return outcome.exit_code;
}

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
  CLI::Option* index = wedge.add_option(
      "--index", parsed.index,
      "Bake this variation only, from 1; the last one to be done writes the table");
  wedge
      .add_option(
          "--submit", parsed.submit,
          "slurm: write DIR/wedge.sbatch, an array of jobs with --index, and hand it to sbatch")
      ->excludes(index)
      ->check(CLI::IsMember({"slurm"}));
  wedge.add_option("--slurm", parsed.slurm,
                   "Further options of sbatch for --submit slurm, in quotes: \"--mem=2G "
                   "--time=1:00:00\"");
}

/// arguments  of the program, as they were given
int run_wedge(const WedgeArguments& parsed, const std::vector<std::string>& arguments) {
  BakeSettings settings;
  apply_command_line(parsed, settings);
  if (settings.output.empty())
    throw Error(ErrorCode::command, "command line", "--output is required: the folder to write to.",
                "Write -o DIR.");
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
  for (const auto& file : outcome.files) list_line(file.string());
  return outcome.exit_code;
}

struct InspectArguments : ParsedOptions {
  std::filesystem::path file;
  bool json = false;
  std::optional<std::string> tracks;  // file, or - for stdout
};

void add_inspect(CLI::App& app, InspectArguments& parsed) {
  CLI::App& inspect = *app.add_subcommand(
      "inspect",
      "Show what is in a scene or a baked cache, what is wrong with it, and where each value came "
      "from");
  parsed.command = &inspect;
  inspect
      .add_option("FILE", parsed.file,
                  "An .fbx, .glb or .gltf scene, a job file (.toml), or an .abc cache")
      ->required();
  inspect.add_flag("--json", parsed.json, "Print JSON");
  inspect.add_option("--tracks", parsed.tracks,
                     "Write frame,node,x,y,z of every node to this file (world space, z up, "
                     "metres); - for stdout");
  for (const char* name : reading_options) add_option(parsed, name);
}

int run_inspect(const InspectArguments& parsed) {
  BakeSettings settings;
  const bool job = is_job(parsed.file);
  if (job)
    load_job(settings, parsed.file);
  else
    settings.scene = parsed.file;
  apply_command_line(parsed, settings);
  if (parsed.tracks) {
    const std::string csv = tracks_csv(settings.scene, settings.reading);
    if (*parsed.tracks == "-")
      fmt::print("{}", csv);
    else
      write_atomically(*parsed.tracks, csv);
    return 0;
  }
  const bool cache = parsed.file.extension() == ".abc";
  fmt::print("{}", cache ? inspect_cache(parsed.file, parsed.json)
                   : job ? inspect_job(settings, parsed.json)
                         : inspect_scene(parsed.file, settings.reading, parsed.json));
  return 0;
}

struct PresetsArguments {
  std::optional<std::string> name;
  bool json = false;
};

void add_presets(CLI::App& app, PresetsArguments& parsed) {
  CLI::App& presets =
      *app.add_subcommand("presets", "List the paper grades, or print one with its sources");
  presets.add_option("NAME", parsed.name, "A grade or a preset file");
  presets.add_flag("--json", parsed.json, "Print JSON");
}

int run_presets(const PresetsArguments& parsed) {
  const auto& [name, json] = parsed;
  if (name && !json) {
    fmt::print("{}", read_preset(*name).text);
    return 0;
  }
  Json all = Json::array();
  std::vector<std::string> grades = name ? std::vector<std::string>{*name} : preset_names();
  if (!name)  // those of the user stand for those built in of the same name
    for (const std::string& own : user_preset_names())
      if (std::find(grades.begin(), grades.end(), own) == grades.end()) grades.push_back(own);
  for (const std::string& grade : grades) {
    const Preset preset = read_preset(grade);
    Json entries = Json::object();
    for (const Preset::Entry& e : preset.entries)
      entries[e.key] = {
          {"value", e.value}, {"unit", e.unit}, {"source", e.source}, {"mark", e.mark}};
    all.push_back({{"name", preset.paper.name}, {"file", preset.file}, {"values", entries}});
    if (!json)
      fmt::print("{:<12} {:>4g} g/m2  {:>4g} um  D {:<8g} N m  {}\n", grade,
                 1e3 * preset.paper.area_density, 1e6 * preset.paper.thickness,
                 preset.paper.bending_stiffness, preset.file);
  }
  if (json) fmt::print("{}\n", json_lines(name ? all.front() : all));
  return 0;
}

struct ChartArguments : ParsedOptions {
  ChartSettings settings;
  std::string methods;
};

void add_chart(CLI::App& app, ChartArguments& parsed) {
  ChartSettings& s = parsed.settings;
  CLI::App& chart = *app.add_subcommand("chart",
                                        "Run the methods on a scene at several sizes: speed "
                                        "against accuracy, as chart.csv and chart.svg");
  parsed.command = &chart;
  add_option(parsed, "scene", "SCENE");
  chart.get_option("SCENE")->required();
  add_option(parsed, "output", "-o,--output");
  parsed.methods = fmt::format("{}", fmt::join(s.methods, ","));
  chart.add_option("--methods", parsed.methods, "Which, separated by commas")
      ->capture_default_str();
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
    add_option(parsed, name);
  add_set(parsed);
  for (const char* name : reading_options) add_option(parsed, name);
}

int run_chart(const ChartArguments& parsed) {
  ChartSettings settings = parsed.settings;
  apply_command_line(parsed, settings.job);
  if (settings.job.output.empty())
    throw Error(ErrorCode::command, "command line", "--output is required: the folder to write to.",
                "Write -o DIR.");
  settings.methods.clear();
  for (const std::string& name : CLI::detail::split(parsed.methods, ','))
    settings.methods.push_back(name);
  plan_bake(settings.job);  // a scene that cannot be used is said so before a folder is made
  const OutputFolder folder(settings.job.output);
  const Chart result = chart(settings, say_line);
  for (const std::string& remark : result.remarks) say_line(remark);
  const std::pair<const char*, std::string> files[] = {{"chart.csv", chart_csv(result)},
                                                       {"chart.svg", chart_svg(result)},
                                                       {"statistics.csv", statistics_csv(result)}};
  for (const auto& [name, text] : files) {
    write_atomically(folder.path() / name, text);
    list_line((folder.path() / name).string());
  }
  return 0;
}

void add_fit(CLI::App& app, FitArguments& parsed) {
  CLI::App& fit = *app.add_subcommand("fit",
                                      "Fit a grade to where the first singular points of measured "
                                      "sheets lie; or repeat that experiment");
  CLI::Option* scatter = fit.add_option("SCATTER", parsed.scatter,
                                        "Measured points: a .csv with columns u and v, in metres");
  CLI::Option* from = fit.add_option("--from", parsed.from, "The grade to begin with");
  fit.add_option("--experiment", parsed.experiment,
                 "Push sheets of this grade until their first singular point")
      ->excludes(scatter)
      ->excludes(from);
  fit.add_option("--sheets", parsed.sheets, "How many are simulated")
      ->capture_default_str()
      ->check(CLI::Range(1, 100000));
  fit.add_option("-o,--output", parsed.output,
                 "The fitted grade (.toml), or u,v,seed,frame of each sheet (.csv); a picture "
                 "beside it (.png)")
      ->required();
}

struct VerifyArguments {
  std::filesystem::path folder;
  bool json = false, estimate = false;
};

void add_verify(CLI::App& app, VerifyArguments& parsed) {
  CLI::App& verify = *app.add_subcommand(
      "verify", "Compare a baked folder with its certificate, from the files alone");
  verify.add_option("DIR", parsed.folder, "The output folder of a bake")->required();
  verify.add_flag("--json", parsed.json, "Print JSON");
  verify.add_flag("--estimate", parsed.estimate,
                  "Estimate the error of every 12th frame: how far it moves when a finer mesh "
                  "continues from it, within its branch");
}

int run_verify(const VerifyArguments& parsed) {
  const Verification verification = verify(parsed.folder);
  std::optional<ErrorEstimates> estimates;
  if (parsed.estimate) estimates = estimate_errors(parsed.folder);
  if (parsed.json) {
    fmt::print("{}", verification_json(verification, estimates));
  } else {
    fmt::print("{}", verification_text(parsed.folder, verification));
    if (estimates) fmt::print("{}", estimates_text(*estimates));
  }
  return verification.differences.empty() ? 0 : gate_missed;
}

struct ReportArguments {
  std::string a, b, page = "compare.html";
};

void add_report(CLI::App& app, ReportArguments& parsed) {
  CLI::App& report = *app.add_subcommand("report", "Compare two bakes side by side in one page");
  report.add_option("A", parsed.a, "The output folder of a bake with a report")->required();
  report.add_option("B", parsed.b, "The output folder of another one")->required();
  report.add_option("-o,--output", parsed.page, "The page to write")->capture_default_str();
}

int run_report(const ReportArguments& parsed) {
  write_atomically(parsed.page, comparison_page(parsed.a, parsed.b));
  fmt::print("{}\n", parsed.page);
  return 0;
}

/// The error for a command or option that does not exist, with the nearest one; nothing when all
/// of them do.
std::optional<Error> misspelt(const CLI::App& app, const std::vector<std::string>& words) {
  const auto suggestion = [](const std::string& near) {
    return near.empty() ? "paperbake --help and paperbake COMMAND --help list what there is."
                        : fmt::format("Did you mean {}?", near);
  };
  const auto named = std::find_if(words.begin(), words.end(),
                                  [](const std::string& word) { return word.front() != '-'; });
  if (named == words.end()) return {};
  const CLI::App* command = nullptr;
  std::vector<std::string> known;
  for (const CLI::App* each : app.get_subcommands({})) {
    known.push_back(each->get_name());
    if (each->get_name() == *named) command = each;
  }
  if (!command)
    return Error(ErrorCode::command, "command line",
                 fmt::format("There is no command \"{}\".", *named),
                 suggestion(nearest_word(*named, known)));
  known.clear();
  for (const CLI::Option* option : command->get_options())
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  bool is_value = false;  // of the option before it, such as --slurm "--mem=2G"
  for (const std::string& word : words) {
    const std::string name = word.substr(0, word.find_first_of("= "));
    const CLI::Option* option = is_value ? nullptr : command->get_option_no_throw(name);
    const bool is_option = !is_value && word.rfind("--", 0) == 0 && word.size() > 2;
    is_value = option && name == word && option->get_expected_min() > 0;
    if (is_option && std::find(known.begin(), known.end(), name) == known.end())
      return Error(ErrorCode::command, "command line",
                   fmt::format("{} has no option {}.", *named, name),
                   suggestion(nearest_word(name, known)));
  }
  return {};
}

int run(int argc, char** argv) {
  CLI::App app("Bakes paper animation from handles keyed in a DCC.", "paperbake");
  app.set_version_flag("--version", [] {
    return fmt::format("paperbake {}\ncommit {}\n{}", program_version, program_commit,
                       program_libraries);
  });
  app.require_subcommand(1);
  // the last one wins: scripts append what they want otherwise
  app.option_defaults()->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);

  BakeArguments bake;
  WedgeArguments wedge;
  ChartArguments chart;
  InspectArguments inspect;
  FitArguments fit;
  VerifyArguments verify;
  ReportArguments report;
  PresetsArguments presets;
  add_bake(app, bake);
  add_wedge(app, wedge);
  add_chart(app, chart);
  add_inspect(app, inspect);
  add_fit(app, fit);
  add_verify(app, verify);
  add_report(app, report);
  add_presets(app, presets);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // help and version
    const std::vector<std::string> words(argv + 1, argv + argc);
    if (const auto found = misspelt(app, words)) throw *found;
    throw Error(ErrorCode::command, "command line", fmt::format("{}.", error.what()),
                "paperbake --help and paperbake COMMAND --help list what there is.");
  }

  // a wedge waits for its bakes; other commands have nothing to complete
  const std::chrono::milliseconds patience(app.got_subcommand("bake") || wedge.index ? 850
                                           : app.got_subcommand("wedge")             ? 950
                                                                                     : 0);
  const StopSignals signals(patience);
  if (app.got_subcommand("bake")) return run_bake(bake);
  if (app.got_subcommand("wedge")) return run_wedge(wedge, {argv + 1, argv + argc});
  if (app.got_subcommand("chart")) return run_chart(chart);
  if (app.got_subcommand("inspect")) return run_inspect(inspect);
  if (app.got_subcommand("fit")) return run_fit(fit);
  if (app.got_subcommand("verify")) return run_verify(verify);
  if (app.got_subcommand("report")) return run_report(report);
  return run_presets(presets);
}

}  // namespace
}  // namespace paperbake

/// A stream that the caller has closed leads to nowhere: otherwise the next file that is opened
/// would get its number, and messages would be written into it.
static void open_standard_streams() {
  int opened;
  do opened = ::open("/dev/null", O_RDWR);
  while (opened >= 0 && opened <= STDERR_FILENO);
  if (opened >= 0) ::close(opened);
}

int main(int argc, char** argv) {
  open_standard_streams();
  // factors come and go by the megabyte: keep their memory instead of asking the kernel for zeroed
  // pages every time
  mallopt(M_MMAP_THRESHOLD, 1 << 28);
  mallopt(M_TRIM_THRESHOLD, 1 << 28);
  // a file that may grow no more is an error like a full disk, not the end
  std::signal(SIGXFSZ, SIG_IGN);
  // and so is a pipe that nobody reads any more
  std::signal(SIGPIPE, SIG_IGN);
  try {
    return paperbake::run(argc, argv);
  } catch (const paperbake::Error& error) {
    paperbake::say_line(std::string("paperbake: ") + error.what());
    return static_cast<int>(error.code);
  } catch (const std::exception& error) {
    paperbake::say_line(std::string("paperbake: ") + error.what());
    return static_cast<int>(paperbake::ErrorCode::simulation);
  }
}
