#pragma once

#include "core/geometry/collider.h"
#include "core/model/handles.h"

#include <memory>
#include <vector>

namespace paperbake {

/// Turns triangles that face the other way than the neighbours with which they share an edge: in
/// each part that hangs together by edges of two triangles, most stay as they are. A surface that
/// has only one side keeps what cannot be turned. Returns how many were turned.
int turn_to_neighbours(Triangles&);

/// Decides for closed meshes whether the sheet stays outside or inside, where the mesh leaves it
/// open: inside when all of the sheet begins there.
/// Orients open meshes so that their front is on the side where most of the sheet is at the start.
/// Where the sheet lies in the surface, or beside it, the keyed positions of the handles decide.
/// Where these do not either, it is the side on which all of the sheet would be if the mesh went on
/// beyond its border; and where the sheet would be on both, the front is turned upwards.
/// x      |V|x3 [m] vertices of the sheet at the start
/// keyed  |K|x3 [m] positions to which handles go
void face_the_sheet(std::vector<ColliderMesh>&, const Points3& x, const Points3& keyed);

/// The colliders of a scene, oriented by face_the_sheet for a sheet at x with these handles; null
/// when there are none.
std::shared_ptr<const Colliders> facing_colliders(std::vector<ColliderMesh>, const Points3& x,
                                                  const std::vector<Handle>&);

}  // namespace paperbake
