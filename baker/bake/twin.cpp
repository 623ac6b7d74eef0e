#include "baker/bake/twin.h"

#include "core/geometry/random.h"
#include "core/model/pattern.h"

namespace paperbake {

BakePlan twin_of(const BakePlan& plan) {
  BakePlan twin = plan;
  twin.animation.checks_mesh = false;
  for (std::size_t s = 0; s < twin.shots.size(); ++s) {
    std::uint64_t draw = 0;
    const unsigned seed = seed_of_sheet(plan, s);
    for (Handle& handle : twin.shots[s].handles) {
      const Points3 keyed = handle.keyed;
      Vector3d moved = Vector3d::Zero();
      for (int row = 1; row < keyed.rows(); ++row) {
        if (keyed.row(row) != keyed.row(row - 1))
          for (double& axis : moved) axis = twin_jitter * uniform(seed, draw++);
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
