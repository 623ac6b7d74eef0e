#pragma once

#include "formats/files/certificate.h"

#include <functional>
#include <string>
#include <vector>

namespace paperbake {

/// One number of every frame, to be drawn over time.
struct FrameLine {
  std::string name;
  std::function<double(const FrameRecord&)> value;
  bool sum;  // over several sheets; otherwise the largest counts
};

/// A chart of report.html.
struct FrameChart {
  std::string unit;
  bool stepped;  // its numbers are whole
  std::vector<FrameLine> lines;
};

/// The charts that visit_frame_statistics asks for, in their order.
std::vector<FrameChart> frame_charts();

}  // namespace paperbake
