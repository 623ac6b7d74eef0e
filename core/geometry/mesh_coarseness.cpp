#include "core/geometry/mesh_coarseness.h"

#include "core/geometry/hinges.h"
#include "core/geometry/measure.h"

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

/// Mean of value(hinge, fold, length) over the folds, weighted by the bending energy that each of
/// them stores. fold [rad], length [m] on the pattern
template <class Value>
double mean_over_folds(const Sheet& sheet, const Value& value) {
  double stored = 0, sum = 0;
  for (const Hinge& hinge : find_hinges(sheet.triangles).hinges) {
    const double fold = dihedral_angle(sheet.x, hinge),
                 length =
                     (sheet.pattern.row(hinge.vertices[1]) - sheet.pattern.row(hinge.vertices[0]))
                         .norm();
    stored += fold * fold * length;
    sum += fold * fold * length * value(hinge, fold, length);
  }
  return stored > 0 ? sum / stored : 0;
}

}  // namespace

double mean_square_fold(const Sheet& sheet) {
  return mean_over_folds(sheet, [](const Hinge&, double fold, double) { return fold * fold; });
}

double rms_sagitta(const Sheet& sheet) {
  return std::sqrt(mean_over_folds(sheet, [&](const Hinge& hinge, double fold, double length) {
    const double area =
        pattern_area(sheet, hinge.triangles[0]) + pattern_area(sheet, hinge.triangles[1]);
    const double sagitta = area / length * fold / 8;  // the strips of a ruled mesh are so wide
    return sagitta * sagitta;
  }));
}

double sharpest_fold(const Sheet& sheet) {
  double most = 0;
  for (const Hinge& hinge : find_hinges(sheet.triangles).hinges)
    most = std::max(most, std::abs(dihedral_angle(sheet.x, hinge)));
  return most;
}

}  // namespace paperbake
