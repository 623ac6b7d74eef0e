#include "baker/command_line/command_line.h"

#include "baker/bake/stop_signals.h"
#include "baker/command_line/command.h"
#include "baker/command_line/misspelling.h"
#include "baker/job/version.h"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>

namespace paperbake {

int run_command_line(const std::vector<std::string>& arguments) {
  CLI::App app("Bakes paper animation from handles keyed in a DCC.", "paperbake");
  app.set_version_flag("--version", [] {
    return fmt::format("paperbake {}\ncommit {}\n{}", program_version, program_commit,
                       program_libraries);
  });
  app.require_subcommand(1);
  // the last one wins: scripts append what they want otherwise
  app.option_defaults()->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
  const Command commands[] = {
      bake_command(app), wedge_command(app, arguments), chart_command(app),  inspect_command(app),
      fit_command(app),  verify_command(app),           report_command(app), presets_command(app)};
  try {
    std::vector<std::string> from_the_end(arguments.rbegin(), arguments.rend());
    app.parse(from_the_end);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // help and version
    if (const auto found = misspelling(app, arguments)) throw *found;
    throw Error(ErrorCode::command, "command line", fmt::format("{}.", error.what()),
                "paperbake --help and paperbake COMMAND --help list what there is.");
  }
  const Command& command = *std::find_if(std::begin(commands), std::end(commands),
                                         [&](auto& each) { return app.got_subcommand(each.app); });
  const StopSignals signals(command.patience());
  return command.run();
}

}  // namespace paperbake
