#include "core/animation/collider_jam.h"

#include <cstdio>
#include <memory>
#include <vector>

namespace paperbake {

void ColliderJam::begin_frame(ColliderMotion& moving) const {
  if (is_on()) moving.from = between_;
}

void ColliderJam::hold(const ColliderMotion& moving, double followed) {
  between_ = followed == 0 ? moving.from : between(moving.from, moving.to, followed);
}

std::string ColliderJam::note(const ColliderShapes& now) const {
  char note[120];
  std::snprintf(note, sizeof note, "it is jammed: colliders have gone on by %.1f mm without it",
                1e3 * farthest_move(between_, now));
  return note;
}

void ColliderJam::archive(Serializer& a, const Colliders* colliders, int row) {
  std::vector<Points3> places;
  for (const auto& collider : between_) places.push_back(collider->mesh().x);
  a(places);
  if (!a.reads() || places.empty()) return;
  a.require(colliders && places.size() == colliders->size());
  between_ = shapes_at(*colliders, row);
  for (std::size_t c = 0; c < places.size(); ++c) {
    auto& shape = between_[c];
    a.require(places[c].rows() == shape->mesh().x.rows());
    if (places[c] != shape->mesh().x) shape = std::make_shared<const Collider>(*shape, places[c]);
  }
}

}  // namespace paperbake
