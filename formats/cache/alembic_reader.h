#pragma once

#include "formats/cache/alembic_cache.h"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace paperbake {

/// Reads back what AlembicWriter writes: triangle meshes, each under an Xform that carries its
/// name. It is the writer's other half, not a reader of Alembic at large: what the writer does not
/// write is refused. Whatever the bytes are, a call returns or throws. All functions throw
/// Error(Fault::scene) that names the file, the place in it and what is wrong.
class AlembicReader {
 public:
  struct Sheet {
    std::string name;  // of the Xform
    std::size_t frames = 0;
    bool constant_topology = false;  // faces are stored once
    bool velocity = false, normal = false, uv = false, crease = false;
  };

  explicit AlembicReader(const std::filesystem::path&);
  ~AlembicReader();

  const CacheInfo& info() const;  // frame_step and first_frame from the stored times
  const std::vector<Sheet>& sheets() const;

  /// z up, faces counter-clockwise, as it was given to the writer but for the rounding to 32 bits;
  /// creases up to a right angle.
  CacheFrame frame(std::size_t sheet, std::size_t i) const;

  /// As AlembicWriter::add_frame returned it, made anew from the stored positions.
  std::string content_hash(std::size_t sheet, std::size_t i) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace paperbake
