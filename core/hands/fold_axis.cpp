#include "core/hands/fold_axis.h"

#include "core/geometry/measure.h"
#include "core/linear_algebra/symmetric_eigen.h"
#include "core/model/degrees.h"
#include "core/model/segment2.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace paperbake {
namespace {

constexpr double straight = 0.05;    // [1] ratio of the singular values of R_a - R_b
constexpr double max_misfit = 0.02;  // [1] of the longer side
constexpr double min_rise = 0.5;     // [1] of the distance of a row from the line
constexpr double no_more = 0.02;     // [1] of a turn: one that is larger by less is no larger

class FoldAxisSearch {
 public:
  explicit FoldAxisSearch(const Clamps& clamps) : clamps_(clamps) {}

  /// The line along which the second clamp turns against the first, a plate.
  std::optional<FoldAxis> between(const Clamp& plate, const Clamp& other) const {
    if (!plate.is_plate) return std::nullopt;
    std::optional<FoldAxis> line =
        other.is_plate ? axis_of_plates(plate, other) : axis_of_row(plate, other);
    if (!line) return std::nullopt;
    // flaps beside a fold, which do not turn, hold the plate on its other side, too
    const int beyond = side_of(*line, other);
    if (beyond == 0 || side_of(*line, plate) == beyond) return std::nullopt;
    line->reach = (clamps_.middle(plate) - clamps_.middle(other)).norm();
    line->between = 0.5 * (clamps_.middle(plate) + clamps_.middle(other));
    line->plate = &plate;
    line->other = &other;
    std::vector<std::optional<Turn>> turns;
    double largest = 0;  // [rad]
    for (int row = 0; row < clamps_.rows(); ++row) {
      turns.push_back(turn_of(*line, plate, other, row));
      if (turns.back()) largest = std::max(largest, std::abs(turns.back()->angle));
    }
    const double sign = -beyond;
    double most = 0, most_of_way = 0;  // [rad]
    line->turn.assign(clamps_.rows(), std::numeric_limits<double>::quiet_NaN());
    double last = 0;
    Way way, way_to_most;
    for (int row = 0; row < clamps_.rows(); ++row) {
      const std::optional<Turn>& turn = turns[row];
      if (!turn) continue;
      const bool is_flat = turn->miss <= max_slack(*line, *turn, largest);
      way.add(*turn, is_flat);
      if (!is_flat) continue;
      line->turn[row] = last =
          sign * turn->angle + 2 * M_PI * std::round((last - sign * turn->angle) / (2 * M_PI));
      most = std::max(most, std::abs(last));
      if (most > (1 + no_more) * most_of_way) way_to_most = way, most_of_way = most;
    }
    return most < min_fold_turn || !way_to_most.is_about_the_line() ? std::nullopt : line;
  }

 private:
  /// Where a clamp is in a row, as if the paper up to the line were flat.
  struct Turn {
    double angle;  // [rad] between a plate on the left of the line and the clamp on the right
    double miss;   // [m] how far the flat paper on both sides is from meeting at the line
  };

  /// What the hands do until they have turned by so much: only if they turn about the line all
  /// the way, they fold the paper there. Hands that carry the paper along a curve, to bend it or to
  /// roll it up, may agree on a line as well in the end.
  class Way {
   public:
    void add(const Turn& turn, bool is_flat) {
      if (std::abs(turn.angle) < first_turn) return;
      ++rows_;
      flat_ += is_flat;
    }
    bool is_about_the_line() const { return flat_ >= least_share * rows_; }

   private:
    static constexpr double first_turn = radians_of(20), least_share = 0.75;
    int rows_ = 0, flat_ = 0;
  };

  /// The line on which the equations n.p = c hold, by least squares; none where they hold in one
  /// point at most.
  /// normals  sum of n n^T
  /// sum      sum of c n
  static std::optional<FoldAxis> line_through(const Eigen::Matrix2d& normals, const Vector2d& sum) {
    const SymmetricEigen<2> axes = symmetric_eigen(normals);
    const double along = axes.values[1];
    if (!(along > 0) || axes.values[0] > straight * straight * along) return std::nullopt;
    const Vector2d normal = axes.vectors.col(1);
    FoldAxis line;
    line.point = sum.dot(normal) / along * normal;
    line.direction = {-normal.y(), normal.x()};
    return line;
  }

  /// Where two plates agree in the frame of their largest turn.
  std::optional<FoldAxis> axis_of_plates(const Clamp& a, const Clamp& b) const {
    double most = 0;
    std::optional<std::pair<RigidMotion, RigidMotion>> at_most;
    for (int row = 0; row < clamps_.rows(); ++row) {
      const std::optional<RigidMotion> pa = clamps_.pose(a, row), pb = clamps_.pose(b, row);
      if (!pa || !pb) continue;
      const double turn = Eigen::AngleAxisd(pa->turn.transpose() * pb->turn).angle();
      if (turn <= most) continue;
      most = turn;
      at_most = {*pa, *pb};
    }
    if (most < min_fold_turn) return std::nullopt;
    const auto& [pa, pb] = *at_most;
    // both take a point p of the line to the same place: M p + d = 0
    const Eigen::Matrix<double, 3, 2> M = (pa.turn - pb.turn).leftCols<2>();
    const Vector3d d = pa.shift - pb.shift;
    std::optional<FoldAxis> line = line_through(M.transpose() * M, -M.transpose() * d);
    if (line && line->direction.x() < 0) line->direction *= -1;  // whatever the rounding
    return line;
  }

