#pragma once

#include "formats/cache/alembic_cache.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace paperbake {

/// Writes the same frames as AlembicWriter as a USD layer in text (.usda): a mesh /shot/SHEET each,
/// y up, metres, time codes = frames, velocities a second, primvars:crease in radians, and a
/// primvar for each layer of the frames. What is the same in all frames is stored once. Every
/// attribute's samples wait in a nameless file of their own, because a layer wants them one after
/// another; the layer itself appears whole or not at all. The same calls write the same bytes.
/// source  usda as OpenUSD 26 reads it
class UsdWriter {
 public:
  /// Names become identifiers: letters, digits, `_`. throws Error(Fault::folder) when the file
  /// cannot be made.
  UsdWriter(const std::filesystem::path&, const CacheInfo&,
            const std::vector<std::string>& sheet_names);
  ~UsdWriter();

  /// Appends the next frame of a sheet. Values must be finite. throws Error(Fault::folder) when the
  /// disk is full.
  void add_frame(std::size_t sheet, const CacheFrame&);

  /// Gives the file its name; the last call.
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace paperbake
