#include "baker/studies/wedge_jobs.h"

#include "baker/output/output_folder.h"
#include "baker/studies/child_processes.h"
#include "baker/studies/slurm.h"
#include "core/model/error.h"
#include "formats/files/atomic_file.h"

#include <fmt/format.h>

namespace paperbake {
namespace {

/// Without what says who bakes.
std::vector<std::string> words_of_one(const std::vector<std::string>& words) {
  std::vector<std::string> kept;
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (words[k] == "--jobs" || words[k] == "--submit")
      ++k;
    else if (words[k].rfind("--jobs=", 0) != 0 && words[k].rfind("--submit=", 0) != 0)
      kept.push_back(words[k]);
  }
  return kept;
}

}  // namespace

WedgeOutcome bake_wedge(const Wedge& wedge, int most, const std::vector<std::string>& words) {
  make_folder(wedge.output / ".state");
  std::vector<Child> children;
  for (int index = 1; index <= wedge.count(); ++index) {
    Child child{words_of_one(words), wedge.state(index, ".log")};
    child.words.insert(child.words.end(), {"--index", std::to_string(index)});
    // the last find cores free
    if (index > wedge.count() - (most - 1) && !wedge.common.said.count("threads"))
      child.words.insert(child.words.end(), {"--threads", std::to_string(most)});
    children.push_back(std::move(child));
  }
  int ended = 0;
  const bool interrupted = run_children(children, most, [&](std::size_t number, int code) {
    const int index = static_cast<int>(number) + 1;
    note_end(wedge, index, code);
    ++ended;
    if (wedge.common.progress != ProgressMode::none)
      fmt::print(stderr, "{} of {}: {}\n", ended, wedge.count(), describe_variation(wedge, index));
  });
  if (!interrupted) return finish_wedge(wedge);
  throw Error(
      Fault::stopped, wedge.output.string(),
      fmt::format("The bakes were stopped; {} of {} had come to an end.", ended, wedge.count()),
      "The same command goes on with what is left.");
}

void submit_wedge(const Wedge& wedge, const std::vector<std::string>& words) {
  make_folder(wedge.output / ".state");
  const auto script = wedge.output / "wedge.sbatch";
  write_atomically(script, slurm_script(words_of_one(words), wedge.count(), wedge.common.threads,
                                        wedge.output / ".state"));
  submit_to_slurm(script);
}

}  // namespace paperbake
