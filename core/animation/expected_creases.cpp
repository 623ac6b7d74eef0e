#include "core/animation/expected_creases.h"

#include "core/geometry/prescribed_creases.h"
#include "core/geometry/rigid_motion.h"
#include "core/linear_algebra/symmetric_eigen.h"
#include "core/model/segment2.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

namespace paperbake {
namespace {

constexpr double rigid = 2e-3;       // [1] of the longer side: a clamp keeps its distances to this
constexpr double min_length = 0.05;  // [1] of the longer side, of a clamp
constexpr double min_width = 0.02;   // [1] of the longer side: a clamp is no line
constexpr double min_turn = 60 * M_PI / 180;
constexpr double straight = 0.05;    // [1] ratio of the singular values of R_a - R_b
constexpr double max_misfit = 0.02;  // [1] of the longer side
constexpr double min_rise = 0.5;     // [1] of the distance of a row from the line
constexpr double on_line = 5e-3;     // [1] of the longer side: handles this near are on the line
constexpr double first_turn = 3 * M_PI / 180;
constexpr double same_line = 0.01;  // [1] of the longer side

/// Handles that hold a part of the sheet as a rigid plate, or along a straight edge of one.
struct Clamp {
  std::vector<int> handles;
  bool is_plate;  // false: they stand in a row, and what is beside the row may turn about it
};

/// A straight line on the pattern.
struct Line {
  Vector2d point, direction;  // [m], of length 1
  std::vector<double> turn;   // [rad] as in FoldingHands
  Vector2d between{0, 0};     // [m]
  double reach = 0;           // [m] distance of the two clamps
  const Clamp *plate = nullptr, *other = nullptr;
  double side(const Vector2d& p) const { return cross(direction, p - point); }  // [m]
};

class Clamps {
 public:
  Clamps(const Shot& shot, int first_frame)
      : shot_(shot), first_(first_frame), side_(longer_side(shot.pattern)) {
    for (std::size_t h = 0; h < shot.handles.size(); ++h) {
      frames_ = std::max(frames_, static_cast<int>(shot.handles[h].keyed.rows()));
      if (shot.handles[h].mode == HandleMode::absolute) absolute_.push_back(static_cast<int>(h));
    }
    find();
  }

  std::vector<ExpectedCrease> folds() const {
    std::vector<Line> candidates;
    for (std::size_t a = 0; a < clamps_.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        for (const auto& [first, second] :
             {std::pair{&clamps_[a], &clamps_[b]}, {&clamps_[b], &clamps_[a]}})
          if (const auto line = fold_between(*first, *second)) {
            candidates.push_back(*line);
            break;
          }

    // neighbours first: clamps with others between them may agree on a line by chance
    std::sort(candidates.begin(), candidates.end(),
              [](const Line& a, const Line& b) { return a.reach < b.reach; });

    std::vector<ExpectedCrease> folds;
    for (const Line& line : candidates)
      for (PrescribedCrease& part : on_paper(through_handles(line)))
        if (std::none_of(folds.begin(), folds.end(),
                         [&](const ExpectedCrease& known) { return same(known.crease, part); }))
          folds.push_back({std::move(part), line.turn, line.between, line.plate->handles,
                           line.other->handles, !line.other->is_plate});
    return folds;
  }

 private:
  Vector2d place(int h) const { return shot_.handles[h].pattern; }
  Vector3d keyed(int h, int row) const { return keyed_position(shot_.handles[h], row); }
  bool held(int h, int row) const { return shot_.handles[h].held(first_ + row); }

  bool are_rigid(int h, int k) const {
    const double apart = (place(h) - place(k)).norm();
    bool together = false;
    for (int row = 0; row < frames_; ++row) {
      if (!held(h, row) || !held(k, row)) continue;
      together = true;
      if (std::abs((keyed(h, row) - keyed(k, row)).norm() - apart) > rigid * side_) return false;
    }
    return together;
  }

  using RigidWith = std::vector<std::vector<char>>;

  /// Each handle with those near it first, as long as all are rigid with each other; then the
  /// plates of two handles that are rigid, but in no clamp yet: a handle on a fold belongs to the
  /// plates on both its sides, of which it is nearer to one.
  void find() {
    const std::size_t n = absolute_.size();
    RigidWith rigid_with(n, std::vector<char>(n, 0));
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < i; ++j)
        rigid_with[i][j] = rigid_with[j][i] = are_rigid(absolute_[i], absolute_[j]);
    std::set<std::vector<int>> found;
    RigidWith together(n, std::vector<char>(n, 0));
    const auto add = [&](const std::vector<std::size_t>& members, bool plates_only) {
      for (const std::size_t i : members)
        for (const std::size_t j : members) together[i][j] = 1;
      std::vector<int> handles;
      for (const std::size_t m : members) handles.push_back(absolute_[m]);
      std::sort(handles.begin(), handles.end());
      const Vector2d size = extent_of(handles);
      const bool is_plate = handles.size() > 2 && size[1] > min_width * side_;
      if (size[0] > min_length * side_ && (is_plate || !plates_only) &&
          found.insert(handles).second)
        clamps_.push_back({handles, is_plate});
    };
    for (std::size_t seed = 0; seed < n; ++seed) add(rigid_around({seed}, rigid_with), false);
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (rigid_with[i][j] && !together[i][j]) add(rigid_around({j, i}, rigid_with), true);
  }

