#pragma once

#include "formats/cache/alembic_cache.h"
#include "formats/files/atomic_file.h"

#include <filesystem>

namespace paperbake {

/// Writes the positions of one sheet as a point cache (PC2, z up, metres), for a mesh with the same
/// vertices in the same order: the flat pattern, written beside it as an .obj with its uv. Sample i
/// is frame first_frame + i x frame_step. The files appear whole or not at all, the .obj first.
class Pc2Writer {
 public:
  /// throws Error(Fault::folder) when a file cannot be made.
  Pc2Writer(const std::filesystem::path& cache, const std::filesystem::path& rest,
            const CacheInfo&);

  /// longer_side  [m] of the pattern, which uv is in shares of
  /// throws Error(Fault::folder) when the disk is full: finish() may still keep the frames before;
  /// Error(Fault::command) when the mesh is not that of the first frame
  void add_frame(const CacheFrame&, double longer_side);

  /// The last call. returns how many frames the file has; without any there is no file
  std::size_t finish();

 private:
  std::filesystem::path path_;
  AtomicFile cache_, rest_;
  CacheInfo info_;
  Triangles triangles_;  // of the first frame
  std::int32_t points_ = 0, samples_ = 0;
};

}  // namespace paperbake
