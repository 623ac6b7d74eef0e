#pragma once

#include "formats/scene/scene_import.h"
#include "formats/scene/welded_mesh.h"

namespace paperbake {

/// Number of inner edges at which the two triangles of a flat sheet have vertices of their own in
/// the file, although nothing there tells these apart: a cut, perhaps, that welding has closed.
/// Exporters split the vertices of whole paper where its normals, its uv or its material change,
/// and some split all: 0 for a sheet that is not flat, and where most edges are so.
/// all     the vertices of the file, of all meshes of the node
/// welded  the same triangles, in the same order
int joined_cuts(const ImportedFile&, int node, const WeldedMesh& all, const WeldedMesh& welded);

}  // namespace paperbake
