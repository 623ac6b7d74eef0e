#include "baker/command_line/command.h"
#include "baker/output/say.h"
#include "baker/studies/first_point_experiment.h"
#include "baker/studies/fit.h"
#include "core/model/error.h"
#include "formats/config/preset_file.h"
#include "formats/files/atomic_file.h"
#include "formats/files/raster_image.h"

#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <optional>

namespace paperbake {
namespace {

struct FitArguments {
  std::optional<std::filesystem::path> scatter;
  std::optional<std::string> from, experiment;
  std::filesystem::path output;
  int sheets = 20;
};

CLI::App* add_fit(CLI::App& app, FitArguments& parsed) {
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
  return &fit;
}

void print_to_stderr(const std::string& sentence) { say_line(sentence); }

constexpr unsigned other_sheets = 1000001;  // seeds that --experiment does not come to

std::filesystem::path picture_beside(const std::filesystem::path& file, const char* extension) {
  auto picture = file;
  picture.replace_extension(".png");
  if (picture == file)
    throw Error(ErrorCode::command, "-o " + file.string(),
                "The picture beside it would have the same name.",
                fmt::format("Write -o NAME{}.", extension));
  return picture;
}

int run_experiment(const FitArguments& arguments) {
  const Paper paper = read_preset(*arguments.experiment).paper;
  const auto picture = picture_beside(arguments.output, ".csv");
  write_atomically(arguments.output,
                   scatter_csv({}));  // known to be writable before the work begins
  const std::vector<FirstPoint> points = push_sheets(paper, arguments.sheets, 1, print_to_stderr);
  const Scatter scatter = scatter_of(points);
  say(fmt::format(
      "{} of {} sheets: mean ({:.2f}, {:.2f}) mm, deviation {:.2f} mm; apex_scatter of {}: "
      "{:.2f} mm\n",
      points.size(), arguments.sheets, 1e3 * scatter.mean.x(), 1e3 * scatter.mean.y(),
      1e3 * scatter.deviation, paper.name, 1e3 * paper.apex_scatter));
  write_atomically(arguments.output, scatter_csv(points));
  write_png(picture, scatter_picture(paper, points));
  fmt::print("{}\n{}\n", arguments.output.string(), picture.string());
  return 0;
}

int run_fit(const FitArguments& arguments) {
  if (arguments.experiment) return run_experiment(arguments);
  if (!arguments.scatter || !arguments.from)
    throw Error(ErrorCode::command, "fit", "There is nothing to fit.",
                "paperbake fit SCATTER.csv --from copy70 -o my.toml fits a grade; --experiment "
                "copy70 --sheets 20 -o scatter.csv repeats the experiment.");
  const Preset from = read_preset(*arguments.from);
  const auto picture = picture_beside(arguments.output, ".toml");
  const std::vector<Vector2d> measured = read_scatter(*arguments.scatter);
  Paper unscattered = from.paper;
  unscattered.apex_scatter = 0;
  const ScatterFit fit =
      fit_scatter(measured, push_sheets(unscattered, 1, 1, print_to_stderr).front().pattern);
  const Preset fitted = with_scatter(from, arguments.output.stem().string(), fit,
                                     arguments.scatter->filename().string());
  std::vector<Vector2d> simulated;
  for (const FirstPoint& p :
       push_sheets(fitted.paper, arguments.sheets, other_sheets, print_to_stderr))
    simulated.push_back(p.pattern);
  const TwoSamples test = compare_samples(measured, simulated);
  say(fmt::format(
      "{} points: deviation {:.2f} mm [{:.2f}, {:.2f}], likeliest {:.2f}; off the law's "
      "mean by u {:.2f} mm [{:.2f}, {:.2f}], v {:.2f} mm [{:.2f}, {:.2f}] (95 %)\n"
      "{} simulated sheets of the fitted grade: energy distance {:.3f} mm, p = {:.3f}{}\n",
      fit.points, 1e3 * fit.deviation, 1e3 * fit.deviation_within.low,
      1e3 * fit.deviation_within.high, 1e3 * fit.likeliest, 1e3 * fit.offset.x(),
      1e3 * fit.offset_u.low, 1e3 * fit.offset_u.high, 1e3 * fit.offset.y(), 1e3 * fit.offset_v.low,
      1e3 * fit.offset_v.high, simulated.size(), 1e3 * test.energy, test.p,
      test.p < 0.05 ? ": they do not scatter like the measured ones" : ""));
  write_atomically(arguments.output, preset_text(fitted));
  write_png(picture, fit_picture(fitted, measured, simulated, fit));
  fmt::print("{}\n{}\n", arguments.output.string(), picture.string());
  return 0;
}

}  // namespace

Command fit_command(CLI::App& app) {
  const auto parsed = std::make_shared<FitArguments>();
  CLI::App* const command = add_fit(app, *parsed);
  return {command, [=] { return run_fit(*parsed); }};
}

}  // namespace paperbake
