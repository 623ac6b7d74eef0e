#include "core/hands/known_handles.h"

#include "core/geometry/point_location.h"

#include <algorithm>
#include <limits>
#include <optional>

namespace paperbake {
namespace {

/// The first frame in which a handle moves the sheet; none: it never does.
/// lying  [m] where the point that it holds is until then
std::optional<int> first_moved(const Handle& handle, const Vector3d& lying, int first_frame) {
  constexpr double still = 1e-4;  // [m] a tenth of what a handle may be off
  const int last = first_frame + static_cast<int>(handle.keyed.rows()) - 1;
  const int from = std::max(first_frame, handle.grab_frame);
  const Vector3d begins =
      handle.mode == HandleMode::absolute ? lying : keyed_position(handle, from - first_frame);
  for (int frame = from; frame <= last && handle.held(frame); ++frame)
    if ((keyed_position(handle, frame - first_frame) - begins).norm() > still) return frame;
  return std::nullopt;
}

}  // namespace

std::vector<Handle> with_known_places(std::vector<Handle> handles, const Sheet& start,
                                      int first_frame) {
  const auto is_relative = [](const Handle& h) { return h.mode == HandleMode::relative; };
  if (std::none_of(handles.begin(), handles.end(), is_relative)) return handles;
  const PointLocator locator(start.pattern, start.triangles);
  const auto lying = [&](const Handle& handle) {
    return interpolate(locator.locate(handle.pattern), start.triangles, start.x);
  };
  int lies_until = std::numeric_limits<int>::max();  // frame
  for (const Handle& handle : handles)
    lies_until =
        std::min(lies_until, first_moved(handle, lying(handle), first_frame).value_or(lies_until));
  for (Handle& handle : handles) {
    const int grab = std::max(first_frame, handle.grab_frame);
    if (!is_relative(handle) || grab >= lies_until) continue;
    const Vector3d offset = lying(handle) - keyed_position(handle, grab - first_frame);
    handle.keyed.rowwise() += offset.transpose();
    handle.mode = HandleMode::absolute;
  }
  return handles;
}

}  // namespace paperbake
