#pragma once

namespace paperbake {

/// A barrier energy and its derivatives with respect to the distance d of two features.
struct Barrier {
  double value;   // [J]
  double slope;   // [N]    b'  <= 0
  double second;  // [N/m]  b'' >= 0
};

/// b(d) = -kappa (d - dhat)^2 ln(d/dhat)
/// d       [m] in (0, dhat)
/// kappa   [N/m]
/// source  [Li 2020], as a function of the distance itself
Barrier log_barrier(double d, double dhat, double kappa);

/// The barrier between two features of sheets: kappa = 0.05 N / dhat. Zero from dhat on; infinite
/// at 0.
Barrier barrier(double distance, double dhat);

}  // namespace paperbake
