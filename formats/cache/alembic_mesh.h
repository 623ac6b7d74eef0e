#pragma once

#include "formats/cache/alembic_archive.h"
#include "formats/cache/alembic_cache.h"

#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

/// Meshes as the schemas of AbcGeom want them: which properties, of what type, with which texts.
namespace paperbake::alembic {

/// min x y z, max x y z: the order of the file.
struct Box {
  static constexpr double huge = std::numeric_limits<double>::max();
  // of nothing; what readers expect of an empty mesh
  std::array<double, 6> sides{huge, huge, huge, -huge, -huge, -huge};
};

/// The samples of one mesh at one frame.
struct MeshFrame {
  Box box;
  Sample bounds, points, velocities, normals, normal_indices, indices, counts, uv, uv_indices,
      colours;
};

struct Mesh {
  std::string name, label;  // as asked for, as stored
  std::vector<MeshFrame> frames;
};

/// Puts the values of a frame into the file: y up, faces clockwise, 32-bit floats.
MeshFrame store_frame(Archive&, const CacheFrame&);

/// The archive with one Xform + PolyMesh for each mesh that has a frame; the longest has `frames`.
/// Channels that no frame of a mesh gives are left out.
Object archive_object(Archive&, const std::vector<Mesh>&, std::size_t frames);

}  // namespace paperbake::alembic
