#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace paperbake {

/// An array of jobs of Slurm.
struct SlurmJobs {
  int count = 1, threads = 1;
  std::filesystem::path logs;  // folder for what they print
  std::string options;         // further ones of sbatch, such as "--mem=2G --time=1:00:00"
};

/// A script of Slurm: jobs 1 to `count`, each running this program in this folder with these
/// arguments and --index behind them. Each option of sbatch has a line of its own.
std::string slurm_script(const std::vector<std::string>& arguments, const SlurmJobs&);

/// Hands a script to sbatch; what that prints, it prints.
/// throws Error(ErrorCode::command): there is no sbatch here, or it refuses
void submit_to_slurm(const std::filesystem::path& script);

}  // namespace paperbake
