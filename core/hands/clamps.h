#pragma once

#include "core/geometry/rigid_motion.h"
#include "core/model/shot.h"

#include <optional>
#include <vector>

namespace paperbake {

/// Absolute handles that keep the distances of the pattern from each other for as long as they
/// hold: they hold a part of the sheet as a rigid plate, or a straight row of its points.
struct Clamp {
  std::vector<int> handles;  // indices into Shot::handles, in ascending order
  bool is_plate;  // false: they stand in a row, and what is beside the row may turn about it
};

/// The clamps of a shot, and where their handles are at each row of the keys. The shot must outlive
/// them.
class Clamps {
 public:
  /// first_frame  frame of row 0 of Handle::keyed
  Clamps(const Shot&, int first_frame);

  const std::vector<Clamp>& all() const { return clamps_; }
  /// The absolute handles: what the others hold is not known before they take hold
  /// (known_handles.h).
  const std::vector<int>& absolute() const { return absolute_; }
  /// Number of rows of the longest keys.
  int rows() const { return rows_; }
  /// [m] Longer side of the pattern.
  double side() const { return side_; }

  /// Where a handle holds the pattern. [m]
  Vector2d place(int handle) const { return shot_.handles[handle].pattern; }
  Vector2d middle(const Clamp&) const;
  /// Where a handle is keyed. [m]
  Vector3d keyed(int handle, int row) const { return keyed_position(shot_.handles[handle], row); }
  bool held(int handle, int row) const { return shot_.handles[handle].held(first_frame_ + row); }
  /// From the pattern, in the plane z = 0, to the plate on which the handles of a clamp are keyed;
  /// none: not all of them hold.
  std::optional<RigidMotion> pose(const Clamp&, int row) const;
  /// The rows from which on two absolute handles no longer keep their distance, the last one first.
  std::vector<int> rows_of_parting() const;

 private:
  using RigidWith = std::vector<std::vector<char>>;  // 1: the two handles keep their distance

  /// The first row in which two handles that hold are not as far apart as on the pattern; the
  /// number of rows if there is none.
  int parting(int h, int k) const;
  bool are_rigid(int h, int k) const;
  void find();
  std::vector<std::size_t> rigid_around(std::vector<std::size_t> members, const RigidWith&) const;
  Vector2d extent_of(const std::vector<int>& handles) const;

  const Shot& shot_;
  int first_frame_, rows_ = 0;
  double side_;
  std::vector<int> absolute_;  // handles
  std::vector<Clamp> clamps_;
};

}  // namespace paperbake
