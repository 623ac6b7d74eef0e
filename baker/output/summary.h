#pragma once

#include "baker/job/plan.h"
#include "formats/files/certificate.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace paperbake {

/// The name of the processor, as it gives it itself.
std::string machine_name();

/// How a bake ended.
struct SummaryEnding {
  std::vector<std::string> missed_gates;  // sentences
  int exit_code = 0;
  std::string failure;  // what ended it or could not be written; empty: nothing
  // [s] of the stages, as StageClock has them; what is written after the summary is not in them
  std::map<std::string, double> cpu_s = {};
};

/// The creases of a shot.
struct SummaryCreases {
  double length;  // [m] in the last frame
  // of each sheet: lines that nothing announced, numbered after those of PlannedSheet::crease_lines
  std::vector<std::vector<CreaseLine>> found;
  // of each sheet and each of its crease lines: the first frame in which it is folded
  std::vector<std::vector<std::optional<int>>> frames_of_folding;
};

/// cert/summary.json: the certificate over the whole shot.
/// files          of the bake: path relative to its folder, and hash of its bytes
std::string summary_json(const BakePlan&, const std::vector<FrameRecord>&, const SummaryCreases&,
                         const SummaryEnding&, const std::map<std::string, std::string>& files);

}  // namespace paperbake
