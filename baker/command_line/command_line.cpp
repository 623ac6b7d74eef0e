#include "baker/command_line/command_line.h"

#include "baker/bake/stop_signals.h"
#include "baker/command_line/command.h"
#include "baker/command_line/misspelling.h"
#include "baker/job/version.h"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>
#include <optional>

namespace paperbake {
namespace {

/// The error for a command without one of its arguments, or for no command at all; nothing where
/// all are there.
std::optional<Error> missing_argument(const CLI::App& app) {
  const std::vector<const CLI::App*> given = app.get_subcommands({});
  const auto command = std::find_if(given.begin(), given.end(), [&](const CLI::App* each) {
    return app.got_subcommand(each->get_name());
  });
  if (command == given.end())
    return Error(ErrorCode::command, "command line", "It names no command.",
                 "paperbake bake SCENE -o DIR bakes a scene; paperbake --help lists the others.");
  for (const CLI::Option* option : (*command)->get_options())
    if (option->get_required() && option->count() == 0)
      return Error(ErrorCode::command, "command line",
                   fmt::format("{} needs {}: {}.", (*command)->get_name(), option->get_name(),
                               option->get_description()),
                   fmt::format("paperbake {} --help lists its options.", (*command)->get_name()));
  return {};
}

}  // namespace

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
    if (const auto found = missing_argument(app)) throw *found;
    throw Error(ErrorCode::command, "command line", fmt::format("{}.", error.what()),
                "paperbake --help and paperbake COMMAND --help list what there is.");
  }
  const Command& command = *std::find_if(std::begin(commands), std::end(commands),
                                         [&](auto& each) { return app.got_subcommand(each.app); });
  const StopSignals signals(command.patience());
  return command.run();
}

}  // namespace paperbake
