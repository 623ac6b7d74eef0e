#pragma once

#include "core/model/serializer.h"
#include "core/model/sheet.h"

#include <array>
#include <map>

namespace paperbake {

/// [m] How far a contact is sheared when it begins to slide. While it sticks, its friction is that
/// of a spring, whose force reaches Coulomb's limit at this displacement.
inline constexpr double sticking_shear = 1e-5;

/// Two features that touch, under a name that stays the same from step to step.
struct TouchingFeatures {
  // number of the sheet of either feature; -1 - c: the second is of collider c of the shot
  std::array<int, 2> body;
  // their vertices, each feature's in order: vertex and triangle, or edge and edge. With a collider
  // those of the sheet, at most three, then a feature of the collider. -1: none
  std::array<int, 4> vertices;

  bool operator<(const TouchingFeatures& other) const {
    return body != other.body ? body < other.body : vertices < other.vertices;
  }
};

/// What contacts that stick remember between steps: the shear of each, which is the part of the
/// sliding of its first feature along the second that the friction spring holds.
///
/// A step begins with the shear s of the last one, turned into the plane of contact. Its friction
/// energy is mu N f0(|s + u|), where u is how far the contact slides in this step, N the force of
/// the contact at the beginning, and f0 the mollifier with epsilon = sticking_shear (friction.h).
/// So the force of a contact at rest does not fade, and nothing creeps. Afterwards the shear is
/// s + u, shortened to epsilon where it is longer: the rest has been slid for good. Contacts that
/// have come apart are forgotten.
/// source  [Cundall 1979]; implicit, with the mollifier of [Li 2020]: this project
class FrictionHistory {
 public:
  /// [m] Shear of a contact at the end of the last step; zero if it did not touch then.
  Vector3d shear(const TouchingFeatures&) const;
  void remember(const TouchingFeatures& contact, const Vector3d& shear) { shear_[contact] = shear; }

  /// Takes over what another history says of contacts with one of these numbers of the first body.
  template <class OfBodies>
  void take(const FrictionHistory& other, OfBodies of_bodies) {
    for (const auto& [contact, shear] : other.shear_)
      if (of_bodies(contact.body)) shear_[contact] = shear;
  }

  void clear() { shear_.clear(); }
  void archive(Serializer&);

 private:
  std::map<TouchingFeatures, Vector3d> shear_;
};

/// The shear after a step in which the contact would have come to this one, had it not slid. [m]
Eigen::Vector2d sheared(const Eigen::Vector2d& trial);

}  // namespace paperbake
