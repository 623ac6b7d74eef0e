#include "baker/studies/slurm.h"

#include "baker/studies/child_processes.h"
#include "core/model/error.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <spawn.h>
#include <sstream>
#include <sys/wait.h>
#include <unistd.h>

namespace paperbake {
namespace {

/// One word of a shell, whatever is in it.
std::string quoted(const std::string& word) {
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

/// A line for each option: a word that begins with a dash, and the words behind it.
std::string option_lines(const std::string& options) {
  std::string lines;
  std::istringstream words(options);
  for (std::string word; words >> word;) {
    if (word.front() == '-' || lines.empty())
      lines += (lines.empty() ? "" : "\n") + ("#SBATCH " + word);
    else
      lines += " " + word;
  }
  return lines.empty() ? "" : lines + "\n";
}

/// Where the log of a job goes: a line for Slurm, or, where that has no quotes for what is in the
/// path, one for the shell.
std::string log_lines(const std::filesystem::path& logs) {
  const std::string path = std::filesystem::absolute(logs).string();
  const bool plain = std::all_of(path.begin(), path.end(), [](unsigned char c) {
    return c >= ' ' && c != 127 && c != '"' && c != '\\' && c != '%' && c != '$' && c != '`';
  });
  if (plain) return fmt::format("#SBATCH --output=\"{}/slurm.%a.log\"\n", path);
  return fmt::format(
      "#SBATCH --output=/dev/null\nexec > {}/slurm.\"$SLURM_ARRAY_TASK_ID\".log 2>&1\n",
      quoted(path));
}

}  // namespace

std::string slurm_script(const std::vector<std::string>& arguments, const SlurmJobs& jobs) {
  std::string command = quoted(this_program().string());
  for (const std::string& argument : arguments) command += " " + quoted(argument);
  return fmt::format(
      "#!/bin/bash\n#SBATCH --job-name=paperbake\n#SBATCH --array=1-{}\n#SBATCH "
      "--ntasks=1\n#SBATCH --cpus-per-task={}\n#SBATCH --requeue\n"
      "{}{}cd {} || exit\nexec {} --index "
      "\"$SLURM_ARRAY_TASK_ID\"\n",
      jobs.count, jobs.threads, option_lines(jobs.options), log_lines(jobs.logs),
      quoted(std::filesystem::current_path().string()), command);
}

void submit_to_slurm(const std::filesystem::path& script) {
  const std::string file = script.string();
  const char* arguments[] = {"sbatch", file.c_str(), nullptr};
  pid_t child = 0;
  const int failed =
      posix_spawnp(&child, arguments[0], nullptr, nullptr, const_cast<char**>(arguments), environ);
  if (failed)
    throw Error(
        ErrorCode::command, "--submit slurm",
        fmt::format("sbatch cannot be started here: {}.", std::strerror(failed)),
        fmt::format("The script is written: run sbatch {} where Slurm is (Debian: slurm-wlm).",
                    file));
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw Error(ErrorCode::command, "--submit slurm",
                "sbatch did not take the job; what it said stands above.",
                fmt::format("The script is written: {}.", file));
}

}  // namespace paperbake
