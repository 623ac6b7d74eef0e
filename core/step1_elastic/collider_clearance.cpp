#include "core/step1_elastic/collider_clearance.h"

#include "core/step1_elastic/contact/collider_contact.h"

#include <utility>

namespace paperbake {

ColliderClearance::ColliderClearance(std::shared_ptr<const Colliders> colliders,
                                     const ColliderShapes& shapes, const Triangles& triangles,
                                     const Points3& outside)
    : contact_(std::make_unique<ColliderContact>(std::move(colliders), triangles,
                                                 static_cast<int>(outside.rows()))) {
  contact_->begin(outside, {shapes, shapes}, {});
  begins_inside_ = contact_->cut_by_open(outside);
}

ColliderClearance::~ColliderClearance() = default;

void ColliderClearance::push_out(const std::vector<char>& held, double clearance, Points3& x) {
  contact_->push_out(held, clearance, x);
}

}  // namespace paperbake
