#pragma once

#include "core/model/sheet.h"

#include <Eigen/SparseCholesky>

#include <deque>
#include <vector>

namespace paperbake {

/// Guesses where the sheet will be when its held vertices have moved. What a guess misses of the
/// held positions is spread over the free vertices as a harmonic function of the pattern, so that
/// even a jump leaves no triangle behind.
class Predictor {
 public:
  Predictor(const Points2& pattern, const Triangles&, std::vector<int> held);

  /// x        |V|x3 [m] positions now
  /// past     positions one, two, ... steps ago, newest first; may be empty
  /// targets  |held|x3 [m]
  /// returns  guesses with the held vertices at their targets: at rest, linear and quadratic in
  ///          time as far as the past goes
  std::vector<Points3> guesses(const Points3& x, const std::deque<Points3>& past,
                               const Points3& targets) const;

 private:
  void spread(const Points3& targets, Points3& guess) const;

  // place_[v]: row of a free vertex, -1 - k of held vertex k
  std::vector<int> held_, place_;
  Eigen::SparseMatrix<double> coupling_;  // free x held part of the Laplacian
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> laplacian_;
};

}  // namespace paperbake
