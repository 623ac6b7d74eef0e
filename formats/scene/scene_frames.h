#pragma once

#include "formats/scene/scene_nodes.h"

#include <vector>

namespace paperbake {

/// Decides the frame rate of a scene: that of the options, else of the file, else a property
/// paper_fps, else 24 with a warning.
/// throws  Error(ErrorCode::scene) for options that are no frame rate, and where two objects
///         contradict each other in paper_fps
void set_fps(SceneNodes&, const SceneOptions&);

/// Converts the times of the keys from seconds to frames and sets the ranges of the scene:
/// frame = seconds x fps, rounded to the nearest whole frame when within 0.01. The first key is
/// moved to options.start_frame, if given; else a file that has lost its start frame begins at
/// frame 1. A scene without keyed motion has the frames of its first take, else frame 1.
/// takes   that are used: their clips belong to the range
/// throws  Error(ErrorCode::scene) for an implausible length of the clip
void set_frames(SceneNodes&, const SceneOptions&, const std::vector<const Take*>& takes);

}  // namespace paperbake
