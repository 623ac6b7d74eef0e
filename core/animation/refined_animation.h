#pragma once

#include "core/animation/animate.h"

#include <functional>

namespace paperbake {

struct PolishOptions {
  int triangles = 6000;                   // at most, of the fine mesh
  int threads = 1;                        // the frames do not depend on them
  std::function<bool(int frame)> wanted;  // which frames; empty: all
};

/// The method finds the shape of each frame, fine finite elements finish its minimisation
/// (refine_frame.h). First the whole shot is animated; then the frames are polished, side by side,
/// on one mesh that has all its singular points and lasting creases. A frame depends on its own
/// rough shape alone, and on those in which relative handles take hold: there the polished sheet is
/// what they hold from then on.
///
/// A frame is handed on as the method left it, and its note says so, when parts of the sheet come
/// near each other (the fine mesh does not feel that), when it does not come to rest, or when it
/// ends somewhere else (a tenth of the longer side away, or torn). Where that is so of most frames,
/// as in a crumple, none is polished. Of a polished frame elastic_ms, newton_iterations and the
/// energies are those of both methods together, and at the end.
///
/// Several sheets are animated together, and polished each by itself; what touches another is
/// handed on as the method left it.
///
/// on_frame  as animate_together, but for the order: all frames of a sheet, then those of the next
///           one
/// throws    as animate; what was animated before a failure is polished
/// source    algorithm E2.1
void animate_polished(const std::vector<AnimatedSheet>&, const PolishOptions&,
                      const std::function<bool(const AnimatedFrame&)>& on_frame);
void animate_polished(const Shot&, const Method&, const AnimateOptions&, const PolishOptions&,
                      const std::function<bool(const AnimatedFrame&)>& on_frame);

}  // namespace paperbake
