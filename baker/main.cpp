#include "baker/bake.h"
#include "baker/chart.h"
#include "baker/chart_picture.h"
#include "baker/estimate.h"
#include "baker/experiment.h"
#include "baker/inspect.h"
#include "baker/output_folder.h"
#include "baker/verify.h"
#include "core/error.h"
#include "formats/preset_file.h"
#include "formats/whole_file.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <csignal>
#include <fmt/format.h>
#include <malloc.h>
#include <nlohmann/json.hpp>

// The command line: words in, exit code out. What the commands do lies behind bake.h, chart.h, inspect.h, verify.h and experiment.h.

namespace paperbake {
namespace {

constexpr int gate_missed = 4;

std::pair<std::string, std::string> key_and_value(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    throw Error(Fault::command, "--set " + text, "A key and a value are needed.", "Write --set key=value, for instance --set thickness=90e-6.");
  return {text.substr(0, equals), text.substr(equals + 1)};
}

std::set<std::string> parse_formats(const std::string& text) {
  const std::vector<std::string> known{"abc", "maps", "cert", "report", "usd", "pc2"};
  std::set<std::string> formats;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t comma = std::min(text.find(',', from), text.size());
    const std::string name = text.substr(from, comma - from);
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw Error(Fault::command, "--formats", fmt::format("Unknown format \"{}\".", name), fmt::format("This version writes: {}.", fmt::join(known, ", ")));
    formats.insert(name);
    from = comma + 1;
  }
  return formats;
}

/// Numbers as people write them: finite, and where it says so above zero.
const CLI::Validator finite([](std::string& text) {
  double value;
  return CLI::detail::lexical_cast(text, value) && std::isfinite(value) ? std::string() : "\"" + text + "\" is not a number";
}, "", "finite");
const CLI::Validator positive([](std::string& text) {
  double value;
  return CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0 ? std::string() : "\"" + text + "\" is not a number above zero";
}, "", "positive");

/// What the words of `bake` were, before they are understood.
struct BakeWords {
  std::vector<std::string> set;
  std::string formats = "abc,maps,cert,report", frames, map_frames;
  bool dry_run = false;
  ProgressMode progress = ProgressMode::automatic;
};

void add_reading_options(CLI::App& command, SceneOptions& options) {
  command.add_option("--fps", options.fps, "Frames a second, instead of the file's own (glTF has none: else paper_fps, else 24)")->check(positive);
  command.add_option("--start-frame", options.start_frame, "Frame of the first key, where the file has lost it (Blender's FBX export with All Actions) or is to be moved");
  command.add_option("--unit-scale", options.unit_scale, "Length of one unit of the file in metres")->check(positive);
  command.add_option("--take", options.take, "Name of the one animation to use; else all are merged");
}

void add_bake(CLI::App& app, BakeSettings& s, BakeWords& words) {
  CLI::App& bake = *app.add_subcommand("bake", "Simulate the sheets of a scene and write cache, maps and certificate");
  bake.add_option("SCENE", s.scene, "An .fbx, .glb or .gltf file with a sheet and animated handles")->required();
  bake.add_option("-o,--output", s.output, "Output folder; made when missing")->required();
  bake.add_option("--preset", s.preset, "Paper grade (see `paperbake presets`) or a preset file; replaces the scene's");
  bake.add_option("--set", words.set, "key=value: one number of the paper, over preset and scene");
  bake.add_option("--method", s.method, "How to simulate: hybrid, fem, adaptive; hybrid+fem: hybrid, polished")->capture_default_str();
  bake.add_option("--seed", s.seed, "Seed of all that is random; else the sheet's paper_seed, else 0");
  bake.add_option("--triangles", s.triangles, "Triangles of fem's mesh, within 10 % (1700); the most that hybrid (250) and adaptive (3000) may have")->check(CLI::Range(2, 400000));
  bake.add_option("--polish", s.polish, "Bring every frame to the minimum of a fem of at most this many triangles, on the branch that the method found; 0: do not (hero: 6,000)")->check(CLI::Range(0, 400000));
  bake.add_option("--base-triangles", s.base_triangles, "Triangles that hybrid begins with")->capture_default_str()->check(CLI::Range(2, 100000));
  bake.add_option("--mesh", s.mesh, "Mesh in the cache: render (one for the whole shot, the default), simulation (as it is simulated)")
      ->transform(CLI::CheckedTransformer(std::map<std::string, CacheMesh>{{"render", CacheMesh::render}, {"simulation", CacheMesh::simulation}}));
  bake.add_option("--quality", s.quality, "Edges of the render mesh on a sheet of 0.2 m: draft 5 mm, shot 2 mm (the default), hero 1 mm")
      ->transform(CLI::CheckedTransformer(std::map<std::string, Quality>{{"draft", Quality::draft}, {"shot", Quality::shot}, {"hero", Quality::hero}}));
  bake.add_option("--formats", words.formats, "What to write, of abc,maps,cert,report,usd,pc2")->capture_default_str();
  bake.add_option("--gravity", s.gravity, "m/s2, positive = downwards; else the scene's paper_gravity, else 0")->check(finite);
  bake.add_option("--stop", s.stop, "Newton's stop: metres from the minimum")->capture_default_str()->check(positive);
  bake.add_option("--dynamics", s.dynamics, "Inertia: auto (where a sheet falls, swings or is thrown), off, on")
      ->transform(CLI::CheckedTransformer(std::map<std::string, Dynamics>{{"auto", Dynamics::automatic}, {"off", Dynamics::off}, {"on", Dynamics::on}}));
  bake.add_option("--probe", s.probe_every, "Every N frames, look for another shape of less energy under the same handles, and take it; 0: never")->capture_default_str()->check(CLI::Range(0, 100000));
  bake.add_option("--frames", words.frames, "A-B or A-BxN: frames to write; simulated from the scene's first; past the last key handles rest");
  bake.add_option("--map-size", s.map_size, "Texels on a side of the maps")->capture_default_str()->check(CLI::Range(1, 16384));
  bake.add_option("--map-layout", s.map_layout, "scanline; tiled-mip: 64 x 64 tiles with mip levels, for renderers")
      ->transform(CLI::CheckedTransformer(std::map<std::string, MapLayout>{{"scanline", MapLayout::scanline}, {"tiled-mip", MapLayout::tiled_mip}}));
  bake.add_option("--map-frames", words.map_frames, "Frames with a map: A-BxN,...; the final one always (default: every 12th)");
  bake.add_option("--debug-pictures", s.debug_pictures, "Folder for pictures of pattern mesh and sheet: of the frames of --map-frames (else every 6th), of births and of the last");
  bake.add_option("--max-stretch", s.max_stretch_pct, "Gate: longest or shortest edge in percent of its rest length")->capture_default_str()->check(positive);
  bake.add_flag("--strict", s.strict, "Refuse handles that ask the impossible, instead of meeting them as far as paper can");
  bake.add_option("--threads", s.threads, "Threads; the result does not depend on them")->capture_default_str()->check(positive);
  bake.add_option("--progress", words.progress, "auto, plain, json, none; on stderr")
      ->transform(CLI::CheckedTransformer(std::map<std::string, ProgressMode>{{"auto", ProgressMode::automatic}, {"plain", ProgressMode::plain}, {"json", ProgressMode::json}, {"none", ProgressMode::none}}));
  bake.add_flag("--dry-run", words.dry_run, "Check everything and print the job, but write nothing");
  add_reading_options(bake, s.reading);
}

int run_bake(BakeSettings settings, const BakeWords& words) {
  for (const std::string& text : words.set) settings.set.push_back(key_and_value(text));
  settings.formats = parse_formats(words.formats);
  if (!words.frames.empty()) settings.frames = parse_frames(words.frames, "--frames");
  if (!words.map_frames.empty()) settings.map_frames = parse_frame_list(words.map_frames, "--map-frames");
  const BakePlan plan = plan_bake(settings);

  const FrameSpan& f = plan.frames;
  Progress progress(words.progress, static_cast<int>(plan.shots.size()) * ((f.last - f.first) / f.step + 1), passes_of(settings));
  for (const std::string& warning : plan.warnings) progress.say("warning: " + warning);
  for (const SheetImpossible& pair : plan.impossible) progress.say("warning: " + describe(pair));
  if (words.dry_run) {
    fmt::print("{}", lock_text(plan));
    return plan.impossible.empty() ? 0 : gate_missed;
  }
  const BakeOutcome outcome = bake(settings, plan, progress);
  for (const std::string& sentence : outcome.missed) progress.say("gate missed: " + sentence);
  for (const auto& file : outcome.files) fmt::print("{}\n", file.string());
  return outcome.exit_code;
}

int run_inspect(const std::filesystem::path& scene, const SceneOptions& options, bool json, const std::optional<std::string>& tracks) {
  if (tracks) {
    const std::string csv = tracks_csv(scene, options);
    if (*tracks == "-") fmt::print("{}", csv);
    else write_whole_file(*tracks, csv);
    return 0;
  }
  const bool cache = scene.extension() == ".abc";
  fmt::print("{}", cache ? inspect_cache(scene, json) : inspect_scene(scene, options, json));
  return 0;
}

int run_presets(const std::optional<std::string>& name, bool json) {
  if (name && !json) {
    fmt::print("{}", read_preset(*name).text);
    return 0;
  }
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const std::string& grade : name ? std::vector<std::string>{*name} : preset_names()) {
    const Preset preset = read_preset(grade);
    nlohmann::ordered_json entries = nlohmann::ordered_json::object();
    for (const Preset::Entry& e : preset.entries)
      entries[e.key] = {{"value", e.value}, {"unit", e.unit}, {"source", e.source}, {"mark", e.mark}};
    all.push_back({{"name", preset.paper.name}, {"values", entries}});
    if (!json) fmt::print("{:<10} {:>5g} g/m2  {:>4g} um  D {:g} N m\n", preset.paper.name, 1e3 * preset.paper.area_density, 1e6 * preset.paper.thickness, preset.paper.bending_stiffness);
  }
  if (json) fmt::print("{}\n", (name ? all.front() : all).dump(1));
  return 0;
}

