#pragma once

#include "baker/bake/bake_context.h"
#include "formats/maps/crease_map.h"

#include <cstddef>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace paperbake {

/// Draws the crease and apex maps of one sheet, with several threads while the bake goes on.
class MapRecorder {
 public:
  MapRecorder(const BakeContext&, std::size_t sheet);

  /// To be called with every simulated frame; draws the map of a frame of --map-frames.
  void consume(const AnimatedFrame&);
  /// After the last frame: draws the final map, and a picture of it for the caches. The map has no
  /// file before finish().
  void draw_final();
  /// The final map and its picture are not written after all.
  void drop_final();
  /// Waits for all maps, writes the final one and lists them; hands the picture to the caches.
  void finish();
  /// Removes the maps that were written: what they show is not baked. None must be being drawn.
  void discard();

 private:
  using Draw = std::function<void(const CreaseMap&, const MapInfo&)>;
  std::shared_future<void> start(const Draw&);
  std::string file_name(const std::string& frame) const;
  void write_map(const std::string& frame);
  MapInfo info() const;

  const BakeContext& bake_;
  std::size_t sheet_;
  CreaseMap map_;
  std::optional<int> last_frame_;  // none: no frame was simulated yet
  struct File {
    std::string name;
    std::shared_future<void> written;
    std::shared_ptr<bool> is_there;  // set by the task when the map is written
  };
  std::vector<File> files_;
  /// Bytes of a file that is not written yet.
  struct Drawing {
    std::shared_ptr<std::string> bytes;  // null: none was asked for
    std::shared_future<void> drawn;
  };
  Drawing final_, picture_;  // EXR, PNG
};

}  // namespace paperbake
