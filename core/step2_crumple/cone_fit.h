#pragma once

#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// A ruling as the curvature of one place tells it.
struct RulingSample {
  Vector2d p;       // [m]  pattern
  Vector2d across;  // unit, perpendicular to the ruling
  double weight;
};

/// The rulings of a generalised cone on the pattern: lines through one apex, which is at infinity
/// for a cylinder.
struct Cone {
  Vector2d centre{0, 0};   // [m] middle of what was fitted
  double scale = 1;        // [m]
  Vector3d apex{1, 0, 0};  // homogeneous and of length 1: centre + scale (x, y)/w
  // [1] mean square of sin(angle off) x distance from the apex, w to be thought of
  double residual = 0;

  Vector2d ruling(const Vector2d& p) const;  // unit direction of the line through p
  bool is_cylinder() const;                  // apex farther off than 10 scales
  Vector2d apex_point() const { return centre + scale * apex.head<2>() / apex.z(); }
};

/// The apex a that minimises  a^T (sum w q q^T / sum w + pull e3 e3^T) a,  q = (n, -n.(p -
///                            centre)/scale),  n = across,
/// |a| = 1. One formula for cone and cylinder; the pull keeps noise on parallel rulings from making
/// an apex.
/// scale  [m] size of the window
/// pull   [1] 0: the plain fit
Cone fit_cone(const std::vector<RulingSample>&, double scale, double cylinder_regularization);

}  // namespace paperbake