  /// These handles, numbers in absolute_, and all others that are rigid with them and with each
  /// other, those near the first one first.
  std::vector<std::size_t> rigid_around(std::vector<std::size_t> members,
                                        const RigidWith& rigid_with) const {
    std::vector<std::size_t> order(absolute_.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    const Vector2d middle = place(absolute_[members.front()]);
    const auto distance = [&](std::size_t i) { return (place(absolute_[i]) - middle).norm(); };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t i, std::size_t j) { return distance(i) < distance(j); });
    for (const std::size_t i : order)
      if (std::all_of(members.begin(), members.end(),
                      [&](std::size_t m) { return i != m && rigid_with[i][m]; }))
        members.push_back(i);
    return members;
  }

  /// [m] Root of the summed squares of the distances from the middle, along and across the handles.
  Vector2d extent_of(const std::vector<int>& handles) const {
    Points2 p(handles.size(), 2);
    for (Eigen::Index k = 0; k < p.rows(); ++k) p.row(k) = place(handles[k]);
    p.rowwise() -= p.colwise().mean().eval();
    const SymmetricEigen<2> axes = symmetric_eigen(Eigen::Matrix2d(p.transpose() * p));
    return axes.values.cwiseMax(0).cwiseSqrt().reverse();
  }

  /// Of the plate on which the handles of a clamp are; none: not all of them hold.
  std::optional<RigidMotion> pose(const Clamp& clamp, int row) const {
    const std::size_t n = clamp.handles.size();
    Points3 flat(n, 3), now(n, 3);
    for (std::size_t k = 0; k < n; ++k) {
      const int h = clamp.handles[k];
      if (!held(h, row)) return std::nullopt;
      flat.row(k) << place(h).x(), place(h).y(), 0;
      now.row(k) = keyed(h, row);
    }
    return nearest_rigid_motion(flat, now);
  }

  /// The line along which the second clamp turns against the first, a plate.
  std::optional<Line> fold_between(const Clamp& plate, const Clamp& other) const {
    if (!plate.is_plate) return std::nullopt;
    std::optional<Line> line =
        other.is_plate ? axis_of_plates(plate, other) : axis_of_row(plate, other);
    if (!line || side_of(*line, plate) * side_of(*line, other) >= 0) return std::nullopt;
    for (const Clamp& third : clamps_)
      if (side_of(*line, third) == 0) return std::nullopt;
    line->reach = (middle(plate) - middle(other)).norm();
    line->between = 0.5 * (middle(plate) + middle(other));
    line->plate = &plate;
    line->other = &other;
    const double sign = side_of(*line, plate) > 0 ? 1 : -1;
    double most = 0;
    line->turn.assign(frames_, std::numeric_limits<double>::quiet_NaN());
    double last = 0;
    for (int row = 0; row < frames_; ++row) {
      const std::optional<double> turn = turn_of(*line, plate, other, row);
      if (!turn) continue;
      line->turn[row] = last =
          sign * *turn + 2 * M_PI * std::round((last - sign * *turn) / (2 * M_PI));
      most = std::max(most, std::abs(last));
    }
    return most < min_turn ? std::nullopt : line;
  }

