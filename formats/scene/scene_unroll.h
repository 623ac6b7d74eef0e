#pragma once

#include "core/model/sheet.h"

#include <optional>
#include <string>

namespace paperbake {

/// A mesh without doubled vertices, in the world at the first frame.
struct WeldedMesh {
  Points3 x;            // |V|x3 [m]
  Points2 uv;           // |V|x2 or empty
  Triangles triangles;  // |T|x3
};

/// The flat shape of the mesh after its UVs: uv times one length, fitted over the edges; mirrored
/// where the UVs are, so that triangles are counter-clockwise. [m]  None when an edge's length
/// differs by more than 1 %, or the UVs fold over.
std::optional<Points2> pattern_from_uv(const WeldedMesh&);

/// The flat shape of the mesh, its triangles unfolded one after the other, counter-clockwise. [m]
/// The mesh is one piece, every edge has one or two triangles that agree about the front. throws
/// Error(Fault::scene) at `place`: it cannot be laid flat with all edges within 1 %; names the
/// worst angle defect
Points2 unrolled(const WeldedMesh&, const std::string& place);

}  // namespace paperbake
