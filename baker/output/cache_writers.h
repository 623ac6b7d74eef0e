#pragma once

#include "baker/job/plan.h"
#include "baker/output/preview.h"
#include "baker/output/report.h"
#include "baker/output/write_failures.h"
#include "formats/cache/alembic_cache.h"
#include "formats/cache/pc2_cache.h"
#include "formats/cache/usd_cache.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace paperbake {

/// The files of a bake that hold the moving meshes frame by frame: .abc and .usda for all sheets, a
/// .pc2 with its .rest.obj for each, a preview picture, and what report.html shows of them. Which
/// of them there are, --formats says. One that fails ends there, and the others go on; what there
/// is of it is kept where its format allows.
class CacheWriters {
 public:
  /// suffixes  of file names, one a sheet
  /// throws Error(Fault::folder) when a file cannot be made
  CacheWriters(const BakeSettings&, const BakePlan&, const std::filesystem::path& folder,
               const std::vector<std::string>& suffixes, WriteFailures&);

  bool any() const { return alembic_ || usd_ || !pc2_.empty() || report_ || preview_; }
  bool wants_layers() const { return usd_ != nullptr; }

  /// Those of the written frames that some file shows.
  FrameSpan shown_frames() const;

  /// Appends the next frame of a sheet to each of them.
  /// returns  the key of its positions in the .abc; empty when it is not there
  std::string add_frame(std::size_t sheet, int frame, const CacheFrame&);

  struct Finished {
    std::vector<std::filesystem::path> files;  // in the order an artist looks for them
    std::vector<std::size_t> in_alembic;       // frames of each sheet
  };
  /// Gives the files their names; the last call but for the report, which is written by others.
  /// frames   of each sheet that there should be
  /// handles  of all frames, for the preview
  Finished finish(const std::vector<std::size_t>& frames, const std::vector<HandleRecord>& handles);
  Report* report() { return report_ ? &*report_ : nullptr; }

 private:
  std::string name(const std::string& ending) const { return plan_.name + ending; }
  void keep(const std::string& file, const std::vector<std::size_t>& wanted,
            const std::function<std::vector<std::size_t>()>& finish, Finished&);

  const BakePlan& plan_;
  std::filesystem::path folder_;
  std::vector<std::string> suffixes_;
  WriteFailures& failures_;
  std::unique_ptr<AlembicWriter> alembic_;
  std::unique_ptr<UsdWriter> usd_;
  std::vector<std::unique_ptr<Pc2Writer>> pc2_;
  std::optional<Report> report_;
  std::optional<Preview> preview_;
};

}  // namespace paperbake
