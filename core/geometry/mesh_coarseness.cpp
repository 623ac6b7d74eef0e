#include "core/geometry/mesh_coarseness.h"

#include "core/geometry/hinges.h"

namespace paperbake {

double mean_square_fold(const Sheet& sheet) {
  double stored = 0, sum = 0;
  for (const Hinge& hinge : find_hinges(sheet.triangles).hinges) {
    const double fold = dihedral_angle(sheet.x, hinge),
                 length =
                     (sheet.pattern.row(hinge.vertices[1]) - sheet.pattern.row(hinge.vertices[0]))
                         .norm();
    stored += fold * fold * length;
    sum += fold * fold * fold * fold * length;
  }
  return stored > 0 ? sum / stored : 0;
}

}  // namespace paperbake
