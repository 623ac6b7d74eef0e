#pragma once

#include "baker/plan.h"
#include "baker/report.h"
#include "formats/alembic_cache.h"
#include "formats/pc2_cache.h"
#include "formats/usd_cache.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace paperbake {

/// The files of a bake that hold the moving meshes frame by frame: .abc and .usda for all sheets, a .pc2 with its .rest.obj for
/// each, and what report.html shows of them. Which of them there are, --formats says.
class Caches {
 public:
  /// suffixes  of file names, one a sheet
  /// throws Error(Fault::folder) when a file cannot be made
  Caches(const BakeSettings&, const BakePlan&, const std::filesystem::path& folder, const std::vector<std::string>& suffixes);

  bool any() const { return alembic_ || usd_ || !pc2_.empty() || report_; }

  /// Appends the next frame of a sheet to each of them.
  /// returns  the key of its positions in the .abc; empty without one
  std::string add_frame(std::size_t sheet, const CacheFrame&);

  /// Gives the files their names, and returns these; the last call but for the report, which is written by others.
  std::vector<std::filesystem::path> finish();
  Report* report() { return report_ ? &*report_ : nullptr; }

 private:
  const BakePlan& plan_;
  std::vector<std::filesystem::path> files_;
  std::unique_ptr<AlembicWriter> alembic_;
  std::unique_ptr<UsdWriter> usd_;
  std::vector<std::unique_ptr<Pc2Writer>> pc2_;
  std::optional<Report> report_;
};

}  // namespace paperbake
