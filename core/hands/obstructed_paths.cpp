#include "core/hands/obstructed_paths.h"

#include "core/model/segment2.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

namespace paperbake {
namespace {

constexpr double least_short = 1e-3;  // [m] what a handle may be off
constexpr double min_area = 1e-4;     // [1] of the square of the longer side, of a flat part
constexpr int steps = 4;              // of the points on a side of a taut part

/// A point of the sheet whose place is known.
struct Place {
  Vector2d pattern;  // [m]
  Vector3d x;        // [m]
};

/// Handles that hold the paper between them taut, or a single handle.
struct TautPart {
  std::vector<int> handles;
  std::vector<Place> hull;  // handles at the corners of the convex hull, counter-clockwise
  bool is_flat = false;     // the hull is a polygon, and paper fills it
};

/// Corners of the convex hull, counter-clockwise; of points on a line its two ends.
std::vector<Place> convex_hull(std::vector<Place> points) {
  std::sort(points.begin(), points.end(), [](const Place& p, const Place& q) {
    return std::pair(p.pattern.x(), p.pattern.y()) < std::pair(q.pattern.x(), q.pattern.y());
  });
  const auto half = [&](auto first, auto last) {
    std::vector<Place> chain;
    for (auto p = first; p != last; ++p) {
      while (chain.size() > 1) {
        const Vector2d a = chain[chain.size() - 2].pattern, b = chain.back().pattern;
        const double width = (b - a).norm() * (p->pattern - a).norm();
        if (cross(b - a, p->pattern - a) > 1e-9 * width) break;
        chain.pop_back();
      }
      chain.push_back(*p);
    }
    chain.pop_back();
    return chain;
  };
  if (points.size() < 2) return points;
  std::vector<Place> hull = half(points.begin(), points.end());
  const std::vector<Place> back = half(points.rbegin(), points.rend());
  hull.insert(hull.end(), back.begin(), back.end());
  return hull;
}

double area(const std::vector<Place>& polygon) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i)
    twice += cross(polygon[i].pattern, polygon[(i + 1) % polygon.size()].pattern);
  return 0.5 * twice;
}

bool contains(const std::vector<Place>& convex, const Vector2d& p) {
  for (std::size_t i = 0; i < convex.size(); ++i) {
    const Vector2d &a = convex[i].pattern, &b = convex[(i + 1) % convex.size()].pattern;
    if (cross(b - a, p - a) < 0) return false;
  }
  return true;
}

/// True when the segment a-b has a point in the convex polygon.
bool meets(const std::vector<Place>& convex, const Vector2d& a, const Vector2d& b) {
  double from = 0, to = 1;  // the part of the segment inside all sides so far
  for (std::size_t i = 0; i < convex.size(); ++i) {
    const Vector2d &p = convex[i].pattern, &q = convex[(i + 1) % convex.size()].pattern;
    const double at_a = cross(q - p, a - p), at_b = cross(q - p, b - p);
    if (at_a < 0 && at_b < 0) return false;
    const double t = at_a / (at_a - at_b);
    if (at_a < 0) from = std::max(from, t);
    if (at_b < 0) to = std::min(to, t);
  }
  return from <= to;
}

/// A part that is held flat, seen as an obstacle.
class Obstacle {
 public:
  explicit Obstacle(const TautPart& part) : hull_(part.hull), from_(part.hull.front()) {
    Eigen::Matrix<double, 3, 2> moved = Eigen::Matrix<double, 3, 2>::Zero();
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
    for (const Place& corner : hull_) {
      const Vector2d d = corner.pattern - from_.pattern;
      moved += (corner.x - from_.x) * d.transpose();
      spread += d * d.transpose();
    }
    frame_ = moved * spread.inverse();
    normal_ = frame_.col(0).cross(frame_.col(1)).normalized();
  }

  const std::vector<Place>& hull() const { return hull_; }
  double height(const Vector3d& x) const { return normal_.dot(x - from_.x); }  // [m]

