#pragma once

#include "baker/bake/stage_clock.h"
#include "baker/job/settings.h"
#include "core/model/shot.h"
#include "core/render/shot_record.h"

#include <cstddef>
#include <vector>

namespace paperbake {

/// A simulated sheet that is to be rendered.
struct RenderInput {
  const ShotRecord* record;
  const Shot* shot;
};

// What the mesh has vertices at. handles: at handle points alone, where no mesh can be made that
// has all singular points and creases, too
enum class MeshFeatures { all, handles };

struct RenderOptions {
  Quality quality;
  FrameSpan frames;  // of the records that are wanted
  double fps;        // [1/s]
  int threads;
  MeshFeatures features = MeshFeatures::all;
  StageClock* clock = nullptr;  // null: nobody asks for times
  // The method gives every sheet that crumples singular points. What may not be creased
  // (ShotRecord::may_be_creased) is smooth then: its mesh has sharp edges because it is coarse.
  bool smooth_without_points = false;
};

/// How many sheets have a k-th frame: the first ones.
std::size_t sheets_with_frame(const std::vector<RenderInput>&, std::size_t k);

/// Whether the k-th frame of all sheets has the shape of the one before.
bool simulated_alike(const std::vector<RenderInput>&, std::size_t k);

/// How many frames the longest record has.
std::size_t frames_of_any(const std::vector<RenderInput>&);

/// Groups sheets that ever come so near each other that their bounding boxes overlap; every sheet
/// is in one group, alone or not. Groups and the indices in them are in ascending order.
std::vector<std::vector<std::size_t>> groups_near_each_other(const std::vector<const ShotRecord*>&);

}  // namespace paperbake
