#pragma once

#include "formats/scene/welded_mesh.h"

#include <optional>
#include <string>

namespace paperbake {

/// Whether all edges of the mesh are as long on a flat shape as in space, within 1 %.
bool keeps_lengths(const WeldedMesh&, const Points2& flat);

/// The flat shape of the mesh given by its UVs: uv times one length, fitted to all edges. Mirrored
/// UVs are mirrored back, so that triangles are counter-clockwise. |V|x2 [m]; nothing when the
/// length of an edge differs by more than 1 % or the UVs overlap themselves.
std::optional<Points2> pattern_from_uv(const WeldedMesh&);

/// The flat shape of the mesh, whose triangles are unfolded one after the other. |V|x2 [m],
/// counter-clockwise. The mesh must be one piece, and every edge must have one or two triangles of
/// consistent orientation.
/// throws Error(ErrorCode::scene) at `place`, with the worst angle defect, when it cannot be laid
/// flat with all edge lengths within 1 %
Points2 unrolled(const WeldedMesh&, const std::string& place);

}  // namespace paperbake
