#pragma once

#include "core/model/sheet.h"
#include "formats/scene/scene_import.h"

#include <Eigen/Geometry>

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

/// All faces of a node in the world, in metres, with the vertices of the file, which are not merged
/// yet.
/// world  of the node: a reflection turns its faces
WeldedMesh combined_mesh(const ImportedFile&, int node, const Eigen::Affine3d& world);

/// Merges vertices within 1e-6 of the size, and with keep_uv within 1e-4 in uv, into the one with
/// the lowest index; vertices without a face are left out.
WeldedMesh weld(const WeldedMesh&, bool keep_uv);

/// All faces of a node in the world, without uv and welded.
/// x  |V|x3 [m] the vertices of all its meshes
WeldedMesh welded_mesh(const ImportedFile&, int node, const Eigen::Affine3d& world,
                       const Points3& x);

/// Number of triangles whose height is below a millionth of their longest side.
int triangles_without_area(const WeldedMesh&);

/// Whether the connectivity of a mesh is that of one layer of paper in one piece.
bool is_one_layer(const WeldedMesh&);

/// throws Error(ErrorCode::scene) at `place` when a mesh is no sheet of paper: triangles without
/// area, edges of three faces, several pieces, inconsistent orientation, no border
void check_mesh(const WeldedMesh&, const std::string& place);

}  // namespace paperbake
