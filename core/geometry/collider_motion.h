#pragma once

#include "core/geometry/collider.h"

namespace paperbake {

class Serializer;

/// The colliders in one frame; before the first and after the last key they stand still.
/// row  frame - first frame of the scene
ColliderShapes shapes_at(const Colliders&, int row);
/// The colliders on the way from one shape to another: vertices go straight.
/// share  [1] of the way
ColliderShapes between(const ColliderShapes&, const ColliderShapes&, double share = 0.5);
/// Writes where the vertices of the shapes are, or reads it; a collider that is where it was in the
/// first frame takes no bytes.
void archive_shapes(Serializer&, ColliderShapes&, const Colliders&);
/// The colliders at the beginning and at the end of a step. Empty if there are none. A collider
/// that does not move is one and the same object in both.
struct ColliderMotion {
  ColliderShapes from, to;
};
/// The motion from the row before to this one.
ColliderMotion motion_to(const Colliders&, int row);
/// The same, of which the beginning is there already. before  shapes_at(row - 1)
ColliderMotion motion_to(const Colliders&, int row, ColliderShapes before);
/// Largest displacement of any vertex of a collider. [m]
double farthest_move(const Collider& from, const Collider& to);
/// The same for all. [m]
double farthest_move(const ColliderShapes& from, const ColliderShapes& to);
/// The same from one row to another. [m]
double farthest_move(const Colliders&, int from, int to);
/// The same from the row before to this one. [m]
inline double farthest_move(const Colliders& all, int row) {
  return farthest_move(all, row - 1, row);
}

/// Where a point gets to that a moving collider carries along: it keeps its place beside the point
/// of the surface that is nearest to it, and turns with the triangle there. For a collider that
/// moves rigidly this is the rigid motion. A point that is farther from the surface than `within`
/// [m], which is farthest_move() and a clearance, stays where it is.
/// side  as in Collider::nearest
Vector3d carried(const Collider& from, const Collider& to, const Vector3d& p, double within,
                 int side);

/// Moves points of a sheet that are inside a collider, or closer to it than `clearance`, out of it.
/// known      |V|x3 [m] points near x that are on the allowed side of open meshes: x itself, or the
///            surface that x smooths
/// clearance  [m]
/// x          |V|x3 [m] the points, changed in place
/// returns    [m] greatest depth of a point that was inside; 0 when none was
double push_out(const ColliderShapes&, const Points3& known, double clearance, Points3& x);

}  // namespace paperbake
