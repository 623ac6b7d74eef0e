#include "core/step2_crumple/remesh_schedule.h"

#include "core/geometry/hinges.h"
#include "core/geometry/singular_vertices.h"
#include "core/model/serializer.h"

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

// Three rules call for a new mesh; the less urgent their reason, the older the mesh must be. [s]
constexpr double soon = 2 / 24.0, later = 4 / 24.0, late = 6 / 24.0;
// [1] misalignment of a mesh that holds the sheet back, and of one that only follows it badly
constexpr double crosses_rulings = 0.3, strays_from_rulings = 0.12;
// [1/s] longer sides per second: a sheet that moves faster outgrows its mesh sooner
constexpr double reference_speed = 0.02 * 24;
constexpr double rounding = 1e-3;       // [frames] must not postpone what is due now
constexpr double largest_motion = 1;    // [longer sides] that one frame counts for
constexpr double longest_backoff = 16;  // [1] times the wait after the first rejection

}  // namespace

MeshFit mesh_fit(const Sheet& sheet, const BendingField& field, const Regions& regions) {
  const std::vector<char> singular = singular_vertices(sheet);
  MeshFit fit;
  double off = 0, all = 0;
  for (const Hinge& hinge : find_hinges(sheet.triangles).hinges) {
    const Vector2d a = sheet.pattern.row(hinge.vertices[0]),
                   b = sheet.pattern.row(hinge.vertices[1]), middle = 0.5 * (a + b);
    const int place = regions.grid().nearest(middle);
    if (place < 0 || regions.region_of_sample()[place] < 0) continue;
    const double theta = std::abs(dihedral_angle(sheet.x, hinge)), weight = theta * (b - a).norm();
    off += weight * std::abs((b - a).normalized().dot(field.at(middle).across));
    all += weight;
    if (!singular[hinge.vertices[0]] && !singular[hinge.vertices[1]])
      fit.largest_fold = std::max(fit.largest_fold, theta);
  }
  fit.misalignment = all > 0 ? off / all : 0;
  return fit;
}

bool RemeshSchedule::due(const MeshFit& fit, const FrameTime& now, double max_fold) {
  const double time = now.seconds() + rounding * now.dt;
  accumulated_motion_ += std::min(now.moved, largest_motion);
  if (time < not_before_) return false;
  const double age = std::max(time - last_, accumulated_motion_ / reference_speed);
  return (age >= soon && fit.misalignment > crosses_rulings) ||
         (age >= later && fit.largest_fold > max_fold) ||
         (age >= late && fit.misalignment > strays_from_rulings);
}

void RemeshSchedule::archive(Serializer& a) {
  a(last_, accumulated_motion_, not_before_, retry_delay_);
}

void RemeshSchedule::on_proposal_result(bool accepted, const FrameTime& now) {
  if (accepted) {
    last_ = now.seconds();
    accumulated_motion_ = 0;
    retry_delay_ = min_retry_delay;
    return;
  }
  retry_delay_ = std::min(2 * retry_delay_, longest_backoff * min_retry_delay);
  not_before_ = now.seconds() + retry_delay_;
}

}  // namespace paperbake
