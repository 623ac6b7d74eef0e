#pragma once

#include "formats/cache/alembic_cache.h"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace paperbake {

/// Reads the caches of AlembicWriter: triangle meshes, each below an Xform that carries its name.
/// Guides are passed over.
/// It is not a general Alembic reader: what the writer does not write is refused. Every function
/// returns or throws for any bytes whatsoever; it throws Error(ErrorCode::scene) with the file and
/// what is wrong with it.
class AlembicReader {
 public:
  struct Sheet {
    std::string name;  // name of the Xform
    std::size_t frames = 0;
    bool constant_topology = false;  // the faces are stored once
    bool velocity = false, normal = false, uv = false, crease = false;
  };

  explicit AlembicReader(const std::filesystem::path&);
  ~AlembicReader();

  const CacheInfo& info() const;  // frame_step and first_frame follow from the stored times
  const std::vector<Sheet>& sheets() const;

  /// Frame i of a sheet as it was given to the writer: z up, counter-clockwise faces. Numbers are
  /// rounded to 32 bits, creases limited to a right angle. `uv` is the pattern; uv sets and
  /// materials of the artist are not read.
  CacheFrame frame(std::size_t sheet, std::size_t i) const;

  /// What AlembicWriter::add_frame returned for this frame, computed again from the stored
  /// positions.
  std::string content_hash(std::size_t sheet, std::size_t i) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace paperbake
