#pragma once

#include "core/render/render_mesh.h"

#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace paperbake {

// [edges] points of creases nearer than this are merged
constexpr double merged_within = 0.31;

/// A set of points in which neighbours within a radius are found by a grid of cells of that size.
class Sites {
 public:
  explicit Sites(double radius) : radius_(radius) {}  // [m]
  /// The nearest point within the radius; -1: none.
  int nearest(const Vector2d& p) const {
    const auto [cx, cy] = cell(p);
    int best = -1;
    double least = radius_;
    for (int x = cx - 1; x <= cx + 1; ++x)
      for (int y = cy - 1; y <= cy + 1; ++y) {
        const auto range = cells_.equal_range({x, y});
        for (auto it = range.first; it != range.second; ++it)
          if ((points[it->second] - p).norm() < least) {
            least = (points[it->second] - p).norm();
            best = it->second;
          }
      }
    return best;
  }
  /// Adds a point, however near others are. returns  its number
  int add(const Vector2d& p) {
    cells_.emplace(cell(p), static_cast<int>(points.size()));
    points.push_back(p);
    return static_cast<int>(points.size()) - 1;
  }
  /// The nearest point within the radius; where there is none, a new one.
  int nearest_or_new(const Vector2d& p) {
    const int known = nearest(p);
    return known >= 0 ? known : add(p);
  }
  std::vector<Vector2d> points;  // [m]

 private:
  std::pair<int, int> cell(const Vector2d& p) const {
    return {int(std::floor(p.x() / radius_)), int(std::floor(p.y() / radius_))};
  }
  double radius_;
  std::multimap<std::pair<int, int>, int> cells_;
};

/// The creases for which there is room [m], the heaviest first. One that lies beside a heavier one,
/// or beside one of `lines`, is left out: folds that wander over the sheet leave many lines, and a
/// mesh that followed them all would follow none.
std::vector<CreaseSegment> chosen_creases(std::vector<CreaseSegment> creases, double room,
                                          double edge, const std::vector<CreaseSegment>& lines);

/// The segments of prescribed creases.
std::vector<CreaseSegment> segments_of(const std::vector<PrescribedCrease>&);

/// The points of one crease in order, without those for which there is no room beside the border.
/// Those beside one of `lines`, which are rows of edges anyway, are moved onto it: a point that
/// lies a thousandth of an edge beside a row of edges is the corner of a needle.
/// all      the creases, at whose crossings there are points as well
/// edge     [m] length of the edges of the mesh
/// returns  indices into the points of the sites, where new ones are added
std::vector<int> lay(const CreaseSegment&, const std::vector<CreaseSegment>& all,
                     const std::vector<CreaseSegment>& lines, const Pattern&, double edge, Sites&);

}  // namespace paperbake
