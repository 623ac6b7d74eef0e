#pragma once

#include "formats/cache/alembic_archive.h"
#include "formats/cache/alembic_cache.h"

#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

/// Triangle meshes as the AbcGeom schemas of Alembic define them: the properties of a mesh, their
/// types and their metadata.
namespace paperbake::alembic {

/// A bounding box.
struct Box {
  static constexpr double huge = std::numeric_limits<double>::max();
  // [m] min x y z, max x y z, as in the file; initially empty, as readers expect of an empty mesh
  std::array<double, 6> sides{huge, huge, huge, -huge, -huge, -huge};
};

/// The stored samples of one mesh at one frame.
struct MeshFrame {
  Box box;
  Sample bounds, points, velocities, normals, normal_indices, indices, counts, uv, uv_indices,
      colours;
};

struct Mesh {
  std::string name, label;  // as given by the caller, as written to the file
  std::vector<MeshFrame> frames;
};

/// Stores the values of a frame in the file: y up, clockwise faces, 32-bit floats.
MeshFrame store_frame(Archive&, const CacheFrame&);

/// The tree of the archive: an Xform and a PolyMesh for each mesh that has frames; `frames` is the
/// largest number of frames. Channels that no frame of a mesh has are left out.
Object archive_object(Archive&, const std::vector<Mesh>&, std::size_t frames);

}  // namespace paperbake::alembic
