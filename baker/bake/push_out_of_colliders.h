#pragma once

#include "core/geometry/collider_motion.h"
#include "core/render/render_surface.h"
#include "core/render/untangle_sheets.h"

#include <memory>

namespace paperbake {

/// A rendered sheet in a frame, and what it may not pass.
struct SheetAmongColliders {
  const RenderSurface& surface;
  const std::shared_ptr<const Colliders>& colliders;
  int row;  // frame - first frame of the scene
  const SheetUntangler::Simulated& simulated;
};

/// The curved surface stands out from its flat triangles: where they rest on a collider, into it.
/// What lies inside, or nearer than the clearance, is pushed out, and lengths that are wrong after
/// this are restored, in turns. Each turn asks for half the clearance of the one before: where
/// there is no room for it, between two colliders or beside a held vertex, the sheet still ends
/// outside of all of them. A sheet that is jammed has stayed behind in a collider, and is left
/// there: pushed out, it would be torn.
/// clearance  [m]
/// x          |V|x3 [m] the sheet, changed in place
/// returns    whether it was changed
bool push_out_of_colliders(const SheetAmongColliders&, double clearance, Points3& x);

}  // namespace paperbake
