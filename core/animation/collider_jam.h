#pragma once

#include "core/geometry/collider_motion.h"
#include "core/model/serializer.h"

#include <string>

namespace paperbake {

/// Where the colliders of a sheet were when they jammed it: the sheet has not followed them since.
class ColliderJam {
 public:
  bool is_on() const { return !between_.empty(); }

  /// Lets the colliders of a new frame begin where they jammed the sheet.
  void begin_frame(ColliderMotion&) const;
  /// The sheet has followed its colliders through a share [1] of the frame and stays behind there.
  void hold(const ColliderMotion&, double followed);
  /// The sheet follows its colliders again.
  void release() { between_.clear(); }

  /// A sentence for the frame: how far the colliders have gone on without the sheet.
  std::string note(const ColliderShapes& now) const;

  /// colliders  of the shot; null: there are none
  void archive(Serializer&, const Colliders* colliders);

 private:
  ColliderShapes between_;  // empty: the sheet is not jammed
};

}  // namespace paperbake
