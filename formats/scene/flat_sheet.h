#pragma once

#include "core/model/authored_surface.h"
#include "core/model/pattern.h"
#include "core/model/sheet.h"
#include "formats/scene/scene_nodes.h"

#include <Eigen/Geometry>

#include <string>
#include <vector>

namespace paperbake {

/// A mesh of the scene as a sheet of paper.
struct FlatSheet {
  Pattern pattern;
  // the welded mesh in the world, with zero velocity; its front is that of the pattern
  Sheet start;
  std::vector<int> kept;  // of the vertices of all meshes of the node: those of `start`
  bool from_uv = false;   // else unrolled
  int joined_cuts = 0;    // edges at which there may have been a cut (joined_cuts.h)
  AuthoredSurface authored;
};

/// Outline and holes of a flat mesh, without the border vertices that lie on a straight line within
/// 1e-6 of the size. throws Error(ErrorCode::scene) at `place` when the border is missing, touches
/// itself or intersects itself
Pattern pattern_of(const Points2& flat, const Triangles&, const std::string& place);

/// Makes a sheet of all faces of a node. The pattern is the UV layout where it agrees with the edge
/// lengths, else the unrolled mesh. Vertices are welded within 1e-6 of the size, and for a pattern
/// from UVs within 1e-4 in uv: a sheet that is cut in its UVs stays cut. Cuts without width are
/// opened (open_slits.h).
/// world   transform of the node in metres: a reflection turns its faces
/// x       |V|x3 [m] the vertices of all its meshes
/// throws  Error(ErrorCode::scene) at `place`: no faces, faces without area, several pieces, edges
///         of three faces, inconsistent orientation, no border, not developable, overlapping itself
///         when laid flat
FlatSheet flat_sheet(const ImportedFile&, int node, const Eigen::Affine3d& world, const Points3& x,
                     const std::string& place);

}  // namespace paperbake
