#pragma once

#include "baker/job/plan.h"
#include "formats/files/certificate.h"

#include <map>
#include <string>
#include <vector>

namespace paperbake {

/// What a bake must keep to end with exit code 0, and whether it did.
struct Gates {
  double mean_stretch_pct = 2;  // c_m of any frame
  double max_stretch_pct = 5;   // any edge of any frame
  double handle_err_mm = 1;
};

/// One sentence for each gate that was missed, with its worst frame. Empty: all kept.
std::vector<std::string> missed_gates(const Gates&, const std::vector<FrameRecord>&,
                                      const BakePlan&);

/// Which frames have sheets that pass through others, in words; empty: none.
std::string describe_sheet_intersections(const std::vector<FrameRecord>&);

/// What the processor calls itself.
std::string machine_name();

/// cert/summary.json: the certificate over the whole shot.
/// crease_length  [m] of the last frame
/// files  of the bake, relative to its folder, and the keys of their bytes
/// exit_code of the bake; failure: what ended it, or could not be written; empty when it went well
std::string summary_json(const BakePlan&, const std::vector<FrameRecord>&, double crease_length,
                         const std::vector<std::string>& missed, int exit_code,
                         const std::string& failure,
                         const std::map<std::string, std::string>& files);

}  // namespace paperbake
