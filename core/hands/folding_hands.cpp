#include "core/hands/folding_hands.h"

#include "core/geometry/hinges.h"
#include "core/geometry/prescribed_creases.h"
#include "core/hands/gussets.h"
#include "core/model/degrees.h"

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

constexpr double first_turn = radians_of(3);  // from which on a crease is folded

/// 1, or -1 where the paper at p lay upside down for the hands when they began, beyond folds that
/// were shut. A fold across it that is shut later carries the crease along and does not change it.
double facing(const std::vector<FoldingHands>& all, const FoldingHands& hands, const Vector2d& p,
              int row) {
  const int begin = begin_of_turn(hands.turn, row);
  double sign = 1;
  for (const FoldingHands& others : all)
    if (&others != &hands && !others.beyond && std::cos(turn_at(others.turn, begin)) < 0 &&
        crosses({hands.between, p}, others.line))
      sign = -sign;
  return sign;
}

/// The turn in a row, or the last one before it that is known.
double last_turn(const FoldingHands& hands, int row) {
  while (row > 0 && std::isnan(turn_at(hands.turn, row))) --row;
  return turn_at(hands.turn, row);
}

/// The hands of other lines that bar the way of a line: it cannot go straight on beyond them, and
/// paper that no hand holds has to turn there (gussets.h).
std::vector<const FoldingHands*> barring(const std::vector<FoldingHands>& all,
                                         const FoldingHands& hands, int row) {
  std::vector<const FoldingHands*> found;
  for (const FoldingHands& others : all) {
    const bool has_gusset = std::any_of(all.begin(), all.end(), [&](const FoldingHands& part) {
      return part.beyond && &all[part.beyond->own] == &hands &&
             &all[part.beyond->others] == &others;
    });
    if (others.beyond || !has_gusset) continue;
    const double turn = last_turn(others, row);
    if (!std::isnan(turn) && !goes_straight_on(turn_at(hands.turn, row), turn))
      found.push_back(&others);
  }
  return found;
}

/// Lets hands press an edge of their line, or paper turn there because of other hands.
/// bars  the hands that bar the way of the line
void press(CreaseEdge& edge, const std::vector<FoldingHands>& all, const FoldingHands& hands,
           const std::vector<const FoldingHands*>& bars, int row) {
  const Vector2d middle = 0.5 * (edge.a + edge.b);
  const auto is_beyond = [&](const FoldingHands& others) {
    return separates(others.line, hands.between, middle);
  };
  double turn = turn_at(hands.turn, row);
  if (hands.beyond) {
    if (is_beyond(all[hands.beyond->others])) return;
    edge.folded = true;
  } else {
    edge.folded |= std::abs(turn) > first_turn || !bars.empty();
    if (std::any_of(bars.begin(), bars.end(),
                    [&](const FoldingHands* others) { return is_beyond(*others); }))
      return;  // it has to turn some other way there
    turn *= facing(all, hands, middle, row);
  }
  if (edge.folded) edge.pressed = turn;
}

}  // namespace

double turn_at(const std::vector<double>& turn, int row) {
  return turn[std::min<std::size_t>(row, turn.size() - 1)];
}

int begin_of_turn(const std::vector<double>& turn, int row) {
  while (row > 0 && !(std::abs(turn_at(turn, row)) <= first_turn)) --row;
  return row;
}

void fold_by_hands(Sheet& sheet, const std::vector<FoldingHands>& hands, int row) {
  if (hands.empty() || row < 0) return;
  const Hinges hinges = find_hinges(sheet.triangles);
  const std::vector<const PrescribedCrease*> lines = crease_of_hinges(sheet, hinges);
  std::vector<CreaseEdge> edges;
  for (std::size_t h = 0; h < lines.size(); ++h) {
    if (!lines[h]) continue;
    const auto& v = hinges.hinges[h].vertices;
    edges.push_back(
        crease_edge(sheet, *lines[h], sheet.pattern.row(v[0]), sheet.pattern.row(v[1])));
    edges.back().pressed.reset();
  }
  for (const FoldingHands& two : hands) {
    if (std::isnan(turn_at(two.turn, row))) continue;
    const std::vector<const FoldingHands*> bars = barring(hands, two, row);
    for (CreaseEdge& edge : edges)
      if (std::any_of(two.parts.begin(), two.parts.end(), [&](const Segment2& part) {
            return is_part({edge.a, edge.b}, part);
          }))
        press(edge, hands, two, bars, row);
  }
  sheet.crease_edges = std::move(edges);
}

}  // namespace paperbake
