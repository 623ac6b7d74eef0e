#include "core/step2_crumple/remesh_schedule.h"

#include "core/geometry/hinges.h"
#include "core/model/serializer.h"

#include <algorithm>
#include <cmath>

namespace paperbake {

MeshFit mesh_fit(const Sheet& sheet, const BendingField& field, const Regions& regions) {
  std::vector<char> singular(sheet.pattern.rows(), 0);
  for (const SingularPoint& s : sheet.singular)
    for (int v = 0; v < sheet.pattern.rows(); ++v)
      if ((sheet.pattern.row(v).transpose() - s.pattern).norm() < 1e-9) singular[v] = 1;
  MeshFit fit;
  double off = 0, all = 0;
  for (const Hinge& hinge : find_hinges(sheet.triangles).hinges) {
    const Vector2d a = sheet.pattern.row(hinge.vertices[0]),
                   b = sheet.pattern.row(hinge.vertices[1]), middle = 0.5 * (a + b);
    const int place = regions.grid().nearest(middle);
    if (place < 0 || regions.of_place()[place] < 0) continue;
    const double theta = std::abs(fold_angle(sheet.x, hinge)), weight = theta * (b - a).norm();
    off += weight * std::abs((b - a).normalized().dot(field.at(middle).across));
    all += weight;
    if (!singular[hinge.vertices[0]] && !singular[hinge.vertices[1]])
      fit.largest_fold = std::max(fit.largest_fold, theta);
  }
  fit.misalignment = all > 0 ? off / all : 0;
  return fit;
}

bool RemeshWhen::due(const MeshFit& fit, const Moment& now, double most_fold) {
  constexpr double soon = 2 / 24.0, later = 4 / 24.0, late = 6 / 24.0;  // [s] ages of a mesh
  // rounding must not postpone what is due now
  const double time = now.seconds() + 1e-3 * now.dt;
  way_ += std::min(now.moved, 1.0);
  if (time < not_before_) return false;
  // [1/s] longer sides per second: a sheet that moves faster outgrows its mesh sooner
  constexpr double usual_speed = 0.02 * 24;
  const double age = std::max(time - last_, way_ / usual_speed);
  return (age >= soon && fit.misalignment > 0.3) ||
         (age >= later && fit.largest_fold > most_fold) || (age >= late && fit.misalignment > 0.12);
}

void RemeshWhen::archive(Archive& a) { a(last_, way_, not_before_, wait_); }

void RemeshWhen::judged(bool accepted, const Moment& now) {
  if (accepted) {
    last_ = now.seconds();
    way_ = 0;
    wait_ = shortest_wait;
    return;
  }
  wait_ = std::min(2 * wait_, 16 * shortest_wait);
  not_before_ = now.seconds() + wait_;
}

}  // namespace paperbake
