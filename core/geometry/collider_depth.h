#pragma once

#include "core/geometry/collider.h"

#include <cstddef>
#include <memory>
#include <vector>

namespace paperbake {

// [m] A depth that ColliderDepth measures may be wrong by so much, or by 1 % if that is more; one
// of JudgedColliders by a twentieth more.
inline constexpr double depth_exact_to = 2e-6;

/// The deepest point of a surface inside a collider.
struct Penetration {
  double depth = 0;   // [m] its distance from the surface of the collider; 0: none is inside
  int triangle = -1;  // of the surface
  Vector3d weights{0, 0, 0};  // [1] barycentric, in that triangle
};

/// Measures how deep a surface lies inside a mesh, at any point of its triangles and to any
/// depth. It judges results, so it shares no code with the contact of step 1: it asks CGAL for
/// nearest points and intersections, and decides by itself what is inside.
///
/// A closed part of the mesh is a solid: depth(p) is the distance of an inner point from its
/// surface. The largest over a triangle is found by branch and bound. With the distances to a few
/// faces, which are convex functions and so lie below their interpolants,
///
///   max_p depth(p) <= max_p min_F l_F(p),   l_F linear with the values at the corners,
///
/// a linear programme with three corners; for a convex solid l_F is the distance from the plane of
/// F and the bound is attained. The result is exact to 2 um or 1 %, whichever is more.
///
/// A closed part that holds the paper (PaperSide::inside) is a solid with a hollow: depth(p) is the
/// distance of an outer point.
///
/// An open part has no inside. There depth is how far the surface reaches behind its front from
/// where it passes through it, but no more than how far from the border that is at most: so far
/// paper that hangs over the border would have to be lifted. What has come round the border and
/// passes through nowhere is not inside.
class ColliderDepth {
 public:
  /// The faces of an open part are seen from the front counter-clockwise.
  explicit ColliderDepth(const ColliderMesh&);
  ~ColliderDepth();
  ColliderDepth(ColliderDepth&&) noexcept;

  /// x  |V|x3 [m]
  Penetration deepest(const Points3& x, const Triangles&) const;

 private:
  class Part;
  std::vector<std::unique_ptr<Part>> parts_;
};

/// The same for all colliders of a scene.
struct ColliderPenetration : Penetration {
  std::size_t collider = 0;
};

}  // namespace paperbake
