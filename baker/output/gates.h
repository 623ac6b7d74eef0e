#pragma once

#include "baker/job/plan.h"
#include "formats/files/certificate.h"

#include <string>
#include <vector>

namespace paperbake {

/// Limits that a bake must keep to end with exit code 0. The simulated mesh is judged by them, and
/// so is the mesh that is handed on.
struct Gates {
  double mean_stretch_pct = 2;  // c_m of any frame
  double max_stretch_pct = 5;   // any edge of any frame
  double handle_err_mm = 1;
  // As thick as copy paper: a sheet that is that deep in a collider has vanished in it with both of
  // its faces. It is twice the depth that the solver lets pass, and a pixel where A4 fills an image
  // 3,000 pixels high.
  double inside_mm = 0.1;
};

/// In the certificate, of a frame that the solver gave up.
inline constexpr const char* note_of_unsolved_step =
    "the sheet stands still although its handles move: the step was not solved";

/// What is good about a bake, in words for an artist: of everything that gates judge and that none
/// of the sentences about missed ones is about.
std::vector<std::string> good_news(const std::vector<FrameRecord>&,
                                   const std::vector<std::string>& missed);

/// What to do about a missed gate, by its sentence; empty where nothing is known.
std::string advice(const std::string& missed);

/// One sentence for each gate that was missed, with its worst frame and, for handles, the cause
/// where it is known. Empty: none was.
std::vector<std::string> missed_gates(const Gates&, const std::vector<FrameRecord>&,
                                      const BakePlan&);

}  // namespace paperbake
