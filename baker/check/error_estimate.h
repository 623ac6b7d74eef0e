#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace paperbake {

/// How far a baked frame is from the shape that finer paper would have, found without a reference:
/// it is brought to the minimum of fem on 2,400 triangles, and what it moves is its error within
/// the branch that it is on.
/// source  this project; tests/bench/bench_polish.cpp compares it with true errors
struct ErrorEstimate {
  int frame = 0;
  std::string sheet;
  // how far it moved, of the longer side; NaN: it was not brought anywhere
  double rms_pct = 0;
  // how much less energy it stores there than the certificate says of the frame; below 0: more;
  // NaN: it stores next to nothing
  double energy_loss_pct = 0;
  // another shape under the same handles has so much less energy; 0: none was found
  double lower_branch_pct = 0;
  std::string uncertain;  // why the number is not to be relied on; empty: it is
};

struct ErrorEstimates {
  std::vector<ErrorEstimate> frames;
  double ms_per_frame = 0;  // CPU time, spread over all frames of the shot
};

/// Every 12th frame of a baked folder and its last one, from the files alone. throws
/// Error(ErrorCode::command): the folder has no cache or no certificate, or the sheets move with
/// inertia
ErrorEstimates estimate_errors(const std::filesystem::path& folder);

std::string estimates_text(const ErrorEstimates&);

}  // namespace paperbake
