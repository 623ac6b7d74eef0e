#include "baker/studies/wedge_jobs.h"

#include "baker/output/output_folder.h"
#include "baker/output/say.h"
#include "baker/studies/child_processes.h"
#include "baker/studies/slurm.h"
#include "core/model/error.h"
#include "formats/files/atomic_file.h"
#include "formats/files/json.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace paperbake {
namespace {

/// Without what says who bakes.
std::vector<std::string> arguments_of_one(const std::vector<std::string>& arguments) {
  std::vector<std::string> kept;
  for (std::size_t k = 0; k < arguments.size(); ++k) {
    const std::string name = arguments[k].substr(0, arguments[k].find('='));
    if (name != "--jobs" && name != "--submit" && name != "--slurm")
      kept.push_back(arguments[k]);
    else if (name == arguments[k])
      ++k;
  }
  return kept;
}

/// A sentence; empty: there are none.
std::string describe_left(const std::vector<std::string>& folders) {
  constexpr std::size_t named = 8;
  if (folders.empty()) return "";
  const bool one = folders.size() == 1;
  std::string text = fmt::format(
      "Left from an earlier wedge and not part of this one: the folder{} {}", one ? "" : "s",
      fmt::join(folders.begin(), folders.begin() + std::min(named, folders.size()), ", "));
  if (folders.size() > named) text += fmt::format(" and {} more", folders.size() - named);
  return text + ".";
}

/// Says the line that programs or people read, as --progress asks for.
void tell(const Wedge& wedge, const std::string& json, const std::string& plain) {
  if (wedge.common.progress == ProgressMode::none) return;
  const std::string& line = wedge.common.progress == ProgressMode::json ? json : plain;
  if (!line.empty()) say_line(line);
}

}  // namespace

WedgeOutcome bake_wedge(const Wedge& wedge, int max_running,
                        const std::vector<std::string>& arguments,
                        const std::function<bool()>& stop) {
  make_folder(wedge.output / ".state");
  std::vector<ProcessSpec> processes;
  for (int index = 1; index <= wedge.count(); ++index) {
    forget_end(wedge, index);
    ProcessSpec process{arguments_of_one(arguments), wedge.state(index, ".log")};
    process.arguments.insert(process.arguments.end(), {"--index", std::to_string(index)});
    // the last find cores free
    if (index > wedge.count() - (max_running - 1) && !wedge.common.given.count("threads"))
      process.arguments.insert(process.arguments.end(), {"--threads", std::to_string(max_running)});
    processes.push_back(std::move(process));
  }
  int ended = 0;
  const auto begin = [&](std::size_t number) {
    tell(wedge, variation_start(wedge, static_cast<int>(number) + 1), "");
  };
  const auto note = [&](std::size_t number, int code) {
    const int index = static_cast<int>(number) + 1;
    note_end(wedge, index, code);
    ++ended;
    tell(wedge, variation_end(wedge, index, ended),
         fmt::format("{} of {}: {}", ended, wedge.count(), describe_variation(wedge, index)));
  };
  if (!run_processes(processes, max_running, begin, note, stop)) {
    if (const std::string left = describe_left(folders_left(wedge)); !left.empty())
      tell(wedge, json_line({{"type", "message"}, {"message", left}}), left);
    return finish_wedge(wedge);
  }
  throw Error(
      ErrorCode::stopped, wedge.output.string(),
      fmt::format("The bakes were stopped; {} of {} had come to an end.", ended, wedge.count()),
      "The same command goes on with what is left.");
}

void submit_wedge(const Wedge& wedge, const std::vector<std::string>& arguments,
                  const std::string& options) {
  make_folder(wedge.output / ".state");
  const auto script = wedge.output / "wedge.sbatch";
  write_atomically(script,
                   slurm_script(arguments_of_one(arguments), {wedge.count(), wedge.common.threads,
                                                              wedge.output / ".state", options}));
  submit_to_slurm(script);
}

}  // namespace paperbake
