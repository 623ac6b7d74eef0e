#include "core/animation/known_handles.h"

#include "core/geometry/point_location.h"

#include <algorithm>
#include <limits>
#include <optional>

namespace paperbake {
namespace {

/// The first frame in which a handle moves the sheet; none: it never does.
std::optional<int> first_moved(const Handle& handle, int first_frame) {
  constexpr double still = 1e-4;  // [m] a tenth of what a handle may be off
  const int last = first_frame + static_cast<int>(handle.keyed.rows()) - 1;
  const int from = std::max(first_frame, handle.grab_frame);
  for (int frame = from; frame <= last && handle.held(frame); ++frame)
    if ((keyed_position(handle, frame - first_frame) - keyed_position(handle, from - first_frame))
            .norm() > still)
      return frame;
  return std::nullopt;
}

}  // namespace

std::vector<Handle> with_known_places(std::vector<Handle> handles, const Sheet& start,
                                      int first_frame) {
  const auto is_relative = [](const Handle& h) { return h.mode == HandleMode::relative; };
  if (std::none_of(handles.begin(), handles.end(), is_relative)) return handles;
  int lies_until = std::numeric_limits<int>::max();  // frame
  for (const Handle& handle : handles)
    lies_until = std::min(lies_until, first_moved(handle, first_frame).value_or(lies_until));
  const PointLocator locator(start.pattern, start.triangles);
  for (Handle& handle : handles) {
    const int grab = std::max(first_frame, handle.grab_frame);
    if (!is_relative(handle) || grab >= lies_until) continue;
    const Vector3d offset = interpolate(locator.locate(handle.pattern), start.triangles, start.x) -
                            keyed_position(handle, grab - first_frame);
    handle.keyed.rowwise() += offset.transpose();
    handle.mode = HandleMode::absolute;
  }
  return handles;
}

}  // namespace paperbake