  /// The line on which the equations n.p = c hold, by least squares; none where they hold in one
  /// point at most.
  /// normals  sum of n n^T
  /// sum      sum of c n
  static std::optional<Line> line_through(const Eigen::Matrix2d& normals, const Vector2d& sum) {
    const SymmetricEigen<2> axes = symmetric_eigen(normals);
    const double along = axes.values[1];
    if (!(along > 0) || axes.values[0] > straight * straight * along) return std::nullopt;
    const Vector2d normal = axes.vectors.col(1);
    Line line;
    line.point = sum.dot(normal) / along * normal;
    line.direction = {-normal.y(), normal.x()};
    return line;
  }

  /// Where two plates agree in the frame of their largest turn.
  std::optional<Line> axis_of_plates(const Clamp& a, const Clamp& b) const {
    double most = 0;
    std::optional<std::pair<RigidMotion, RigidMotion>> at_most;
    for (int row = 0; row < frames_; ++row) {
      const std::optional<RigidMotion> pa = pose(a, row), pb = pose(b, row);
      if (!pa || !pb) continue;
      const double turn = Eigen::AngleAxisd(pa->turn.transpose() * pb->turn).angle();
      if (turn > most) most = turn, at_most = {*pa, *pb};
    }
    if (most < min_turn) return std::nullopt;
    const auto& [pa, pb] = *at_most;
    // both take a point p of the line to the same place: M p + d = 0
    const Eigen::Matrix<double, 3, 2> M = (pa.turn - pb.turn).leftCols<2>();
    const Vector3d d = pa.shift - pb.shift;
    std::optional<Line> line = line_through(M.transpose() * M, -M.transpose() * d);
    if (line && line->direction.x() < 0) line->direction *= -1;  // whatever the rounding
    return line;
  }

  /// Where a handle is, seen from a plate: its pattern is the plane z = 0. [m]
  Vector3d seen_from(const RigidMotion& plate, int h, int row) const {
    return plate.turn.transpose() * (keyed(h, row) - plate.shift);
  }

  /// The points p of the plate whose distance from every handle stays that of the pattern,
  ///
  ///   2 p.(a - q_xy) = |a|^2 - |q|^2,
  ///
  /// where a is the handle on the pattern and q is where it goes: of each handle a line, in the
  /// frame in which the handles are farthest from where a flat sheet would have them.
  std::optional<Line> axis_of_row(const Clamp& plate, const Clamp& handles) const {
    double most = 0, highest = 0;
    Eigen::Matrix2d normals = Eigen::Matrix2d::Zero();
    Vector2d sum(0, 0);  // of c n, where n.p = c
    for (int row = 0; row < frames_; ++row) {
      const std::optional<RigidMotion> from = pose(plate, row);
      if (!from || !pose(handles, row)) continue;
      Eigen::Matrix2d normals_now = Eigen::Matrix2d::Zero();
      Vector2d sum_now(0, 0);
      for (const int h : handles.handles) {
        const Vector3d q = seen_from(*from, h, row);
        const Vector2d a = place(h), n = 2 * (a - q.head<2>());
        highest = std::max(highest, std::abs(q.z()));
        normals_now += n * n.transpose();
        sum_now += (a.squaredNorm() - q.squaredNorm()) * n;
      }
      if (normals_now.trace() > most)
        most = normals_now.trace(), normals = normals_now, sum = sum_now;
    }
    std::optional<Line> line = line_through(normals, sum);
    // handles that stay near the plane do not turn: they push the paper together
    if (line && highest < min_rise * std::abs(line->side(middle(handles)))) return std::nullopt;
    return line;
  }

