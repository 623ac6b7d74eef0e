#pragma once

#include "core/render/shot_record.h"

#include <cstddef>
#include <vector>

namespace paperbake {

/// How a frame takes part in a change of mesh.
struct ChangeShare {
  std::size_t frame;  // index in ShotRecord::frames() of the first frame on the new mesh
  // [1] the displacement by the change that is to be added to the sheet: more than 0 before the
  // change, less than 0 after it
  double share;
};

/// The mesh of a coarse sheet changes between two frames, and the sheet is elsewhere on the new one
/// at the same time: by d(p) = x_new(p) - x_old(p), which RecordedFrame::carried tells. Nothing has
/// moved there, and the sheet must not jump. So d is spread over the frames before and after: frame
/// g is shown at x(g) + s(g) d before the change and at x(g) - (1 - s(g)) d after it, where
///
///   s(t) = t^3 (10 - 15 t + 6 t^2)
///
/// goes with two continuous derivatives from 0 to 1 within 2 * half of the change.
/// half     [frames] frames before and after the change that have a part in it. There are fewer
///          where the sheet rests, other handles hold it, or the shot begins or ends: a sheet at
///          rest is not moved
/// k        index in ShotRecord::frames()
/// returns  in order
/// source   [Bollo 2018], who blends after the change alone; here both sides are known
std::vector<ChangeShare> mesh_changes_near(const ShotRecord&, std::size_t k, int half);

/// A displacement of a sheet as its triangles see it, each at its corners. So it can be added to
/// the sheet after this has turned or bent: a sheet that turns as a whole keeps its lengths.
/// x, displacement  |V|x3 [m]
/// returns          3|T|x3 [m] row 3 t + i: at corner i of triangle t, along its first edge, across
///                  that within its plane, and along its normal
Points3 seen_by_triangles(const Triangles&, const Points3& x, const Points3& displacement);

/// The displacement of a sheet that is at x now. A vertex takes the mean of its triangles, by area.
/// x     |V|x3 [m]
/// seen  3|T|x3 [m]
Points3 seen_from_outside(const Triangles&, const Points3& x, const Points3& seen);

}  // namespace paperbake
