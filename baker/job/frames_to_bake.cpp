#include "baker/job/frames_to_bake.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace paperbake {

LastFrame last_frame_to_bake(const Scene& scene, MovedBy moved) {
  constexpr double after_release = 2, without_keys = 4;  // [s]
  const auto frames = [&](double seconds) {
    return std::max(1, static_cast<int>(std::lround(seconds * scene.fps)));
  };
  int release = scene.first_frame - 1;
  std::string released;
  for (const SceneSheet& sheet : scene.sheets)
    for (const Handle& handle : sheet.handles)
      if (handle.release_frame < std::numeric_limits<int>::max() &&
          handle.release_frame > release) {
        release = handle.release_frame;
        released = handle.name;
      }
  const bool has_keys = scene.last_frame > scene.first_frame;
  const int first = scene.first_frame;
  if (release >= scene.last_frame && release > first) {
    const int last = release + frames(after_release) - 1;
    return {last, fmt::format("Frames {}-{} are baked: the last handle, \"{}\", is released at "
                              "frame {}, and the keys end at {}. --frames chooses others.",
                              first, last, released, release, scene.last_frame)};
  }
  if (has_keys) return {scene.last_frame, ""};
  if (moved == MovedBy::handles)
    return {scene.last_frame,
            fmt::format("Only frame {} is baked: the scene has no keys, no gravity and no wind, so "
                        "nothing moves its sheets. --frames chooses others.",
                        first)};
  const int last = first + frames(without_keys) - 1;
  return {last, fmt::format("Frames {}-{} are baked, {:g} seconds: the scene has no keys, and "
                            "gravity or wind moves its sheets. --frames chooses others.",
                            first, last, without_keys)};
}

}  // namespace paperbake
