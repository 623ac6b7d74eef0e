#include "baker/check/compare_reports.h"
#include "baker/command_line/command.h"
#include "formats/files/atomic_file.h"

#include <fmt/format.h>
#include <memory>

namespace paperbake {
namespace {

struct ReportArguments {
  std::string a, b, page = "compare.html";
};

CLI::App* add_report(CLI::App& app, ReportArguments& parsed) {
  CLI::App& report = *app.add_subcommand("report", "Compare two bakes side by side in one page");
  report.add_option("A", parsed.a, "The output folder of a bake with a report")->required();
  report.add_option("B", parsed.b, "The output folder of another one")->required();
  report.add_option("-o,--output", parsed.page, "The page to write")->capture_default_str();
  return &report;
}

int run_report(const ReportArguments& parsed) {
  write_atomically(parsed.page, comparison_page(parsed.a, parsed.b));
  fmt::print("{}\n", parsed.page);
  return 0;
}

}  // namespace

Command report_command(CLI::App& app) {
  const auto parsed = std::make_shared<ReportArguments>();
  CLI::App* const command = add_report(app, *parsed);
  return {command, [=] { return run_report(*parsed); }};
}

}  // namespace paperbake