  /// [rad] Dihedral angle between a plate on the left of the line and another clamp on the right,
  /// in the first half of a turn to either side; none: one of them does not hold, or the paper
  /// between them cannot be flat up to the line, because it is bowed.
  std::optional<double> turn_of(const Line& line, const Clamp& plate, const Clamp& other,
                                int row) const {
    const std::optional<RigidMotion> left = pose(plate, row);
    if (!left) return std::nullopt;
    if (other.is_plate) {
      const std::optional<RigidMotion> right = pose(other, row);
      if (!right) return std::nullopt;
      const Vector2d at =
          line.point + line.direction.dot(line.between - line.point) * line.direction;
      const Vector3d along = left->turn.leftCols<2>() * line.direction, nl = left->turn.col(2),
                     nr = right->turn.col(2);
      const double turn = std::atan2(nl.cross(nr).dot(along), nl.dot(nr));
      const double gap =
          ((left->turn - right->turn).leftCols<2>() * at + left->shift - right->shift).norm();
      return gap > max_slack(line, turn) ? std::nullopt : std::optional(turn);
    }
    Vector2d arm(0, 0);  // [m] away from the line in the plate, and along its normal
    for (const int h : other.handles) {
      if (!held(h, row)) return std::nullopt;
      const Vector3d q = seen_from(*left, h, row);
      const double reach = std::abs(line.side(place(h))),
                   out = line.side(q.head<2>()) * (line.side(place(h)) < 0 ? -1 : 1);
      const double turn = std::atan2(q.z(), out),
                   slide = (q.head<2>() - place(h)).dot(line.direction);
      if (std::max(std::abs(std::hypot(out, q.z()) - reach), std::abs(slide)) >
          max_slack(line, turn))
        return std::nullopt;
      arm += Vector2d(out, q.z());
    }
    return (side_of(line, plate) > 0 ? -1 : 1) * std::atan2(arm.y(), arm.x());
  }

  /// [m] By how much two clamps may miss each other at the line and still fold the paper there. A
  /// sheet of length l that bends evenly by the same turn misses it by about l turn/8.
  double max_slack(const Line& line, double turn) const {
    constexpr double rounding = 1e-4;  // [1] of the longer side
    return std::min(max_misfit * side_, rounding * side_ + 0.25 * line.reach * std::abs(turn) / 8);
  }

  Vector2d middle(const Clamp& clamp) const {
    Vector2d sum(0, 0);
    for (const int h : clamp.handles) sum += place(h);
    return sum / clamp.handles.size();
  }

  /// 1 or -1: the side of the line on which all handles of the clamp are; 0: they are on both.
  int side_of(const Line& line, const Clamp& clamp) const {
    double low = 0, high = 0;
    for (const int h : clamp.handles) {
      low = std::min(low, line.side(place(h)));
      high = std::max(high, line.side(place(h)));
    }
    const double near = on_line * side_;
    return high > near ? (low < -near ? 0 : 1) : low < -near ? -1 : 0;
  }

  /// The line through the two handles on it that are farthest from each other, or through the only
  /// one.
  Line through_handles(Line line) const {
    std::vector<Vector2d> on;
    for (const Handle& handle : shot_.handles)
      if (std::abs(line.side(handle.pattern)) < on_line * side_) on.push_back(handle.pattern);
    if (on.empty()) return line;
    const auto [first, last] =
        std::minmax_element(on.begin(), on.end(), [&](const Vector2d& p, const Vector2d& q) {
          return line.direction.dot(p) < line.direction.dot(q);
        });
    line.point = *first;
    if (const Vector2d along = *last - *first; along.norm() > 0.1 * side_)
      line.direction = along.normalized();
    return line;
  }

  /// The parts of the line that lie on the sheet.
  std::vector<PrescribedCrease> on_paper(const Line& line) const {
    std::vector<double> cuts;
    const auto cut = [&](const std::vector<Vector2d>& polygon) {
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vector2d p = polygon[i], q = polygon[(i + 1) % polygon.size()];
        const double sp = line.side(p), sq = line.side(q);
        if ((sp > 0) == (sq > 0)) continue;
        cuts.push_back(line.direction.dot(p + sp / (sp - sq) * (q - p) - line.point));
      }
    };
    cut(shot_.pattern.outline);
    for (const auto& hole : shot_.pattern.holes) cut(hole);
    std::sort(cuts.begin(), cuts.end());
    const auto at = [&](double s) -> Vector2d {
      const Vector2d p = line.point + s * line.direction;
      for (const Handle& handle : shot_.handles)  // an end beside a handle is the handle
        if ((handle.pattern - p).norm() < on_line * side_) return handle.pattern;
      return p;
    };
    std::vector<PrescribedCrease> parts;
    for (std::size_t k = 0; k + 1 < cuts.size(); k += 2)
      if (cuts[k + 1] - cuts[k] > same_line * side_)
        parts.push_back({{at(cuts[k]), at(cuts[k + 1])}, 0, false});
    return parts;
  }

