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

/// How a value gets from one key to the next: held; straight, rotations along the shorter arc; or
/// Hermite's cubic.
enum class Interpolation : std::uint8_t { step, linear, cubic };

/// Rates of change at a key, on its left and on its right. [1 / unit of time]
template <class Value>
struct Tangents {
  Value in, out;
};

template <class Value>
struct Track {
  std::vector<Key<Value>> keys;           // in order of time
  std::vector<Tangents<Value>> tangents;  // cubic: one a key; else none
  Interpolation interpolation = Interpolation::linear;
};

/// Value at a time; `none` for a track without keys, the first or last key's beyond them. cubic: p
/// = (2t³-3t²+1) a + (t³-2t²+t) d a_out + (-2t³+3t²) b + (t³-t²) d b_in, d the time between the
/// keys; of rotations the four numbers, made a unit again. source: glTF 2.0, appendix C
Vector3d value_at(const Track<Vector3d>&, double time, const Vector3d& none);
Eigen::Quaterniond value_at(const Track<Eigen::Quaterniond>&, double time);

/// Turns keys over, with their tangents, so that neighbours lie on one side: q and -q are one
/// rotation, but the cubic between them is none.
void make_continuous(Track<Eigen::Quaterniond>&);

}  // namespace paperbake