struct ChartWords {
  std::vector<std::string> set;
  std::string methods, frames;
};

void add_chart(CLI::App& app, ChartSettings& s, ChartWords& words) {
  CLI::App& chart = *app.add_subcommand("chart", "Run the methods on a scene at several sizes: speed against accuracy, as chart.csv and chart.svg");
  chart.add_option("SCENE", s.job.scene, "An .fbx, .glb or .gltf file with a sheet and animated handles")->required();
  chart.add_option("-o,--output", s.job.output, "Output folder; made when missing")->required();
  words.methods = fmt::format("{}", fmt::join(s.methods, ","));
  chart.add_option("--methods", words.methods, "Which, separated by commas")->capture_default_str();
  chart.add_option("--repeat", s.repeat, "Runs of each; times are medians")->capture_default_str()->check(CLI::Range(1, 1000));
  chart.add_option("--reference", s.reference, "Triangles of the fem that the others are compared with; half as many as long as it does not come to an end")->capture_default_str()->check(CLI::Range(100, 400000));
  chart.add_option("--budget", s.budget, "Seconds for everything")->capture_default_str()->check(positive);
  chart.add_option("--preset", s.job.preset, "Paper grade or a preset file; replaces the scene's");
  chart.add_option("--set", words.set, "key=value: one number of the paper, over preset and scene");
  chart.add_option("--seed", s.job.seed, "First of the seeds; else the sheet's paper_seed, else 0");
  chart.add_option("--gravity", s.job.gravity, "m/s2, positive = downwards; else the scene's paper_gravity, else 0")->check(finite);
  chart.add_option("--stop", s.job.stop, "Newton's stop: metres from the minimum, for all methods")->capture_default_str()->check(positive);
  chart.add_option("--frames", words.frames, "A-B or A-BxN: frames to compare");
  chart.add_option("--threads", s.job.threads, "Every run has one thread; accepted for the sake of scripts")->capture_default_str()->check(positive);
  add_reading_options(chart, s.job.reading);
}