  bool same(const PrescribedCrease& a, const PrescribedCrease& b) const {
    const auto near = [&](const Vector2d& p, const PrescribedCrease& c) {
      return distance_to_segment(p, c.line.front(), c.line.back()) < same_line * side_;
    };
    return near(a.line.front(), b) && near(a.line.back(), b);
  }

  const Shot& shot_;
  int first_, frames_ = 0;
  double side_;  // [m]
  std::vector<int> absolute_;
  std::vector<Clamp> clamps_;
};

}  // namespace

std::vector<ExpectedCrease> expected_creases(const Shot& shot, int first_frame) {
  std::vector<ExpectedCrease> expected = Clamps(shot, first_frame).folds();
  // what the artist has drawn is known already
  const double near = same_line * longer_side(shot.pattern);
  expected.erase(
      std::remove_if(expected.begin(), expected.end(),
                     [&](const ExpectedCrease& line) {
                       const Vector2d middle = 0.5 * (line.crease.line[0] + line.crease.line[1]);
                       for (const PrescribedCrease& drawn : shot.pattern.prescribed_creases)
                         for (std::size_t k = 0; k + 1 < drawn.line.size(); ++k)
                           if (distance_to_segment(middle, drawn.line[k], drawn.line[k + 1]) < near)
                             return true;
                       return false;
                     }),
      expected.end());
  return expected;
}

double largest_turn(const ExpectedCrease& crease) {
  double largest = 0;
  for (const double turn : crease.turn)
    if (std::abs(turn) > std::abs(largest)) largest = turn;
  return largest;
}

void add_expected_creases(Shot& shot, std::vector<ExpectedCrease> all) {
  std::vector<PrescribedCrease>& creases = shot.pattern.prescribed_creases;
  for (ExpectedCrease& expected : all) {
    shot.hands.push_back(
        {static_cast<int>(creases.size()), std::move(expected.turn), expected.between});
    creases.push_back(std::move(expected.crease));
  }
}

namespace {

double turn_at(const FoldingHands& hands, int row) {
  return hands.turn[std::min<std::size_t>(row, hands.turn.size() - 1)];
}

/// The row in which the hands began the turn that they have in this one.
int begin_of_turn(const FoldingHands& hands, int row) {
  while (row > 0 && !(std::abs(turn_at(hands, row)) <= first_turn)) --row;
  return row;
}

/// 1, or -1 where the paper at p lay upside down for the hands when they began, beyond folds that
/// were shut. A fold across it that is shut later carries the crease along and does not change it.
double facing(const Sheet& sheet, const std::vector<FoldingHands>& all, const FoldingHands& hands,
              const Vector2d& p, int row) {
  const int begin = begin_of_turn(hands, row);
  double sign = 1;
  for (const FoldingHands& others : all) {
    if (&others == &hands || !(std::cos(turn_at(others, begin)) < 0)) continue;
    const std::vector<Vector2d>& line = sheet.prescribed_creases[others.crease].line;
    const Vector2d along = line.back() - line.front();
    if (cross(along, p - line.front()) * cross(along, hands.between - line.front()) < 0)
      sign = -sign;
  }
  return sign;
}

}  // namespace

void fold_by_hands(Sheet& sheet, const std::vector<FoldingHands>& hands, int row) {
  if (hands.empty() || row < 0) return;

  const Hinges hinges = find_hinges(sheet.triangles);
  const std::vector<const PrescribedCrease*> lines = crease_of_hinges(sheet, hinges);
  std::vector<CreaseEdge> edges;
  for (std::size_t h = 0; h < lines.size(); ++h) {
    if (!lines[h]) continue;
    const auto& v = hinges.hinges[h].vertices;
    CreaseEdge edge =
        crease_edge(sheet, *lines[h], sheet.pattern.row(v[0]), sheet.pattern.row(v[1]));
    edge.pressed.reset();
    for (const FoldingHands& two : hands) {
      if (lines[h] != &sheet.prescribed_creases[two.crease]) continue;

      double turn = turn_at(two, row);
      if (std::isnan(turn)) continue;
      turn *= facing(sheet, hands, two, 0.5 * (edge.a + edge.b), row);

      edge.folded |= std::abs(turn) > first_turn;

      if (edge.folded) edge.pressed = turn;
    }
    edges.push_back(edge);
  }
  sheet.crease_edges = std::move(edges);
}
}  // namespace paperbake
