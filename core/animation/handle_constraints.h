#pragma once

#include "core/animation/animate.h"
#include "core/hands/handle_feasibility.h"
#include "core/model/serializer.h"

#include <optional>
#include <vector>

namespace paperbake {

/// The handles of a shot as position constraints: where they are asked to be, and which vertices
/// they hold.
class HandleConstraints {
 public:
  /// vertices  vertex of each handle
  HandleConstraints(const Shot&, std::vector<int> vertices, int first_frame);

  /// A relative handle starts from where the sheet is at its grab frame, after that frame was
  /// simulated without it.
  void bind_relative_handles(const Points3& x, int frame);

  /// Held vertices and their targets at a frame. Targets that paper cannot reach are drawn
  /// together.
  PositionConstraints held(int frame) const;

  std::vector<HandleFrame> report(const Points3& x, int frame) const;

  void archive(Serializer&);

 private:
  bool is_active(std::size_t h, int frame) const;
  Vector3d keyed(std::size_t h, int frame) const;

  const std::vector<Handle>& handles_;
  std::vector<int> vertex_;
  int first_frame_;
  double jammed_beyond_;  // [m] a hard handle farther from its target than this is jammed
  double grip_;           // [1] grip_on the paper
  HandleFeasibility feasibility_;
  // [m] what is added to the keyed position of a relative handle; none: it is not bound yet
  std::vector<std::optional<Vector3d>> offset_;
};

}  // namespace paperbake
