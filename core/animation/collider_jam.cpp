#include "core/animation/collider_jam.h"

#include "core/model/formatted.h"

namespace paperbake {

void ColliderJam::begin_frame(ColliderMotion& moving) const {
  if (is_on()) moving.from = between_;
}

void ColliderJam::hold(const ColliderMotion& moving, double followed) {
  between_ = followed == 0 ? moving.from : between(moving.from, moving.to, followed);
}

std::string ColliderJam::note(const ColliderShapes& now) const {
  return formatted("it is jammed: colliders have gone on by %.1f mm without it",
                   1e3 * farthest_move(between_, now));
}

void ColliderJam::archive(Serializer& a, const Colliders* colliders) {
  bool on = is_on();
  a(on);
  a.require(!on || colliders);
  if (!on) between_.clear();
  if (on) archive_shapes(a, between_, *colliders);
}

}  // namespace paperbake
