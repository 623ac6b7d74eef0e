#include "core/animation/trajectory.h"

#include "core/geometry/mesh_transfer.h"

namespace paperbake {

void Trajectory::begin(const Sheet& sheet) {
  pattern_ = sheet.pattern;
  triangles_ = sheet.triangles;
  points_ = {{0, sheet.x}};
}

void Trajectory::carry_onto(const Sheet& sheet) {
  if (same_entries(pattern_, sheet.pattern) && same_entries(triangles_, sheet.triangles)) return;
  const MeshTransfer onto(pattern_, triangles_, sheet.pattern);
  for (TrajectoryPoint& point : points_) point.x = onto(point.x);
  pattern_ = sheet.pattern;
  triangles_ = sheet.triangles;
}

void Trajectory::append(const Sheet& sheet, const std::vector<TrajectoryPoint>& points, double from,
                        double to) {
  carry_onto(sheet);
  for (const TrajectoryPoint& point : points)
    points_.push_back({from + point.at * (to - from), point.x});
}

void Trajectory::end(const Sheet& sheet) {
  carry_onto(sheet);
  if (points_.back().at < 1)
    points_.push_back({1, sheet.x});
  else
    points_.back().x = sheet.x;
}

}  // namespace paperbake
