#pragma once

#include "core/model/sheet.h"

#include <Eigen/Geometry>

#include <cstdint>
#include <vector>

namespace paperbake {

template <class Value>
struct Key {
  double time;  // [s] in a file, frames in a scene
  Value value;
};

/// Interpolation from one key to the next: constant; linear, for rotations along the shorter arc;
/// or a cubic Hermite curve.
enum class Interpolation : std::uint8_t { step, linear, cubic };

/// Derivatives at a key, on its left (in) and on its right (out). [1 / unit of time]
template <class Value>
struct Tangents {
  Value in, out;
};

template <class Value>
struct Track {
  std::vector<Key<Value>> keys;           // in order of time
  std::vector<Tangents<Value>> tangents;  // one for each key when cubic, else empty
  Interpolation interpolation = Interpolation::linear;
};

/// The value at a time: `none` for a track without keys, before the first and after the last key
/// the value of that key. Between keys a and b with time step d, a cubic track has the value
///
///   p = (2t³-3t²+1) a + (t³-2t²+t) d a_out + (-2t³+3t²) b + (t³-t²) d b_in,   t in [0, 1];
///
/// a rotation is evaluated as four numbers and normalized.
/// source  glTF 2.0, appendix C
Vector3d value_at(const Track<Vector3d>&, double time, const Vector3d& none);
Eigen::Quaterniond value_at(const Track<Eigen::Quaterniond>&, double time);

/// Changes the sign of keys and their tangents so that neighbouring keys have a non-negative dot
/// product: q and -q are the same rotation, but a cubic must not run from one to the other.
void make_continuous(Track<Eigen::Quaterniond>&);

}  // namespace paperbake
