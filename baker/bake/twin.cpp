#include "baker/bake/twin.h"

#include "core/geometry/random.h"
#include "core/model/pattern.h"

#include <cmath>

namespace paperbake {

BakePlan twin_of(const BakePlan& plan) {
  BakePlan twin = plan;
  for (std::size_t s = 0; s < twin.shots.size(); ++s) {
    std::uint64_t draw = 0;
    for (Handle& handle : twin.shots[s].handles) {
      const Points3 keyed = handle.keyed;
      Vector3d moved = Vector3d::Zero();
      for (int row = 1; row < keyed.rows(); ++row) {
        if (keyed.row(row) != keyed.row(row - 1))
          for (double& axis : moved) axis = twin_jitter * uniform(plan.seeds[s], draw++);
        handle.keyed.row(row) += moved.transpose();
      }
    }
  }
  return twin;
}

SampledShapes::SampledShapes(const BakePlan& plan) {
  constexpr int steps = 24;  // along the longer side
  for (const Shot& shot : plan.shots) {
    SampledSheet& sheet = sheets_.emplace_back();
    sheet.side = longer_side(shot.pattern);
    const Vector2d size = extent(shot.pattern);
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; j <= steps; ++j)
        if (const Vector2d p = sheet.side / steps * Vector2d(i, j);
            p.x() <= size.x() && p.y() <= size.y() && contains(shot.pattern, p, 0))
          sheet.points.push_back(p);
  }
}

Points3 SampledShapes::sample(const AnimatedFrame& frame) {
  SampledSheet& at = sheets_[frame.sheet_index];
  const Sheet& sheet = *frame.sheet;
  if (at.pattern.rows() != sheet.pattern.rows() || at.pattern != sheet.pattern ||
      at.triangles.rows() != sheet.triangles.rows() || at.triangles != sheet.triangles) {
    at.pattern = sheet.pattern;
    at.triangles = sheet.triangles;
    const PointLocator locator(sheet.pattern, sheet.triangles);
    at.places.clear();
    for (const Vector2d& p : at.points) at.places.push_back(locator.locate(p));
  }
  Points3 x(at.places.size(), 3);
  for (std::size_t k = 0; k < at.places.size(); ++k)
    x.row(static_cast<Eigen::Index>(k)) = interpolate(at.places[k], sheet.triangles, sheet.x);
  return x;
}

void SampledShapes::add(const AnimatedFrame& frame) {
  shapes_[{frame.sheet_index, frame.frame}] = sample(frame);
}

std::optional<double> SampledShapes::distance(const AnimatedFrame& frame) {
  const auto found = shapes_.find({frame.sheet_index, frame.frame});
  if (found == shapes_.end() || found->second.rows() == 0) return {};
  return std::sqrt((sample(frame) - found->second).rowwise().squaredNorm().mean()) /
         sheets_[frame.sheet_index].side;
}

}  // namespace paperbake
