#pragma once

#include "core/animation/animate.h"
#include "core/animation/handle_feasibility.h"
#include "core/model/serializer.h"

#include <optional>
#include <vector>

namespace paperbake {

/// Handles of the shot as the loop needs them: where they are asked to be, and which vertices that
/// holds.
class HandleConstraints {
 public:
  /// vertices  of each handle
  HandleConstraints(const Shot&, std::vector<int> vertices, int first_frame);

  /// A relative handle begins where the sheet is at its grab frame, after that frame was simulated
  /// without it.
  void bind_relative_handles(const Points3& x, int frame);

  /// Held vertices and their targets at a frame, drawn together where paper cannot reach.
  PositionConstraints held(int frame) const;

  std::vector<HandleFrame> report(const Points3& x, int frame) const;

  void archive(Serializer&);

 private:
  bool is_active(std::size_t h, int frame) const;
  Vector3d keyed(std::size_t h, int frame) const;

  const std::vector<Handle>& handles_;
  const Colliders* colliders_;  // null: there are none
  std::vector<int> vertex_;
  int first_frame_;
  double exact_;  // [m] a handle that is farther off is not met
  HandleFeasibility feasibility_;
  // [m] what is added to a relative handle's own position
  std::vector<std::optional<Vector3d>> offset_;
};

}  // namespace paperbake