  /// Where a handle is, seen from a plate: its pattern is the plane z = 0. [m]
  Vector3d seen_from(const RigidMotion& plate, int h, int row) const {
    return plate.turn.transpose() * (clamps_.keyed(h, row) - plate.shift);
  }

  /// The points p of the plate whose distance from every handle stays that of the pattern,
  ///
  ///   2 p.(a - q_xy) = |a|^2 - |q|^2,
  ///
  /// where a is the handle on the pattern and q is where it goes: of each handle a line, in the
  /// frame in which the handles are farthest from where a flat sheet would have them.
  std::optional<FoldAxis> axis_of_row(const Clamp& plate, const Clamp& handles) const {
    double most = 0, highest = 0;
    Eigen::Matrix2d normals = Eigen::Matrix2d::Zero();
    Vector2d sum(0, 0);  // of c n, where n.p = c
    for (int row = 0; row < clamps_.rows(); ++row) {
      const std::optional<RigidMotion> from = clamps_.pose(plate, row);
      if (!from || !clamps_.pose(handles, row)) continue;
      Eigen::Matrix2d normals_now = Eigen::Matrix2d::Zero();
      Vector2d sum_now(0, 0);
      for (const int h : handles.handles) {
        const Vector3d q = seen_from(*from, h, row);
        const Vector2d a = clamps_.place(h), n = 2 * (a - q.head<2>());
        highest = std::max(highest, std::abs(q.z()));
        normals_now += n * n.transpose();
        sum_now += (a.squaredNorm() - q.squaredNorm()) * n;
      }
      if (normals_now.trace() > most)
        most = normals_now.trace(), normals = normals_now, sum = sum_now;
    }
    std::optional<FoldAxis> line = line_through(normals, sum);
    // handles that stay near the plane do not turn: they push the paper together
    if (line && highest < min_rise * std::abs(line->side(clamps_.middle(handles))))
      return std::nullopt;
    return line;
  }

  /// The turn of a clamp against the plate, in the first half of a turn to either side; none: one
  /// of them does not hold.
  std::optional<Turn> turn_of(const FoldAxis& line, const Clamp& plate, const Clamp& other,
                              int row) const {
    const std::optional<RigidMotion> left = clamps_.pose(plate, row);
    if (!left) return std::nullopt;
    if (other.is_plate) {
      const std::optional<RigidMotion> right = clamps_.pose(other, row);
      if (!right) return std::nullopt;
      const Vector2d at =
          line.point + line.direction.dot(line.between - line.point) * line.direction;
      const Vector3d along = left->turn.leftCols<2>() * line.direction, nl = left->turn.col(2),
                     nr = right->turn.col(2);
      const double turn = angle_about(along, nl, nr);
      return Turn{
          turn,
          ((left->turn - right->turn).leftCols<2>() * at + left->shift - right->shift).norm()};
    }
    Vector2d arm(0, 0);  // [m] away from the line in the plate, and along its normal
    double miss = 0;
    for (const int h : other.handles) {
      if (!clamps_.held(h, row)) return std::nullopt;
      const Vector3d q = seen_from(*left, h, row);
      const double reach = std::abs(line.side(clamps_.place(h))),
                   out = line.side(q.head<2>()) * (line.side(clamps_.place(h)) < 0 ? -1 : 1);
      const double slide = (q.head<2>() - clamps_.place(h)).dot(line.direction);
      miss = std::max({miss, std::abs(std::hypot(out, q.z()) - reach), std::abs(slide)});
      arm += Vector2d(out, q.z());
    }
    return Turn{side_of(line, other) * std::atan2(arm.y(), arm.x()), miss};
  }

  /// [m] By how much the flat paper may miss the line where hands fold it: a quarter of what a
  /// sheet of length l between them would that bends evenly. Between two plates, that is about
  /// l turn/8. A row says nothing of the plane that it holds: on the arc of such a sheet, it misses
  /// the line that fits the end of its way, where it has turned by `largest`, by up to about
  /// 0.0041 l (largest/79 deg)^4.4 (fitted to arcs that end at 72 to 160 degrees).
  double max_slack(const FoldAxis& line, const Turn& turn, double largest) const {
    constexpr double rounding = 1e-4;  // [1] of the longer side
    const double bent = line.other->is_plate ? std::abs(turn.angle) / 8
                                             : 0.0041 * std::pow(largest / radians_of(79), 4.4);
    return std::min(max_misfit * clamps_.side(),
                    rounding * clamps_.side() + 0.25 * bent * line.reach);
  }

  /// 1 or -1: the side of the line on which all handles of the clamp are; 0: they are on both.
  int side_of(const FoldAxis& line, const Clamp& clamp) const {
    double low = 0, high = 0;
    for (const int h : clamp.handles) {
      low = std::min(low, line.side(clamps_.place(h)));
      high = std::max(high, line.side(clamps_.place(h)));
    }
    const double near = on_line * clamps_.side();
    return high > near ? (low < -near ? 0 : 1) : low < -near ? -1 : 0;
  }

  const Clamps& clamps_;
};

}  // namespace

double FoldAxis::side(const Vector2d& p) const { return cross(direction, p - point); }

std::optional<FoldAxis> fold_axis(const Clamps& clamps, const Clamp& plate, const Clamp& other) {
  return FoldAxisSearch(clamps).between(plate, other);
}

}  // namespace paperbake
