#pragma once

#include "core/model/frame_statistics.h"
#include "core/model/plastic_grid.h"
#include "core/model/sheet.h"

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace paperbake {

/// How a method divides the sheet, for drawing it.
struct BentParts {
  std::vector<std::pair<Vector2d, Vector2d>> rulings;  // [m] segments on the pattern
  // |T| index of the curved region of each triangle, -1: flat; empty: there are no regions
  std::vector<int> region;
};

/// A handle at one frame.
struct HandleFrame {
  // soft: a spring pulls, and is meant to lag; jammed: the paper does not follow a hard handle
  enum State : int { free, held, soft, jammed } state = free;
  // [m] where the handle is keyed to be; for a relative handle: grab position + motion since then
  Vector3d keyed{0, 0, 0};
  Vector3d at{0, 0, 0};  // [m] where its point of the sheet is

  /// How far it is from its key, where it should be there. [m]
  double error() const { return state == held || state == jammed ? (at - keyed).norm() : 0; }
};

/// One simulated frame of a sheet.
struct AnimatedFrame {
  int frame = 0;
  // index of the sheet among those that are animated together
  std::size_t sheet_index = 0;
  const Sheet* sheet = nullptr;      // belongs to animate; copy what is to be kept
  std::vector<HandleFrame> handles;  // as in Shot::handles
  FrameStatistics statistics;
  const PlasticGrid* plastic_grid = nullptr;  // plastic state; belongs to animate
  // |V|x3 [1/m] plastic curvature Sxx, Sxy, Syy at the vertices of the sheet; empty if not asked
  // for
  Points3 plastic_curvature;
  BentParts parts;  // rulings and curved regions, if the method has any
  // |V|x3 [m] the sheet of the frame before, at the time of that frame, on the mesh of this one;
  // empty if it is the mesh that it had, or if nothing is known
  Points3 carried;
  std::string note;
  // the last frame whose keys it depends on: itself, or a later one where it has looked ahead
  int keys_until = 0;
  // Everything that the next frame depends on, as bytes. To be called before on_frame returns, for
  // the last sheet of the frame.
  std::function<std::string()> state;
};

/// Adds a note to those of a frame, which are separated by semicolons; an empty one is none.
inline void append_note(std::string& notes, const std::string& note) {
  if (note.empty()) return;
  if (!notes.empty()) notes += "; ";
  notes += note;
}

}  // namespace paperbake
