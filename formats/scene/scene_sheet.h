#pragma once

#include "core/model/pattern.h"
#include "core/model/sheet.h"
#include "formats/scene/scene_nodes.h"
#include "formats/scene/scene_unroll.h"

#include <Eigen/Geometry>

#include <string>

namespace paperbake {

/// A mesh of the scene as a sheet of paper.
struct FlatSheet {
  Pattern pattern;
  // vertices welded, where they are in the world; at rest; the mesh's front is the pattern's front
  Sheet start;
  bool from_uv = false;  // else unrolled
};

/// Outline and holes of a flat mesh, true corners only: border vertices on a straight line, within
/// 1e-6 of the size, are left out. throws Error(Fault::scene) at `place`: no border, or one that
/// touches or crosses itself
Pattern pattern_of(const Points2& flat, const Triangles&, const std::string& place);

/// Makes a sheet of all faces of a node. Vertices are welded within 1e-6 of the size (and 1e-4 of
/// uv where the pattern comes from the UVs: a sheet that is cut in its UVs stays cut). world:
/// transform of the node in metres throws Error(Fault::scene) at `place`: no faces, faces without
/// area, several pieces, edges of three faces, faces that disagree about the front, no border, not
/// developable, overlapping itself when laid flat
FlatSheet flat_sheet(const ImportedFile&, int node, const Eigen::Affine3d& world,
                     const std::string& place);

/// All faces of a node in the world, without uv; vertices welded within 1e-6 of the size.
WeldedMesh welded_mesh(const ImportedFile&, int node, const Eigen::Affine3d& world);

}  // namespace paperbake