int run_chart(ChartSettings settings, const ChartWords& words) {
  for (const std::string& text : words.set) settings.job.set.push_back(key_and_value(text));
  if (!words.frames.empty()) settings.job.frames = parse_frames(words.frames, "--frames");
  settings.methods.clear();
  for (const std::string& name : CLI::detail::split(words.methods, ',')) settings.methods.push_back(name);
  plan_bake(settings.job);  // a scene that cannot be used is said so before a folder is made
  const OutputFolder folder(settings.job.output);
  const Chart result = chart(settings, [](const std::string& sentence) { fmt::print(stderr, "{}\n", sentence); });
  for (const std::string& remark : result.remarks) fmt::print(stderr, "{}\n", remark);
  const std::pair<const char*, std::string> files[] = {{"chart.csv", chart_csv(result)}, {"chart.svg", chart_svg(result)}, {"statistics.csv", statistics_csv(result)}};
  for (const auto& [name, text] : files) {
    write_whole_file(folder.path() / name, text);
    fmt::print("{}\n", (folder.path() / name).string());
  }
  return 0;
}

struct FitWords {
  std::optional<std::string> scatter, from, experiment;
  std::filesystem::path output;
  int sheets = 20;
};

void add_fit(CLI::App& app, FitWords& words) {
  CLI::App& fit = *app.add_subcommand("fit", "The experiment that tells how first singular points scatter, and the grade that fits it");
  fit.add_option("SCATTER", words.scatter, "A file of measured points, u,v in metres: not in this version");
  fit.add_option("--from", words.from, "The grade to begin with: not in this version");
  fit.add_option("--experiment", words.experiment, "Push sheets of this grade until their first singular point");
  fit.add_option("--sheets", words.sheets, "How many")->capture_default_str()->check(CLI::Range(1, 100000));
  fit.add_option("-o,--output", words.output, "u,v,seed,frame of each sheet (.csv); a picture beside it (.png)")->required();
}

