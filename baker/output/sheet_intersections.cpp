#include "baker/output/sheet_intersections.h"

#include "baker/output/cache_judge.h"
#include "core/geometry/box_of.h"
#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"

namespace paperbake {

int SheetIntersections::add(int frame, const Sheet& simulated) {
  int count = 0;
  const Sheet sheet{{}, as_stored(simulated.x), {}, simulated.triangles, {}};
  std::vector<PlacedSheet>& placed = placed_[frame];
  const Eigen::AlignedBox3d here = box_of(sheet.x);
  for (const PlacedSheet& other : placed)
    if (here.intersects(box_of(other.x)))
      count += crossings_between(sheet, Sheet{{}, other.x, {}, other.triangles, {}});
  placed.push_back({sheet.x, sheet.triangles});
  return count;
}

}  // namespace paperbake