  /// [m] Length of the shortest path from a to b round the part; none: the straight one is free.
  std::optional<double> path_round(const Vector3d& a, const Vector3d& b) const {
    const double up = height(a), down = height(b);
    if (!(up * down < 0)) return std::nullopt;
    const Vector3d at = a + up / (up - down) * (b - a);
    if (!contains(hull_, from_.pattern + frame_.transpose() * (at - from_.x))) return std::nullopt;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < hull_.size(); ++i)
      least = std::min(least, path_over(hull_[i].x, hull_[(i + 1) % hull_.size()].x, a, b));
    return least;
  }

 private:
  /// [m] Length of the shortest path from a to b that touches the segment p-q: straight when a and
  /// b are turned about the segment into one plane.
  static double path_over(const Vector3d& p, const Vector3d& q, const Vector3d& a,
                          const Vector3d& b) {
    const double length = (q - p).norm();
    const Vector3d along = (q - p) / length;
    const double sa = along.dot(a - p), sb = along.dot(b - p);
    const double ra = (a - p - sa * along).norm(), rb = (b - p - sb * along).norm();
    const double t = ra + rb > 0 ? (sa * rb + sb * ra) / (ra + rb) : sa;
    const Vector3d over = p + std::clamp(t, 0.0, length) * along;
    return (a - over).norm() + (over - b).norm();
  }

  std::vector<Place> hull_;
  Place from_;
  Eigen::Matrix<double, 3, 2> frame_;  // pattern to space
  Vector3d normal_;
};