int run_fit(const FitWords& words) {
  if (words.scatter || words.from || !words.experiment)
    throw Error(Fault::command, "fit", "Fitting a grade to measured points is not in this version.",
                "paperbake fit --experiment copy70 --sheets 20 -o scatter.csv repeats the experiment.");
  const Paper paper = read_preset(*words.experiment).paper;
  auto picture = words.output;
  picture.replace_extension(".png");
  if (picture == words.output) throw Error(Fault::command, "-o " + words.output.string(), "The picture beside it would have the same name.", "Write -o NAME.csv.");
  write_whole_file(words.output, scatter_csv({}));  // known to be writable before the work begins
  std::vector<FirstPoint> points;
  for (int sheet = 1; sheet <= words.sheets; ++sheet) {
    const auto point = first_singular_point(paper, sheet);
    if (point) points.push_back(*point);
    fmt::print(stderr, "sheet {} of {}: {}\n", sheet, words.sheets,
               point ? fmt::format("frame {}, ({:.1f}, {:.1f}) mm", point->frame, 1e3 * point->pattern.x(), 1e3 * point->pattern.y()) : "no singular point");
  }
  if (points.empty())
    throw Error(Fault::simulation, fmt::format("{}, {} sheets", paper.name, words.sheets), fmt::format("No sheet got a singular point in {} frames.", experiment_frames));
  const Scatter scatter = scatter_of(points);
  fmt::print(stderr, "{} of {} sheets: mean ({:.2f}, {:.2f}) mm, deviation {:.2f} mm; apex_scatter of {}: {:.2f} mm\n", points.size(), words.sheets,
             1e3 * scatter.mean.x(), 1e3 * scatter.mean.y(), 1e3 * scatter.deviation, paper.name, 1e3 * paper.apex_scatter);
  write_whole_file(words.output, scatter_csv(points));
  write_png(picture, scatter_picture(paper, points));
  fmt::print("{}\n{}\n", words.output.string(), picture.string());
  return 0;
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

  BakeSettings settings;
  BakeWords words;
  add_bake(app, settings, words);

  ChartSettings charted;
  ChartWords chart_words;
  add_chart(app, charted, chart_words);

  CLI::App& inspect = *app.add_subcommand("inspect", "What is in a scene or a baked cache, what is wrong with it, where each value came from");
  std::filesystem::path scene;
  SceneOptions reading;
  bool json = false;
  std::optional<std::string> tracks;
  inspect.add_option("FILE", scene, "An .fbx, .glb or .gltf scene, or an .abc cache")->required();
  inspect.add_flag("--json", json, "As JSON");
  inspect.add_option("--tracks", tracks, "Write frame,node,x,y,z of every node to this file (world, z up, metres); - for stdout");
  add_reading_options(inspect, reading);

  FitWords fit;
  add_fit(app, fit);

  CLI::App& judged = *app.add_subcommand("verify", "Compare a baked folder with its certificate, from the files alone");
  std::filesystem::path folder;
  bool verdict_json = false, estimate = false;
  judged.add_option("DIR", folder, "The output folder of a bake")->required();
  judged.add_flag("--json", verdict_json, "As JSON");
  judged.add_flag("--estimate", estimate, "How far every 12th frame moves when a finer mesh goes on from it: its error within its branch");

  CLI::App& presets = *app.add_subcommand("presets", "List the paper grades, or print one with its sources");
  std::optional<std::string> grade;
  bool grades_json = false;
  presets.add_option("NAME", grade, "A grade or a preset file");
  presets.add_flag("--json", grades_json, "As JSON");

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // help and version
    throw Error(Fault::command, "command line", fmt::format("{}.", error.what()), "paperbake --help and paperbake COMMAND --help say what there is.");
  }
  if (app.got_subcommand("bake")) return run_bake(std::move(settings), words);
  if (app.got_subcommand("chart")) return run_chart(std::move(charted), chart_words);
  if (app.got_subcommand("inspect")) return run_inspect(scene, reading, json, tracks);
  if (app.got_subcommand("fit")) return run_fit(fit);
  if (app.got_subcommand("verify")) return run_verify(folder, verdict_json, estimate);
  return run_presets(grade, grades_json);
}

}  // namespace
}  // namespace paperbake

int main(int argc, char** argv) {
  // factors come and go by the megabyte: keep their memory instead of asking the kernel for zeroed pages every time
  mallopt(M_MMAP_THRESHOLD, 1 << 28);
  mallopt(M_TRIM_THRESHOLD, 1 << 28);
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may grow no more is an error like a full disk, not the end
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
