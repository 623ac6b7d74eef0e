#pragma once

#include "formats/scene/scene_file.h"

#include <string>

namespace paperbake {

/// Whether anything but handles moves the sheets of a scene.
enum class MovedBy { handles, gravity_or_wind };

/// The last frame of a scene that is worth baking, where its keys do not say.
struct LastFrame {
  int frame;
  std::string why;  // a sentence; empty: it is that of the last key
};

/// The last frame to bake unless --frames says another: that of the last key; two seconds after the
/// last release where that is not before it; and four seconds from the first frame on in a scene
/// without keys whose sheets fall or are blown.
LastFrame last_frame_to_bake(const Scene&, MovedBy);

}  // namespace paperbake
