#include "core/hands/gussets.h"

#include "core/geometry/hinges.h"
#include "core/hands/fold_axis.h"
#include "core/model/degrees.h"
#include "core/model/segment2.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace paperbake {
namespace {

constexpr double nearly_open = radians_of(1), nearly_shut = radians_of(165);
constexpr double least_turn = radians_of(60);  // of a bisector that is worth a crease
// up to which paper turns with the hands: where layers come to lie on each other, they need room
constexpr double most_turn = radians_of(170);
constexpr double shortest = 0.01;  // [1] of the longer side
constexpr double rounding = 1e-9;  // [rad]
constexpr double nobody = std::numeric_limits<double>::quiet_NaN();

/// The point where two lines cross, and the sector between their parts beyond it: on the other side
/// of each line than the hands that fold along the other.
struct Crossing {
  Vector2d at;     // [m]
  Vector2d on[2];  // directions of the parts beyond, of length 1
  double angle() const { return std::acos(std::clamp(on[0].dot(on[1]), -1.0, 1.0)); }  // [rad]
  Vector2d bisector() const { return (on[0] + on[1]).normalized(); }
  bool contains(const Vector2d& p) const {
    const double side = cross(on[0], on[1]);
    return cross(on[0], p - at) * side > 0 && cross(p - at, on[1]) * side > 0;
  }
};

std::optional<Crossing> crossing_of(const ExpectedCrease& one, const ExpectedCrease& two) {
  const auto& [a, b] = one.line;
  const auto& [p, q] = two.line;
  const std::optional<double> share = meeting(one.line, two.line);
  if (!share || !(*share > 0) || !(*share < 1)) return std::nullopt;
  const Vector2d at = a + *share * (b - a);
  return Crossing{at,
                  {((separates(two.line, one.between, b) ? b : a) - at).normalized(),
                   ((separates(one.line, two.between, q) ? q : p) - at).normalized()}};
}

/// [rad] The turn of paper at the edge from the origin along an axis, between the faces to `left`
/// and to `right` of it.
double turn_about(const Vector3d& axis, const Vector3d& left, const Vector3d& right) {
  Points3 x(4, 3);
  x << 0, 0, 0, axis.transpose(), left.transpose(), right.transpose();
  return dihedral_angle(x, {{0, 1, 2, 3}, {0, 1}});
}

/// A direction of the plane z = 0, turned about another one: down, if its turn is positive.
Vector3d turned_down(const Vector3d& direction, const Vector3d& axis, double turn) {
  const Vector3d along = direction.dot(axis) * axis, across = direction - along;
  return along + std::cos(turn) * across - std::sin(turn) * across.norm() * Vector3d::UnitZ();
}

/// Where the straight way from a point of the pattern meets the border or a line; near a corner or
/// a handle, these. [m]
Vector2d way_out(const Vector2d& from, const Vector2d& direction, const Shot& shot,
                 const std::vector<ExpectedCrease>& lines) {
  const double side = longer_side(shot.pattern);
  double length = std::numeric_limits<double>::infinity();
  std::vector<Vector2d> places;
  const auto meet = [&](const Vector2d& p, const Vector2d& q) {
    const std::optional<double> at = meeting({from, from + direction}, {p, q});
    // what is nearer may be drawn along the lines that cross
    if (at && *at > shortest * side) length = std::min(length, *at);
  };
  const auto meet_polygon = [&](const std::vector<Vector2d>& polygon) {
    for (std::size_t i = 0; i < polygon.size(); ++i)
      meet(polygon[i], polygon[(i + 1) % polygon.size()]);
    places.insert(places.end(), polygon.begin(), polygon.end());
  };
  meet_polygon(shot.pattern.outline);
  for (const std::vector<Vector2d>& hole : shot.pattern.holes) meet_polygon(hole);
  for (const ExpectedCrease& line : lines) meet(line.line.a, line.line.b);
  for (const PrescribedCrease& drawn : shot.pattern.prescribed_creases)
    for (std::size_t k = 0; k + 1 < drawn.line.size(); ++k) meet(drawn.line[k], drawn.line[k + 1]);
  for (const Handle& handle : shot.handles) places.push_back(handle.pattern);
  const Vector2d end = from + length * direction;
  for (const Vector2d& place : places)
    if ((place - end).norm() < on_line * side) return place;
  return end;
}

/// The hand that two lines have in common, and those on their other sides.
struct HandsOfCorner {
  std::vector<int> shared, of_one, of_two;  // handles
};

std::optional<HandsOfCorner> hands_of(const ExpectedCrease& one, const ExpectedCrease& two) {
  for (const auto& [shared, of_one] :
       {std::pair(one.plate, one.other), std::pair(one.other, one.plate)}) {
    if (shared == two.plate) return HandsOfCorner{shared, of_one, two.other};
    if (shared == two.other) return HandsOfCorner{shared, of_one, two.plate};
  }
  return std::nullopt;
}

/// Two lines that cross, and what hands do there.
class Corner {
 public:
  /// one, two  indices of the lines
  Corner(const Clamps& clamps, const std::vector<ExpectedCrease>& lines, int one, int two,
         const Crossing& crossing, HandsOfCorner hands)
      : clamps_(clamps),
        lines_(lines),
        one_(one),
        two_(two),
        crossing_(crossing),
        hands_(std::move(hands)) {}

