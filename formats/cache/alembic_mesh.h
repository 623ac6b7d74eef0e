#pragma once

#include "formats/cache/alembic_archive.h"
#include "formats/cache/alembic_cache.h"
#include "formats/cache/alembic_guides.h"
#include "formats/cache/alembic_properties.h"

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

/// Triangle meshes as the AbcGeom schemas of Alembic define them: the properties of a mesh, their
/// types and their metadata.
namespace paperbake::alembic {

/// The stored samples of one mesh at one frame.
struct MeshFrame {
  Box box;
  Sample bounds, points, velocities, normals, normal_indices, indices, counts, pattern,
      pattern_indices, colours;
  // of each attribute of the surface: its values, and which of them a corner has
  std::vector<std::array<Sample, 2>> attributes;
  std::vector<Sample> face_sets;  // of each material: the faces that have it
};

struct Mesh {
  std::string name, label;  // as given by the caller, as written to the file
  std::vector<MeshFrame> frames = {};
  std::shared_ptr<const MeshSurface> surface = {};  // of the last frame; names are equal in all
  std::vector<GuideFrame> guides = {};              // of each frame, or none
  GuideLabels guide_labels = {};
};

/// Stores the values of a frame in the file: y up, clockwise faces, 32-bit floats. With the same
/// surface as the frame before it, what it has of that is taken from there.
MeshFrame store_frame(Archive&, const CacheFrame&, const Mesh&);

/// The tree of the archive: an Xform and a PolyMesh for each mesh that has frames; `frames` is the
/// largest number of frames. Channels that no frame of a mesh has are left out.
Object archive_object(Archive&, const std::vector<Mesh>&, std::size_t frames);

}  // namespace paperbake::alembic
