#pragma once

#include "baker/check/error_estimate.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace paperbake {

/// Something in an output folder that is not as the certificate says.
struct Difference {
  std::optional<int> frame;  // none: of the file as a whole
  std::string file, what;    // relative to the folder; one sentence
};

struct Verification {
  int frames = 0, files = 0;            // that were looked at
  std::vector<Difference> differences;  // those of single frames first, in their order
};

/// Measures the certificate's render numbers, depths in colliders, handle errors and hashes anew
/// from the files alone, and compares: lengths to 0.001 %, places and depths to 0.001 mm, crossings
/// and hashes exactly. Every file that the bake wrote is looked at to its last byte. A folder
/// without a whole certificate, or without a cache, is a difference, not an error. Of a bake that
/// has only a .usda, .usdc or .pc2, bytes are compared. throws Error(ErrorCode::command) when there
/// is no such folder
Verification verify(const std::filesystem::path& folder);

/// For people, and as JSON: {agrees, frames, files, first_frame_off, differences: [{frame, file,
/// what}]} and, when there are any, {estimates: [{frame, sheet, rms_pct, energy_loss_pct,
/// lower_branch_pct, uncertain}], estimate_ms_per_frame}.
std::string verification_text(const std::filesystem::path& folder, const Verification&);
std::string verification_json(const Verification&, const std::optional<ErrorEstimates>& = {});

}  // namespace paperbake