  /// Whether a hand holds the fourth sector, too.
  bool is_held() const {
    return std::any_of(clamps_.all().begin(), clamps_.all().end(), [&](const Clamp& hand) {
      return std::all_of(hand.handles.begin(), hand.handles.end(),
                         [&](int h) { return is_beyond(h); });
    });
  }

  /// The gusset crease, without its line; its turns say whether there is any.
  ExpectedCrease gusset() const {
    const bool outwards = !leads_inwards();
    ExpectedCrease gusset;
    gusset.by = ExpectedCrease::By::folds_that_cross;
    gusset.plate = hands_.of_one;
    gusset.other = hands_.of_two;
    gusset.turn.assign(rows(), nobody);
    gusset.beyond[0] = {one_, two_, gusset.turn};
    gusset.beyond[1] = {two_, one_, gusset.turn};
    for (int row = 0; row < rows(); ++row) {
      const std::optional<GussetShape> shape = shape_in(row, outwards);
      if (!shape) continue;
      gusset.turn[row] = shape->turn;
      for (int side = 0; side < 2; ++side) gusset.beyond[side].turn[row] = shape->beyond[side];
    }
    return gusset;
  }

 private:
  int rows() const {
    return static_cast<int>(std::min(lines_[one_].turn.size(), lines_[two_].turn.size()));
  }
  bool is_beyond(int handle) const { return crossing_.contains(clamps_.place(handle)); }

  std::optional<GussetShape> shape_in(int row, bool outwards) const {
    const double a = lines_[one_].turn[row], b = lines_[two_].turn[row];
    if (std::isnan(a + b) || goes_straight_on(a, b)) return std::nullopt;
    const std::optional<GussetShape> shape = gusset_shape(crossing_.angle(), a, b, outwards);
    return shape && std::abs(shape->turn) < most_turn ? shape : std::nullopt;
  }

  /// Whether handles in the fourth sector are nearer to where it goes inwards, in the frame in
  /// which it is shut most.
  bool leads_inwards() const {
    int shut = -1;
    double most = 0;
    for (int row = 0; row < rows(); ++row)
      if (const auto shape = shape_in(row, true); shape && std::abs(shape->turn) > most) {
        most = std::abs(shape->turn);
        shut = row;
      }
    if (shut < 0) return false;
    double off[2] = {0, 0};  // [m2] outwards, and inwards
    for (const int h : clamps_.absolute())
      if (is_beyond(h) && clamps_.held(h, shut))
        for (int inwards = 0; inwards < 2; ++inwards)
          off[inwards] += (place_beyond(h, shut, !inwards) - clamps_.keyed(h, shut)).squaredNorm();
    return off[1] < off[0];
  }

