#pragma once

#include "baker/bake/certificate_recorder.h"
#include "baker/bake/map_recorder.h"
#include "baker/bake/simulation_cache.h"
#include "baker/output/crease_attributes.h"
#include "baker/output/sheet_guides.h"
#include "core/render/shot_record.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace paperbake {

/// First stage of a bake, for one sheet: takes its frames as they are simulated. A frame is in the
/// certificate before anything is written of it. Frames that are to be rendered are recorded; those
/// of a simulation mesh go to the caches right away. What cannot be written is recorded as a
/// failure and does not end the bake.
class SheetRecorder {
 public:
  /// bake  must outlive this
  SheetRecorder(const BakeContext& bake, std::size_t sheet);

  /// To be called with every simulated frame, in order.
  void consume(const AnimatedFrame&);
  /// After the last frame: hands on what was deferred.
  void finish_simulation();
  /// After that: with several threads it is drawn while the sheet is rendered.
  void draw_final_map();
  /// After rendering: it is not written after all.
  void drop_final_map();
  /// At the end: waits for the maps.
  void finish();
  /// Instead of all that: removes the maps (MapRecorder::discard).
  void discard();

  /// The frames to be rendered; empty if simulated meshes are cached, or nothing is.
  const ShotRecord& record() const { return record_; }
  /// Crease attributes of the k-th recorded frame at points of the pattern; k may only grow. Empty
  /// if no format stores them.
  std::vector<CacheLayer> crease_attributes(std::size_t k, const Points2& pattern);
  /// Singular points and folds on a rendered mesh; nothing unless they are asked for.
  std::optional<CacheGuides> guides(int frame, const CacheFrame& mesh);
  /// The k-th recorded frame as it was simulated.
  CacheProxy simulated(std::size_t k) const;

 private:
  void draw_debug_picture(const AnimatedFrame&);

  const BakeContext& bake_;
  std::size_t sheet_;
  CertificateRecorder certificate_;
  bool renders_;  // frames are recorded, to be rendered
  ShotRecord record_;
  std::optional<CreaseAttributes> attributes_;
  std::optional<SheetGuides> guides_;
  std::optional<SimulationCache> simulation_cache_;
  std::optional<MapRecorder> maps_;
  Sheet last_;  // sheet of the last frame
};

}  // namespace paperbake
