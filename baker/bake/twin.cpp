#include "baker/bake/twin.h"

#include "core/geometry/random.h"
#include "core/model/pattern.h"

#include <algorithm>

namespace paperbake {

namespace {

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

bool moves(const Handle& handle) {
  for (int row = 1; row < handle.keyed.rows(); ++row)
    if (handle.keyed.row(row) != handle.keyed.row(row - 1)) return true;
  return false;
}

}  // namespace

BakePlan twin_of(const BakePlan& plan) {
  BakePlan twin = plan;
  twin.animation.checks_mesh = false;
  for (std::size_t s = 0; s < twin.shots.size(); ++s) {
    Jitter jitter(seed_of_sheet(plan, s));
    Shot& shot = twin.shots[s];
    if (std::none_of(shot.handles.begin(), shot.handles.end(), moves)) {
      const Vector3d moved = jitter.next();
      shot.start.x.rowwise() += moved.transpose();
      for (Handle& handle : shot.handles) handle.keyed.rowwise() += moved.transpose();
      continue;
    }
    for (Handle& handle : shot.handles) {
      const Points3 keyed = handle.keyed;
      Vector3d moved = Vector3d::Zero();
      for (int row = 1; row < keyed.rows(); ++row) {
        if (keyed.row(row) != keyed.row(row - 1)) moved = jitter.next();
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
  shapes_[{frame.sheet_index, frame.frame}] = sheets_[frame.sheet_index].samples(*frame.sheet).x;
}

std::optional<double> SampledShapes::distance(const AnimatedFrame& frame) const {
  const auto found = shapes_.find({frame.sheet_index, frame.frame});
  if (found == shapes_.end() || found->second.rows() == 0) return {};
  const SampledSheet& sheet = sheets_[frame.sheet_index];
  return rms_distance(sheet.samples(*frame.sheet).x, found->second) / sheet.side;
}

}  // namespace paperbake