/// The parts of a sheet that its handles hold taut, frame by frame, and what is in the way between
/// them.
class TautParts {
 public:
  TautParts(const Pattern& pattern, const std::vector<Handle>& handles, int first_frame)
      : pattern_(pattern), handles_(handles), first_frame_(first_frame) {
    const auto n = static_cast<Eigen::Index>(handles.size());
    straight_.setZero(n, n);
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index j = 0; j < i; ++j) {
        const double apart = (handles[i].pattern - handles[j].pattern).norm();
        const bool bent =
            paper_distance(pattern, handles[i].pattern, handles[j].pattern) > (1 + 1e-9) * apart;
        straight_(i, j) = straight_(j, i) = bent ? -1 : apart;
      }
  }

  void check(int frame) {
    const std::vector<TautPart> parts = taut_parts(frame);
    for (const TautPart& part : parts) {
      if (!part.is_flat) continue;
      const Obstacle obstacle(part);
      for (std::size_t a = 0; a < parts.size(); ++a)
        for (std::size_t b = 0; b < a; ++b)
          if (&parts[a] != &part && &parts[b] != &part)
            check_pair(parts[a], parts[b], part, obstacle, frame);
    }
  }

  std::vector<UnreachablePair> worst_first() const {
    std::vector<UnreachablePair> pairs;
    for (const auto& [parts, pair] : found_) pairs.push_back(pair);
    std::stable_sort(pairs.begin(), pairs.end(),
                     [](const UnreachablePair& p, const UnreachablePair& q) {
                       return p.apart - p.allowed > q.apart - q.allowed;
                     });
    return pairs;
  }

 private:
  Vector3d keyed(int h, int frame) const {
    return keyed_position(handles_[h], frame - first_frame_);
  }

  bool are_taut(int h, int k, int frame) const {
    const double apart = straight_(h, k);
    return apart > 0 && std::abs((keyed(h, frame) - keyed(k, frame)).norm() - apart) <=
                            HandleFeasibility::rounding;
  }

  /// Each handle with all others that are taut with it and with each other, in their order. A
  /// handle that is part of another's is not asked again.
  std::vector<TautPart> taut_parts(int frame) const {
    std::vector<int> held;
    for (std::size_t h = 0; h < handles_.size(); ++h)
      if (handles_[h].mode == HandleMode::absolute && handles_[h].stiffness == 0 &&
          handles_[h].held(frame))
        held.push_back(static_cast<int>(h));
    std::vector<char> known(handles_.size(), 0);
    std::vector<TautPart> parts;
    for (const int seed : held) {
      if (known[seed]) continue;
      TautPart part{{seed}, {}};
      for (const int h : held)
        if (h != seed && std::all_of(part.handles.begin(), part.handles.end(),
                                     [&](int member) { return are_taut(h, member, frame); }))
          part.handles.push_back(h);
      std::vector<Place> places;
      for (const int h : part.handles) {
        known[h] = 1;
        places.push_back({handles_[h].pattern, keyed(h, frame)});
      }
      part.hull = convex_hull(std::move(places));
      const double side = longer_side(pattern_);
      part.is_flat = area(part.hull) > min_area * side * side && is_filled(part.hull);
      parts.push_back(std::move(part));
    }
    return parts;
  }

  bool is_filled(const std::vector<Place>& hull) const {
    for (const auto& hole : pattern_.holes)
      for (std::size_t i = 0; i < hole.size(); ++i)
        if (meets(hull, hole[i], hole[(i + 1) % hole.size()])) return false;
    return true;
  }

  static std::vector<Place> places_on_sides(const TautPart& part) {
    std::vector<Place> places;
    for (std::size_t i = 0; i < part.hull.size(); ++i) {
      const Place &p = part.hull[i], &q = part.hull[(i + 1) % part.hull.size()];
      for (int k = 0; k < (part.hull.size() > 1 ? steps : 1); ++k) {
        const double t = double(k) / steps;
        places.push_back({p.pattern + t * (q.pattern - p.pattern), p.x + t * (q.x - p.x)});
      }
    }
    return places;
  }

  void check_pair(const TautPart& a, const TautPart& b, const TautPart& part,
                  const Obstacle& obstacle, int frame) {
    for (const Place& from : places_on_sides(a))
      for (const Place& to : places_on_sides(b)) {
        if (meets(obstacle.hull(), from.pattern, to.pattern)) continue;
        const std::optional<double> path = obstacle.path_round(from.x, to.x);
        const double paper = (from.pattern - to.pattern).norm();
        if (!path || *path - (1 + HandleFeasibility::tolerance) * paper < least_short) continue;
        if (paper_distance(pattern_, from.pattern, to.pattern) > (1 + 1e-9) * paper) continue;
        note({handles_[nearest(a, from)].name, handles_[nearest(b, to)].name, frame, frame, frame,
              *path, paper, handles_[part.handles.front()].name, from.pattern, to.pattern},
             {a.handles.front(), b.handles.front(), part.handles.front()});
      }
  }

  int nearest(const TautPart& part, const Place& place) const {
    return *std::min_element(part.handles.begin(), part.handles.end(), [&](int h, int k) {
      return (handles_[h].pattern - place.pattern).norm() <
             (handles_[k].pattern - place.pattern).norm();
    });
  }

  void note(const UnreachablePair& now, const std::array<int, 3>& parts) {
    UnreachablePair& worst = found_.emplace(parts, now).first->second;
    const int first = worst.first;
    if (now.apart - now.allowed > worst.apart - worst.allowed) worst = now;
    worst.first = first;
    worst.last = now.last;
  }

  const Pattern& pattern_;
  const std::vector<Handle>& handles_;
  int first_frame_;
  Eigen::MatrixXd straight_;  // [m] between two handles; -1: the path along the pattern bends
  std::map<std::array<int, 3>, UnreachablePair> found_;  // by the first handles of the three parts
};

}  // namespace

std::vector<UnreachablePair> obstructed_paths(const Pattern& pattern,
                                              const std::vector<Handle>& handles, int first_frame,
                                              int last_frame) {
  TautParts taut(pattern, handles, first_frame);
  for (int frame = first_frame; frame <= last_frame; ++frame) taut.check(frame);
  return taut.worst_first();
}

std::vector<UnreachablePair> all_impossible_pairs(const Pattern& pattern,
                                                  const std::vector<Handle>& handles,
                                                  int first_frame, int last_frame) {
  std::vector<UnreachablePair> all =
      HandleFeasibility(pattern, handles).impossible_pairs(handles, first_frame, last_frame);
  const std::vector<UnreachablePair> blocked =
      obstructed_paths(pattern, handles, first_frame, last_frame);
  all.insert(all.end(), blocked.begin(), blocked.end());
  return all;
}

}  // namespace paperbake
