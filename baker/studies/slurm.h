#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace paperbake {

/// A script of Slurm: an array of jobs 1 to `count`, each running this program in this folder with
/// these arguments and --index behind them. logs: folder for what they print
std::string slurm_script(const std::vector<std::string>& arguments, int count, int threads,
                         const std::filesystem::path& logs);

/// Hands a script to sbatch; what that prints, it prints.
/// throws Error(ErrorCode::command): there is no sbatch here, or it refuses
void submit_to_slurm(const std::filesystem::path& script);

}  // namespace paperbake
