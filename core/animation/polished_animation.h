#pragma once

#include "core/animation/animate.h"

#include <functional>

namespace paperbake {

struct PolishOptions {
  int triangles = 6000;                   // of the fine mesh, at most
  int threads = 1;                        // the frames do not depend on it
  std::function<bool(int frame)> wanted;  // which frames to polish; empty: all
  // called for every frame as it is simulated; returns false to end the shot there, and nothing of
  // it is polished or handed on then. May be empty.
  std::function<bool(const AnimatedFrame&)> on_simulated = {};
};

/// The method finds the shape of each frame, then fine finite elements refine it to equilibrium
/// (polisher.h). The whole shot is animated first. Then its frames are polished in parallel, on
/// one mesh that has all singular points and lasting creases of the shot. A frame depends only on
/// its own unpolished shape and on the frames in which relative handles take hold: what such a
/// handle holds from then on is the polished sheet.
///
/// A frame is handed on unpolished, and its note says so, when parts of the sheet come near each
/// other (the fine mesh has no self-contact), when the sheet lies on a collider or moves with
/// inertia, when it does not come to rest, or when it ends inside a collider or in another shape (a
/// tenth of the longer side away, or torn). If that happens to most of the frames that are tried
/// first, as in a crumple, none is polished. In a polished frame elastic_ms and newton_iterations
/// are the sums over both methods, and the energies are those of the polished sheet.
///
/// Several sheets are animated together and polished one by one. A frame in which a sheet touches
/// another is handed on unpolished.
///
/// on_frame  as in animate_together, but in another order: all frames of a sheet, then those of the
///           next
/// throws    as animate, after polishing what was animated before the failure
/// source    this project
void animate_polished(const std::vector<AnimatedSheet>&, const PolishOptions&,
                      const std::function<bool(const AnimatedFrame&)>& on_frame);
void animate_polished(const Shot&, const MethodChoice&, const AnimateOptions&, const PolishOptions&,
                      const std::function<bool(const AnimatedFrame&)>& on_frame);

}  // namespace paperbake
