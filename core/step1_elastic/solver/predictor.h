#pragma once

#include "core/step1_elastic/position_constraints.h"

#include <Eigen/SparseCholesky>

#include <deque>
#include <vector>

namespace paperbake {

/// Initial guesses for where the sheet will be when its constrained vertices have moved. The
/// difference between a guess and the targets is spread over the free vertices as a harmonic
/// function on the pattern, so that even a jump leaves no triangle behind.
class Predictor {
 public:
  /// held  the constrained vertices
  Predictor(const Points2& pattern, const Triangles&, std::vector<int> held);

  /// x        |V|x3 [m] present positions
  /// past     |V|x3 [m] positions one, two, ... steps ago, newest first; may be empty
  /// hard     constraints of the held vertices, in the same order
  /// returns  guesses with the constrained vertices at their targets: at rest, and extrapolated
  ///          linearly and quadratically in time as far as the past allows
  std::vector<Points3> guesses(const Points3& x, const std::deque<Points3>& past,
                               const PositionConstraints& hard) const;

 private:
  void spread(const PositionConstraints& hard, Points3& guess) const;

  // place_[v]: row of a free vertex, or -1 - k for the constrained vertex k
  std::vector<int> held_, place_;
  Eigen::SparseMatrix<double> coupling_;  // free x constrained part of the Laplacian
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> laplacian_;
};

}  // namespace paperbake
