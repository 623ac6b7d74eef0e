#pragma once

#include "baker/caches.h"
#include "baker/plan.h"
#include "core/animate.h"
#include "core/shot_record.h"
#include "formats/certificate.h"
#include "formats/crease_map.h"

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
};

/// Takes the frames of one sheet as they are simulated and hands them on to maps and certificate. The caches of a render mesh
/// get their frames when all are known; those of the simulation mesh as they come: there a frame waits for its successor, so
/// that its velocity is the central difference of the true motion.
class SheetOutput {
 public:
  /// suffix    of file names, when there are several sheets
  /// map_stem  of the maps' names, with their folder
  /// files     what is written is added to it
  SheetOutput(const BakeSettings&, const BakePlan&, std::size_t sheet, Caches&, std::string suffix, std::filesystem::path map_stem, Certificate&,
              std::vector<std::filesystem::path>& files);

  /// returns  its line of the certificate; null when the frame is not one of those that are wanted
  const FrameRecord* take(const AnimatedFrame&);

  /// After the last frame.
  void finish();

 private:
  FrameRecord judge(const AnimatedFrame&) const;
  void record_handles(const AnimatedFrame&);
  void draw_map(const AnimatedFrame&);
  void draw_debug_picture(const AnimatedFrame&) const;
  void write_render_frames();
  MapInfo map_info(int frame) const;
  void wait(const Sheet&);
  void release_waiting(const Sheet* next);
  Points3 carried(const Sheet& other) const;

  const BakeSettings& settings_;
  const BakePlan& plan_;
  std::size_t sheet_;
  const Shot& shot_;
  Caches& caches_;
  std::string suffix_;
  std::filesystem::path map_stem_;
  Certificate& certificate_;
  std::vector<std::filesystem::path>& files_;
  std::size_t first_record_;                   // of this sheet among those of the certificate
  std::string input_hash_;
  ShotRecord record_;                          // for the render mesh
  std::size_t known_singular_ = 0;
  std::optional<CreaseMap> map_;
  int last_map_frame_ = 0;
  Sheet before_, now_;                         // one frame before the waiting one, and that
  std::optional<CacheFrame> waiting_;
};

}  // namespace paperbake
