#pragma once

#include "core/geometry/hinges.h"
#include "core/step1_elastic/position_constraints.h"

#include <optional>
#include <vector>

namespace paperbake {

/// The panels of a sheet: its parts between the edges along which it is folded. In a fold they move
/// nearly as rigid plates, while everything that is smooth across the fold bends them.
class Panels {
 public:
  /// pattern  |V|x2 [m]
  /// folded   for each hinge, whether the sheet is folded along it
  Panels(const Points2& pattern, const Triangles&, const Hinges&, const std::vector<bool>& folded);

  /// Where the sheet is when its constrained vertices have moved to their targets, and each panel
  /// has moved rigidly. A panel goes with those of its vertices whose places are known, if these
  /// are not all in one line of the pattern: first with constrained vertices, then also with the
  /// folds that it shares with panels that have moved. Two neighbours that turn about folds which
  /// meet stay together at the fold between them: it goes where both can take it. What is left goes
  /// with a neighbour. A vertex on a fold goes to the mean of the places that its panels would take
  /// it to.
  /// x        |V|x3 [m] present positions
  /// pressed  [rad] for each hinge, the angle that is asked of it, or 0: to which side it may bulge
  /// returns  |V|x3 [m]; none: there is one panel only, or constraints hold none of them
  std::optional<Points3> moved(const Points3& x, const PositionConstraints& hard,
                               const std::vector<double>& pressed) const;

  /// The same from the flat pattern: the panels then have no bends. Its folds have no angle, so no
  /// panel can go with a neighbour.
  /// returns  |V|x3 [m]; none: constraints do not hold all panels, or there is only one
  std::optional<Points3> moved_from_pattern(const PositionConstraints& hard,
                                            const std::vector<double>& pressed) const;

  /// The constraints half way to their targets. Those of a panel that they hold go round the axis
  /// about which it turns: half way along the chord they would be nearer to each other than the
  /// paper between them is long, and it would buckle. All others go along the chord.
  PositionConstraints half_way(const Points3& x, PositionConstraints) const;

 private:
  struct Fold {
    int left, right;  // panels
    int hinge;
  };
  class Motion;

  std::vector<std::vector<int>> vertices_;  // of each panel
  std::vector<Fold> folds_;                 // hinges between two panels
  std::vector<Hinge> hinges_;
  Points2 pattern_;
};

}  // namespace paperbake
