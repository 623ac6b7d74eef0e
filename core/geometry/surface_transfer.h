#pragma once

#include "core/model/authored_surface.h"

#include <utility>
#include <vector>

namespace paperbake {

/// The edges of the artist's mesh across which a uv set or the material jumps. A mesh that has them
/// as edges can carry both exactly.
/// returns  their ends on the pattern [m]
std::vector<std::pair<Vector2d, Vector2d>> seams(const AuthoredSurface&);

/// The same of the other attributes, where there is no seam.
std::vector<std::pair<Vector2d, Vector2d>> jumps(const AuthoredSurface&);

/// Puts what was authored on another mesh of the same pattern. A corner of it gets the value that
/// the authored triangles have there, linearly between their corners; at a seam that of the side on
/// which its triangle lies. A triangle gets the material at its centre. Corners of a vertex that
/// agree share one row of the values.
MeshSurface surface_on(const AuthoredSurface&, const Points2& pattern, const Triangles&);

}  // namespace paperbake
