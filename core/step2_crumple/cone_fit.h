#pragma once

#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// The ruling through one point of the pattern, as the curvature there suggests it.
struct RulingSample {
  Vector2d p;       // [m] point of the pattern
  Vector2d across;  // unit vector perpendicular to the ruling
  double weight;    // of this sample in the fit
};

/// The rulings of a generalised cone on the pattern: straight lines through one apex, which lies at
/// infinity for a cylinder.
struct Cone {
  Vector2d centre{0, 0};   // [m] weighted mean of the points of the fit
  double scale = 1;        // [m] size of the window of the fit
  Vector3d apex{1, 0, 0};  // [1] unit vector (x, y, w): the apex lies at centre + scale (x, y)/w

  Vector2d ruling(const Vector2d& p) const;  // unit vector along the line through p
};

/// Fits a cone to rulings: the apex a of length 1 that minimises
///
///   a^T (sum w q q^T / sum w + cylinder_regularization e3 e3^T) a,
///   q = (n, -n.(p - centre)/scale),  n = across,  w = weight.
///
/// One formula serves for cone and cylinder. The regularization keeps noise on parallel rulings
/// from producing an apex.
/// scale                    [m] size of the window
/// cylinder_regularization  [1] 0: the plain fit
Cone fit_cone(const std::vector<RulingSample>&, double scale, double cylinder_regularization);

}  // namespace paperbake
