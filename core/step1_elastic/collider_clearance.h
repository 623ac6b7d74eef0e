#pragma once

#include "core/geometry/collider_motion.h"
#include "core/model/sheet.h"

#include <memory>
#include <vector>

namespace paperbake {

class ColliderContact;

/// Pushes a mesh out of colliders without a solver: one that is derived from a simulated mesh and
/// stands out from it, as the curved surface does from the flat triangles that rest on a collider.
class ColliderClearance {
 public:
  /// shapes   the colliders as they are
  /// outside  |V|x3 [m] positions outside of them, near those that are to be pushed out
  ColliderClearance(std::shared_ptr<const Colliders>, const ColliderShapes& shapes,
                    const Triangles&, const Points3& outside);
  ~ColliderClearance();

  /// [m] How deep it has been cut by open colliders where it begins: it has been jammed there.
  double begins_inside() const { return begins_inside_; }

  /// Moves the corners of every vertex, edge and triangle that is inside a collider, or closer to
  /// it than `clearance`, each by its share of the way out. One pass: what is pushed out may be
  /// pushed in elsewhere.
  /// held       |V| vertices that stay. The rest of an edge or a triangle makes up for them inside
  ///            a collider, but goes no farther than `clearance` outside of it.
  /// clearance  [m] less than collider_dhat
  void push_out(const std::vector<char>& held, double clearance, Points3& x);

 private:
  std::unique_ptr<ColliderContact> contact_;
  double begins_inside_;
};

}  // namespace paperbake
