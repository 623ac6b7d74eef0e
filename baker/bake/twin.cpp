#include "baker/bake/twin.h"

#include "core/geometry/measure.h"
#include "core/geometry/random.h"
#include "core/model/pattern.h"

#include <algorithm>

namespace paperbake {

namespace {

constexpr double rounding = twin_jitter / 100;  // [m] of keys that were interpolated

/// Random displacements of at most twin_jitter on each axis.
class Jitter {
 public:
  explicit Jitter(unsigned seed) : seed_(seed) {}
  Vector3d next() {
    Vector3d moved;
    for (double& axis : moved) axis = twin_jitter * uniform(seed_, draw_++);
    return moved;
  }

 private:
  unsigned seed_;
  std::uint64_t draw_ = 0;
};

/// Whether the handle moves into a row of its keys.
bool moves(const Handle& handle, int row) {
  return (handle.keyed.row(row) - handle.keyed.row(row - 1)).norm() > rounding;
}

/// Whether the handle moves while it holds.
bool carries(const Handle& handle, int first_frame) {
  for (int row = 1; row < handle.keyed.rows(); ++row)
    if (handle.held(first_frame + row) && moves(handle, row)) return true;
  return false;
}

/// Moves points by a displacement and a turn [rad] about a point.
void shift(Points3& x, const Vector3d& about, const Vector3d& moved, const Vector3d& turn) {
  for (Eigen::Index v = 0; v < x.rows(); ++v)
    x.row(v) += (moved + turn.cross(Vector3d(x.row(v)) - about)).transpose();
}

}  // namespace

BakePlan twin_of(const BakePlan& plan) {
  BakePlan twin = plan;
  twin.animation.checks_mesh = false;
  const int first_frame = plan.animation.first_frame;
  for (std::size_t s = 0; s < twin.shots.size(); ++s) {
    Jitter jitter(seed_of_sheet(plan, s));
    Shot& shot = twin.shots[s];
    if (std::none_of(shot.handles.begin(), shot.handles.end(),
                     [&](const Handle& handle) { return carries(handle, first_frame); })) {
      const Vector3d moved = jitter.next(), turn = jitter.next() / longer_side(shot.pattern),
                     about = shot.start.x.row(0);
      shift(shot.start.x, about, moved, turn);
      for (Handle& handle : shot.handles) shift(handle.keyed, about, moved, turn);
      continue;
    }
    for (Handle& handle : shot.handles) {
      const Handle was = handle;
      Vector3d moved = Vector3d::Zero();
      for (int row = 1; row < was.keyed.rows(); ++row) {
        if (moves(was, row)) moved = jitter.next();
        handle.keyed.row(row) += moved.transpose();
      }
    }
  }
  return twin;
}

SampledShapes::SampledShapes(const BakePlan& plan) {
  constexpr int along = 25;  // points
  for (const Shot& shot : plan.shots)
    sheets_.push_back({PatternSamples(shot.pattern, along), longer_side(shot.pattern)});
}

void SampledShapes::add(const AnimatedFrame& frame) {
  shapes_[{frame.sheet_index, frame.frame}] = sheets_[frame.sheet_index].samples(*frame.sheet);
}

std::optional<double> SampledShapes::distance(const AnimatedFrame& frame) const {
  const auto found = shapes_.find({frame.sheet_index, frame.frame});
  if (found == shapes_.end() || found->second.rows() == 0) return {};
  const SampledSheet& sheet = sheets_[frame.sheet_index];
  return rms_distance(sheet.samples(*frame.sheet), found->second) / sheet.side;
}

}  // namespace paperbake
