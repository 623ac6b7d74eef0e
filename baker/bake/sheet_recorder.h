#pragma once

#include "baker/bake/render_pass.h"
#include "baker/job/plan.h"
#include "baker/output/cache_writers.h"
#include "baker/output/crease_attributes.h"
#include "baker/output/progress.h"
#include "baker/output/sheet_intersections.h"
#include "core/animation/animate.h"
#include "core/render/shot_record.h"
#include "formats/files/certificate.h"
#include "formats/maps/crease_map.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace paperbake {

/// Everything the shot leaves behind; shared by its sheets.
struct Certificate {
  std::vector<FrameRecord> frames;
  std::vector<HandleRecord> handles;
  std::vector<SingularRecord> singular;
  double crease_length = 0;          // [m] of the last frames of all sheets
  SheetIntersections intersections;  // of scenes with several
};

/// The files of a bake; shared by its sheets.
struct BakeFiles {
  std::filesystem::path folder;
  // pictures: of --debug-pictures, which are no result
  std::vector<std::filesystem::path> written, pictures;
  WriteFailures failures;  // by their names in the folder
};

/// Takes the frames of one sheet as they are simulated, among those of others, and hands them on to
/// certificate, maps and caches. The caches of a render mesh get their frames when all are known;
/// those of the simulation mesh as they come: there a frame waits for its successor, so that its
/// velocity is the central difference of the true motion. A frame is in the certificate before
/// anything is written of it, and what cannot be written is a loss, never the end of the bake.
class SheetRecorder {
 public:
  /// suffix  of file names, when there are several sheets
  SheetRecorder(const BakeSettings&, const BakePlan&, std::size_t sheet, CacheWriters&,
                std::string suffix, Certificate&, BakeFiles&, Progress&);

  void consume(const AnimatedFrame&);

  /// After the last frame: what there is to render; nothing where simulated meshes are cached, or
  /// none.
  std::optional<RenderInput> render_input();
  /// After they were rendered.
  void finish();

 private:
  FrameRecord measure(const AnimatedFrame&) const;
  void count_intersections(const Sheet&, FrameRecord&);
  void record_handles(const AnimatedFrame&);
  void draw_map(const AnimatedFrame&);
  void draw_debug_picture(const AnimatedFrame&);
  void write_map(const std::string& frame);
  MapInfo map_info() const;
  void defer(const Sheet&);
  void flush_deferred(const Sheet* next);
  Points3 resample(const Sheet& other) const;

  const BakeSettings& settings_;
  const BakePlan& plan_;
  std::size_t sheet_;
  const Shot& shot_;
  CacheWriters& caches_;
  std::string suffix_;
  Certificate& certificate_;
  BakeFiles& files_;
  Progress& progress_;
  std::string input_hash_;
  ShotRecord record_;                       // for the render mesh
  std::optional<CreaseAttributes> damage_;  // on it
  std::size_t known_singular_ = 0;
  std::optional<CreaseMap> map_;
  int last_map_frame_ = 0;
  Sheet before_, now_;  // one frame before the waiting one, and that
  std::optional<CacheFrame> deferred_;
  // line of the certificate from which the next that is rendered is looked for
  std::size_t rendered_ = 0;
  std::size_t deferred_record_ = 0;  // its line of the certificate
};

}  // namespace paperbake
