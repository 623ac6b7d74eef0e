#pragma once

#include "formats/files/certificate.h"

#include <functional>
#include <string>
#include <vector>

namespace paperbake {

/// "frame 5" or "3 frames from 5 to 9": those of which something is true, at one sheet at least;
/// empty: there are none.
std::string frames_that(const std::vector<FrameRecord>&,
                        const std::function<bool(const FrameRecord&)>& is_so);

}  // namespace paperbake
