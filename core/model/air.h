#pragma once

#include "core/model/sheet.h"

#include <string>
#include <vector>

namespace paperbake {

/// A wind: the same everywhere but for its gusts, which it carries along.
struct Wind {
  std::string name;
  // |F|x3 [m/s] row f is frame first_frame + f of the scene; as in the first row before it, as in
  // the last row after it, and on a straight line in between
  Points3 velocity;
  double gust = 0;    // [1] standard deviation of the speed, of the speed itself
  unsigned seed = 0;  // of the gusts
};

/// The air around the sheets.
struct Air {
  double density = 0;  // [kg/m3] 0: a vacuum
  std::vector<Wind> winds = {};
  double fps = 24;  // [1/s] of the rows of the winds
};

inline constexpr double drag_across = 1.2;  // [1] C_d of a plate across the wind

// [1] Part of its velocity that a sheet keeps in 1/24 s in a vacuum, so that a swing dies away:
// assumed
inline constexpr double velocity_kept = 0.98;

/// Velocity of the air at a point: the sum of the winds. [m/s]
/// A gust multiplies the wind by 1 + gust n(t - s/|v|), where n is noise of mean 0 and variance 1
/// made of waves of 0.3 to 4 Hz, and s the way along the wind: gusts travel with the wind.
/// time  [s] since the first frame
/// p     [m]
Vector3d air_velocity(const Air&, double time, const Vector3d& p);

}  // namespace paperbake
