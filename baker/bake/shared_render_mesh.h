#pragma once

#include "baker/bake/render_input.h"
#include "core/render/render_surface.h"

#include <vector>

namespace paperbake {

/// The render mesh of each sheet, one for the whole shot: it has all handles, singular points and
/// lasting creases of the sheet; and all simulated edges, if layers or sheets come so near each
/// other that the surface would intersect without them.
std::vector<RenderSurface> make_render_surfaces(const std::vector<RenderInput>&,
                                                const RenderOptions&);

}  // namespace paperbake
