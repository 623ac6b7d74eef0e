#pragma once

#include "formats/cache/alembic_cache.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace paperbake {

/// The two encodings of a USD layer: .usda and .usdc. They hold the same.
enum class UsdEncoding { text, crate };

/// What a UsdWriter makes: one layer that holds everything; or three, as pipelines hand them on.
/// NAME.asset.usdX defines the sheets: topology, uv sets, subsets, bindings and materials, and of
/// what moves the values of the first frame. NAME.animation.usdX has nothing but `over`s: points,
/// extent, velocities and normals in every frame, and what else changes. NAME.usdX, written last,
/// composes both. Then meshes have the purpose "render", and where frames have a CacheProxy there
/// is a mesh `SHEET_proxy` of purpose "proxy", their proxyPrim.
enum class UsdLayers { one, separate };

/// The path of such a layer. part: "asset" or "animation"
std::filesystem::path usd_part_path(const std::filesystem::path&, const std::string& part);

/// Writes the frames of AlembicWriter as a USD layer: a mesh ROOT/SHEET for each sheet, y up,
/// metres, time codes = frame numbers, velocities in m/s, primvars:crease in radians, and a primvar
/// for each CacheLayer. The pattern is primvars:pattern. The uv sets of the artist are primvars of
/// their names, the first one also primvars:st, which is the pattern where the artist has none.
/// Materials are bound, to empty ones of the same names in ROOT/materials, for the whole mesh or by
/// subsets of its faces. Guides are Points `SHEET_points` and linear BasisCurves `SHEET_folds` of
/// purpose "guide", with the primvars point_id or fold_id, birth and, at the points of a curve,
/// angle. A value that is equal in all frames is stored once. Values are written as they come, the
/// text to a temporary file at first; only their places are kept in memory. The layer is an
/// AtomicFile. The same calls write the same bytes.
class UsdWriter {
 public:
  /// Names become identifiers: characters other than ASCII letters and digits become `_`, and a
  /// name that begins with a digit gets one in front. throws Error(ErrorCode::folder) when the file
  /// cannot be created
  UsdWriter(const std::filesystem::path&, UsdEncoding, const CacheInfo&,
            const std::vector<std::string>& sheet_names, UsdLayers = UsdLayers::one);
  ~UsdWriter();

  /// Appends the next frame of a sheet. Values must be finite. throws Error(ErrorCode::folder) when
  /// the disk is full
  void add_frame(std::size_t sheet, const CacheFrame&);

  /// Writes the layers and gives the files their names; must be the last call.
  void finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace paperbake
