#include "core/crease_network.h"

#include "core/hinges.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace paperbake {

CreaseNetwork crease_network(const Sheet& sheet) {
  constexpr double folded = 0.35;  // [rad]
  CreaseNetwork network;
  std::vector<int> creases_at(sheet.pattern.rows(), 0);
  for (const Hinge& hinge : find_hinges(sheet.triangles).hinges) {
    if (std::abs(fold_angle(sheet.x, hinge)) < folded) continue;
    for (int k : {0, 1}) ++creases_at[hinge.vertices[k]];
    network.length += (sheet.pattern.row(hinge.vertices[1]) - sheet.pattern.row(hinge.vertices[0])).norm();
  }
  for (int v = 0; v < sheet.pattern.rows(); ++v) {
    const bool singular = std::any_of(sheet.singular.begin(), sheet.singular.end(),
                                      [&](const SingularPoint& s) { return (s.pattern.transpose() - sheet.pattern.row(v)).norm() < 1e-9; });
    if (creases_at[v] != 2 || singular) network.count += 0.5 * creases_at[v];
  }
  return network;
}

}  // namespace paperbake
