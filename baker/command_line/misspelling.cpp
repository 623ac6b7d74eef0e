#include "baker/command_line/misspelling.h"

#include "baker/job/options.h"
#include "formats/config/nearest_word.h"

#include <algorithm>
#include <fmt/format.h>

namespace paperbake {

std::optional<Error> misspelling(const CLI::App& app, const std::vector<std::string>& words) {
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

}  // namespace paperbake
