#include "core/animation/expected_creases.h"

#include "core/animation/fold_axis.h"
#include "core/animation/gussets.h"
#include "core/model/segment2.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace paperbake {
namespace {

constexpr double same_line = 0.01;  // [1] of the longer side

/// The axes about which the clamps of a shot turn against each other. Neighbours come first: clamps
/// with others between them may agree on a line by chance.
std::vector<FoldAxis> axes_of(const Clamps& clamps) {
  std::vector<FoldAxis> axes;
  for (std::size_t a = 0; a < clamps.all().size(); ++a)
    for (std::size_t b = 0; b < a; ++b) {
      const Clamp &one = clamps.all()[a], &two = clamps.all()[b];
      std::optional<FoldAxis> axis = fold_axis(clamps, one, two);
      if (!axis) axis = fold_axis(clamps, two, one);
      if (axis) axes.push_back(*axis);
    }
  std::sort(axes.begin(), axes.end(),
            [](const FoldAxis& a, const FoldAxis& b) { return a.reach < b.reach; });
  return axes;
}

/// Whether the artist has drawn a crease through the middle of this one.
bool is_drawn(const ExpectedCrease& line, const Pattern& pattern) {
  const double near = same_line * longer_side(pattern);
  const Vector2d middle = 0.5 * (line.crease.line[0] + line.crease.line[1]);
  for (const PrescribedCrease& drawn : pattern.prescribed_creases)
    for (std::size_t k = 0; k + 1 < drawn.line.size(); ++k)
      if (distance_to_segment(middle, drawn.line[k], drawn.line[k + 1]) < near) return true;
  return false;
}

/// The line through the two handles on it that are farthest from each other, or through the only
/// one.
FoldAxis through_handles(FoldAxis line, const Shot& shot) {
  const double side = longer_side(shot.pattern);
  std::vector<Vector2d> on;
  for (const Handle& handle : shot.handles)
    if (std::abs(line.side(handle.pattern)) < on_line * side) on.push_back(handle.pattern);
  if (on.empty()) return line;
  const auto [first, last] =
      std::minmax_element(on.begin(), on.end(), [&](const Vector2d& p, const Vector2d& q) {
        return line.direction.dot(p) < line.direction.dot(q);
      });
  line.point = *first;
  if (const Vector2d along = *last - *first; along.norm() > 0.1 * side)
    line.direction = along.normalized();
  return line;
}

/// The parts of the line that lie on the sheet.
std::vector<PrescribedCrease> on_paper(const FoldAxis& line, const Shot& shot) {
  const double side = longer_side(shot.pattern);
  std::vector<double> cuts;
  const auto cut = [&](const std::vector<Vector2d>& polygon) {
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vector2d p = polygon[i], q = polygon[(i + 1) % polygon.size()];
      const double sp = line.side(p), sq = line.side(q);
      if ((sp > 0) == (sq > 0)) continue;
      cuts.push_back(line.direction.dot(p + sp / (sp - sq) * (q - p) - line.point));
    }
  };
  cut(shot.pattern.outline);
  for (const auto& hole : shot.pattern.holes) cut(hole);
  std::sort(cuts.begin(), cuts.end());
  const auto at = [&](double s) -> Vector2d {
    const Vector2d p = line.point + s * line.direction;
    for (const Handle& handle : shot.handles)  // an end beside a handle is the handle
      if ((handle.pattern - p).norm() < on_line * side) return handle.pattern;
    return p;
  };
  std::vector<PrescribedCrease> parts;
  for (std::size_t k = 0; k + 1 < cuts.size(); k += 2)
    if (cuts[k + 1] - cuts[k] > same_line * side)
      parts.push_back({{at(cuts[k]), at(cuts[k + 1])}, 0, false});
  return parts;
}

bool is_same_line(const PrescribedCrease& a, const PrescribedCrease& b, double side) {
  const auto near = [&](const Vector2d& p, const PrescribedCrease& c) {
    return distance_to_segment(p, c.line.front(), c.line.back()) < same_line * side;
  };
  return near(a.line.front(), b) && near(a.line.back(), b);
}

}  // namespace

std::vector<ExpectedCrease> expected_creases(const Shot& shot, int first_frame) {
  const Clamps clamps(shot, first_frame);
  using By = ExpectedCrease::By;
  std::vector<ExpectedCrease> expected;
  const auto is_known = [&](const PrescribedCrease& line) {
    return std::any_of(expected.begin(), expected.end(), [&](const ExpectedCrease& known) {
      return is_same_line(known.crease, line, clamps.side());
    });
  };
  for (const FoldAxis& axis : axes_of(clamps))
    for (PrescribedCrease& part : on_paper(through_handles(axis, shot), shot))
      if (!is_known(part))
        expected.push_back({std::move(part),
                            axis.other->is_plate ? By::two_plates : By::plate_and_row,
                            axis.turn,
                            axis.between,
                            {},
                            axis.plate->handles,
                            axis.other->handles});
  expected.erase(
      std::remove_if(expected.begin(), expected.end(),
                     [&](const ExpectedCrease& line) { return is_drawn(line, shot.pattern); }),
      expected.end());
  for (ExpectedCrease& gusset : gussets(shot, clamps, expected))
    if (!is_drawn(gusset, shot.pattern) && !is_known(gusset.crease))
      expected.push_back(std::move(gusset));
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
  const int first = static_cast<int>(creases.size());
  for (ExpectedCrease& expected : all) {
    FoldingHands hands{static_cast<int>(creases.size()), std::move(expected.turn),
                       expected.between};
    if (expected.by == ExpectedCrease::By::folds_that_cross) {
      hands.beyond = first + expected.beyond[0].line;
      for (TurnBeyond& part : expected.beyond)
        shot.hands.push_back(
            {first + part.line, std::move(part.turn), part.at, first + part.across});
    }
    shot.hands.push_back(std::move(hands));
    creases.push_back(std::move(expected.crease));
  }
}

}  // namespace paperbake
