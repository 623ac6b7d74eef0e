#include "baker/command_line/command.h"
#include "baker/command_line/parsed_options.h"
#include "baker/job/plan.h"
#include "baker/output/output_folder.h"
#include "baker/output/say.h"
#include "baker/studies/chart.h"
#include "baker/studies/chart_picture.h"
#include "formats/files/atomic_file.h"

#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <memory>
#include <utility>

namespace paperbake {
namespace {

const CLI::Validator positive(
    [](std::string& text) {
      double value;
      return CLI::detail::lexical_cast(text, value) && std::isfinite(value) && value > 0
                 ? std::string()
                 : "\"" + text + "\" is not a number above zero";
    },
    "", "positive");

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
  add_reading_options(parsed);
}

int run_chart(const ChartArguments& parsed) {
  ChartSettings settings = parsed.settings;
  apply_command_line(parsed, settings.job);
  require_output(settings.job);
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

}  // namespace

Command chart_command(CLI::App& app) {
  const auto parsed = std::make_shared<ChartArguments>();
  add_chart(app, *parsed);
  return {parsed->command, [=] { return run_chart(*parsed); }};
}

}  // namespace paperbake