  /// Where the paper at a handle in the fourth sector goes. [m]
  Vector3d place_beyond(int handle, int row, bool outwards) const {
    const Vector2d p = clamps_.place(handle);
    const GussetShape shape = *shape_in(row, outwards);
    const Vector2d middle = crossing_.bisector();
    const int half = cross(middle, p - crossing_.at) * cross(middle, crossing_.on[0]) > 0 ? 0 : 1;
    Eigen::Matrix2d sides;
    sides << crossing_.on[half], middle;
    const Vector2d shares = sides.inverse() * (p - crossing_.at);
    const Vector3d seen = shares.x() * shape.borders[half] + shares.y() * shape.bisector;
    // the axes of the shape, on the pattern
    const Vector2d x = crossing_.on[0], across = crossing_.on[1] - crossing_.on[1].dot(x) * x;
    const Vector2d at = crossing_.at + seen.x() * x + seen.y() * across.normalized();
    return (*clamps_.pose({hands_.shared, true}, row))(Vector3d(at.x(), at.y(), seen.z()));
  }

  const Clamps& clamps_;
  const std::vector<ExpectedCrease>& lines_;
  int one_, two_;
  Crossing crossing_;
  HandsOfCorner hands_;
};

}  // namespace

bool goes_straight_on(double turn, double turn_of_others) {
  const auto is_flat = [](double angle) {
    return std::abs(angle) < nearly_open || std::abs(angle) > nearly_shut;
  };
  return is_flat(turn) || is_flat(turn_of_others);
}

std::optional<GussetShape> gusset_shape(double angle, double turn, double turn_of_others,
                                        bool outwards) {
  const Vector3d one = Vector3d::UnitX(), two(std::cos(angle), std::sin(angle), 0);
  GussetShape shape;
  const Vector3d right = shape.borders[0] = turned_down(one, two, turn_of_others),
                 left = shape.borders[1] = turned_down(two, one, turn);
  const double half = std::acos(std::clamp(right.dot(left), -1.0, 1.0)) / 2;
  if (!(half < angle / 2 && half > rounding)) return std::nullopt;
  // the bisector stands off from the plane of its borders, to one side or the other
  const double off = std::acos(std::clamp(std::cos(angle / 2) / std::cos(half), -1.0, 1.0));
  const double side = (turn > 0) == outwards ? 1 : -1;
  shape.bisector = std::cos(off) * (right + left).normalized() +
                   side * std::sin(off) * right.cross(left).normalized();
  shape.turn = turn_about(shape.bisector, left, right);
  shape.beyond[0] = turn_about(right, shape.bisector, -two);
  shape.beyond[1] = turn_about(left, -one, shape.bisector);
  return shape;
}

std::vector<ExpectedCrease> gussets(const Shot& shot, const Clamps& clamps,
                                    const std::vector<ExpectedCrease>& expected) {
  std::vector<ExpectedCrease> all = expected;
  for (std::size_t one = 0; one < expected.size(); ++one)
    for (std::size_t two = 0; two < one; ++two) {
      const std::optional<Crossing> crossing = crossing_of(expected[one], expected[two]);
      const std::optional<HandsOfCorner> hands = hands_of(expected[one], expected[two]);
      if (!crossing || !hands) continue;
      const Corner corner(clamps, expected, one, two, *crossing, *hands);
      if (corner.is_held()) continue;
      ExpectedCrease gusset = corner.gusset();
      if (std::abs(largest_turn(gusset)) < least_turn) continue;
      const Vector2d end = way_out(crossing->at, crossing->bisector(), shot, all);
      const double length = (end - crossing->at).norm();
      if (!std::isfinite(length)) continue;
      gusset.line = {crossing->at, end};
      gusset.between = 0.5 * (crossing->at + end);
      for (int side = 0; side < 2; ++side)
        gusset.beyond[side].at = crossing->at + 0.5 * length * crossing->on[side];
      all.push_back(std::move(gusset));
    }
  return {all.begin() + static_cast<std::ptrdiff_t>(expected.size()), all.end()};
}

}  // namespace paperbake
