#include "formats/scene/scene_tracks.h"

#include <algorithm>

namespace paperbake {
namespace {

template <class Vector>
Vector cubic(const Vector& a, const Vector& a_out, const Vector& b_in, const Vector& b, double t,
             double d) {
  const double t2 = t * t, t3 = t2 * t;
  return (2 * t3 - 3 * t2 + 1) * a + (t3 - 2 * t2 + t) * d * a_out + (3 * t2 - 2 * t3) * b +
         (t3 - t2) * d * b_in;
}

Vector3d mix(const Vector3d& a, const Vector3d& b, double t) { return (1 - t) * a + t * b; }
Eigen::Quaterniond mix(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b, double t) {
  return a.slerp(t, b);
}

Vector3d mix(const Vector3d& a, const Vector3d& a_out, const Vector3d& b_in, const Vector3d& b,
             double t, double d) {
  return cubic(a, a_out, b_in, b, t, d);
}
Eigen::Quaterniond mix(const Eigen::Quaterniond& a, const Eigen::Quaterniond& a_out,
                       const Eigen::Quaterniond& b_in, const Eigen::Quaterniond& b, double t,
                       double d) {
  const Eigen::Quaterniond q(
      cubic<Eigen::Vector4d>(a.coeffs(), a_out.coeffs(), b_in.coeffs(), b.coeffs(), t, d));
  return q.norm() > 0 ? q.normalized() : a;
}

template <class Value>
Value value_of(const Track<Value>& track, double time, const Value& none) {
  const auto& keys = track.keys;
  if (keys.empty()) return none;
  const auto after = std::upper_bound(keys.begin(), keys.end(), time,
                                      [](double t, const Key<Value>& key) { return t < key.time; });
  if (after == keys.begin()) return keys.front().value;
  const auto before = std::prev(after);
  if (after == keys.end() || before->time == time || track.interpolation == Interpolation::step)
    return before->value;
  const double d = after->time - before->time, t = (time - before->time) / d;
  if (track.interpolation == Interpolation::linear) return mix(before->value, after->value, t);
  const auto i = before - keys.begin();
  return mix(before->value, track.tangents[i].out, track.tangents[i + 1].in, after->value, t, d);
}

}  // namespace

Vector3d value_at(const Track<Vector3d>& track, double time, const Vector3d& none) {
  return value_of(track, time, none);
}

Eigen::Quaterniond value_at(const Track<Eigen::Quaterniond>& track, double time) {
  return value_of(track, time, Eigen::Quaterniond::Identity());
}

void make_continuous(Track<Eigen::Quaterniond>& track) {
  for (std::size_t k = 1; k < track.keys.size(); ++k) {
    if (track.keys[k].value.dot(track.keys[k - 1].value) >= 0) continue;
    track.keys[k].value.coeffs() *= -1;
    if (!track.tangents.empty()) {
      track.tangents[k].in.coeffs() *= -1;
      track.tangents[k].out.coeffs() *= -1;
    }
  }
}

}  // namespace paperbake
