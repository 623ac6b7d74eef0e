#pragma once

#include "formats/cache/alembic_cache.h"
#include "formats/files/atomic_file.h"

#include <filesystem>

namespace paperbake {

/// Writes the positions of one sheet as a point cache (PC2; z up, metres). A point cache is applied
/// to a mesh with the same vertices in the same order: the flat pattern, which is written beside it
/// as an .obj with uv. Sample i is frame first_frame + i x frame_step. Both are an AtomicFile; the
/// .obj gets its name first.
class Pc2Writer {
 public:
  /// throws Error(ErrorCode::folder) when a file cannot be created
  Pc2Writer(const std::filesystem::path& cache, const std::filesystem::path& rest,
            const CacheInfo&);

  /// Appends a frame.
  /// longer_side  [m] of the pattern: uv = pattern / longer_side
  /// throws       Error(ErrorCode::folder) when the disk is full; finish() keeps the frames before.
  ///              Error(ErrorCode::command) when the mesh is not that of the first frame
  void add_frame(const CacheFrame&, double longer_side);

  /// Gives the files their names; must be the last call. returns the number of frames in the cache;
  /// without any there are no files
  std::size_t finish();

 private:
  std::filesystem::path path_;
  AtomicFile cache_, rest_;
  CacheInfo info_;
  Triangles triangles_;  // of the first frame
  std::int32_t points_ = 0, samples_ = 0;
};

}  // namespace paperbake
