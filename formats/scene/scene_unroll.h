#pragma once

#include "core/model/sheet.h"

#include <optional>
#include <string>
#include <vector>

namespace paperbake {

/// A mesh without duplicate vertices, in the world at the first frame.
struct WeldedMesh {
  Points3 x;                   // |V|x3 [m]
  Points2 uv;                  // |V|x2 or empty
  Triangles triangles;         // |T|x3
  std::vector<int> kept = {};  // |V| the number of each vertex before equal ones were merged
};

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
