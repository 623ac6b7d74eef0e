#pragma once

#include "baker/bake/bake_context.h"
#include "formats/maps/crease_map.h"

#include <cstddef>
#include <optional>
#include <string>

namespace paperbake {

/// Draws the crease and apex maps of one sheet.
class MapRecorder {
 public:
  MapRecorder(const BakeContext&, std::size_t sheet);

  /// To be called with every simulated frame; writes the map of a frame of --map-frames.
  void consume(const AnimatedFrame&);
  /// After the last frame: writes the final map and hands a picture of it to the caches.
  void finish();

 private:
  void write_map(const std::string& frame);
  MapInfo info() const;

  const BakeContext& bake_;
  std::size_t sheet_;
  CreaseMap map_;
  std::optional<int> last_frame_;  // none: no frame was simulated yet
};

}  // namespace paperbake
