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

/// The straight parts of drawn creases that run along a line, each in its direction, in order.
std::vector<Segment2> drawn_along(const Segment2& line, const Pattern& pattern) {
  constexpr double same_direction = 0.99;  // [1] cosine
  const double near = same_line * longer_side(pattern);
  const Vector2d direction = (line.b - line.a).normalized();
  const auto is_near = [&](const Vector2d& p) {
    return std::abs(cross(direction, p - line.a)) < near;
  };
  std::vector<Segment2> parts;
  for (const PrescribedCrease& drawn : pattern.prescribed_creases)
    for (std::size_t k = 0; k + 1 < drawn.line.size(); ++k) {
      Segment2 part{drawn.line[k], drawn.line[k + 1]};
      const Vector2d along = part.b - part.a;
      if (direction.dot(along) < 0) std::swap(part.a, part.b);
      if (is_near(part.a) && is_near(part.b) &&
          std::abs(direction.dot(along)) > same_direction * along.norm())
        parts.push_back(part);
    }
  std::sort(parts.begin(), parts.end(), [&](const Segment2& a, const Segment2& b) {
    return direction.dot(a.a) < direction.dot(b.a);
  });
  return parts;
}

/// The line through what is drawn along it; if nothing is, through the two handles on it that are
/// farthest from each other, or through the only one.
FoldAxis through_known_points(FoldAxis line, const Shot& shot) {
  const double side = longer_side(shot.pattern);
  std::vector<Vector2d> on;
  for (const Segment2& part : drawn_along({line.point, line.point + line.direction}, shot.pattern))
    on.insert(on.end(), {part.a, part.b});
  if (on.empty())
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
std::vector<Segment2> on_paper(const FoldAxis& line, const Shot& shot) {
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
  std::vector<Segment2> parts;
  for (std::size_t k = 0; k + 1 < cuts.size(); k += 2)
    if (cuts[k + 1] - cuts[k] > same_line * side) parts.push_back({at(cuts[k]), at(cuts[k + 1])});
  return parts;
}

/// Finds what the artist has drawn along a line, and what is missing between.
void look_for_drawn(ExpectedCrease& crease, const Pattern& pattern) {
  const double near = same_line * longer_side(pattern);
  const Vector2d from = crease.line.a, to = crease.line.b;
  const Vector2d direction = (to - from).normalized();
  Vector2d end = from;  // of what there is
  const auto look_until = [&](const Vector2d& p) {
    if (direction.dot(p - end) > near) crease.missing.push_back({end, p});
  };
  for (const Segment2& part : drawn_along(crease.line, pattern)) {
    if (direction.dot(part.b - from) < near || direction.dot(to - part.a) < near) continue;
    crease.drawn.push_back(part);
    look_until(part.a);
    if (direction.dot(part.b - end) > 0) end = part.b;
  }
  look_until(to);
}

bool is_same_line(const Segment2& a, const Segment2& b, double side) {
  const auto near = [&](const Vector2d& p) {
    return distance_to_segment(p, b.a, b.b) < same_line * side;
  };
  return near(a.a) && near(a.b);
}

}  // namespace

std::vector<ExpectedCrease> expected_creases(const Shot& shot, int first_frame) {
  const Clamps clamps(shot, first_frame);
  using By = ExpectedCrease::By;
  std::vector<ExpectedCrease> expected;
  const auto is_known = [&](const Segment2& line) {
    return std::any_of(expected.begin(), expected.end(), [&](const ExpectedCrease& known) {
      return is_same_line(known.line, line, clamps.side());
    });
  };
  for (const FoldAxis& axis : axes_of(clamps))
    for (const Segment2& part : on_paper(through_known_points(axis, shot), shot))
      if (!is_known(part))
        expected.push_back({part,
                            {},
                            {},
                            axis.other->is_plate ? By::two_plates : By::plate_and_row,
                            axis.turn,
                            axis.between,
                            {},
                            axis.plate->handles,
                            axis.other->handles});
  for (ExpectedCrease& gusset : gussets(shot, clamps, expected))
    if (!is_known(gusset.line)) expected.push_back(std::move(gusset));
  for (ExpectedCrease& crease : expected) look_for_drawn(crease, shot.pattern);
  return expected;
}

double largest_turn(const ExpectedCrease& crease) {
  double largest = 0;
  for (const double turn : crease.turn)
    if (std::abs(turn) > std::abs(largest)) largest = turn;
  return largest;
}

void add_expected_creases(Shot& shot, std::vector<ExpectedCrease> all) {
  const int first = static_cast<int>(shot.hands.size());
  for (ExpectedCrease& expected : all) {
    for (const Segment2& part : expected.missing)
      shot.pattern.prescribed_creases.push_back({{part.a, part.b}, 0, false});
    FoldingHands hands{expected.line, std::move(expected.drawn), std::move(expected.turn),
                       expected.between};
    hands.parts.insert(hands.parts.end(), expected.missing.begin(), expected.missing.end());
    if (expected.by == ExpectedCrease::By::folds_that_cross)
      hands.beyond = {static_cast<int>(shot.hands.size()), first + expected.beyond[0].line};
    shot.hands.push_back(std::move(hands));
  }
  for (ExpectedCrease& gusset : all) {
    if (gusset.by != ExpectedCrease::By::folds_that_cross) continue;
    for (TurnBeyond& part : gusset.beyond) {
      FoldingHands paper = shot.hands[first + part.line];
      paper.turn = std::move(part.turn);
      paper.between = part.at;
      paper.beyond = {first + part.line, first + part.across};
      shot.hands.push_back(std::move(paper));
    }
  }
}

}  // namespace paperbake
