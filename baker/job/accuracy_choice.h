#pragma once

#include <optional>
#include <string>
#include <vector>

namespace paperbake {

/// One size of the simulated mesh that was tried for --accuracy or --budget.
struct TriedSize {
  int size;                         // triangles as the option of the method counts them
  std::optional<double> error_pct;  // estimated, of the longer side; none: nothing finer was tried
  double seconds;                   // CPU time of its simulation
};

/// What --accuracy or --budget chose, and what is known about the error.
struct AccuracyChoice {
  std::optional<double> asked_pct;       // [% of the longer side]
  std::optional<double> budget_seconds;  // CPU time of search and simulation
  std::string method;
  std::string size_option;  // the option that was chosen: base_triangles or triangles
  int size = 0;
  // the estimated error that nine of ten frames keep, of those that have one answer
  double error_pct = 0;
  bool is_reached = false;
  // estimated error of each simulated frame from the first one on; it ends where the answer is no
  // longer one
  std::vector<double> frame_error_pct;
  // from this frame on meshes of different sizes part, and no size is nearer to the truth
  std::optional<int> parts_in_frame;
  std::string why_parts;
  std::vector<TriedSize> tried;
};

}  // namespace paperbake
