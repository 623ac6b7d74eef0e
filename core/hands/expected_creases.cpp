#include "core/hands/expected_creases.h"

#include "core/geometry/line_fold.h"
#include "core/hands/fold_axis.h"
#include "core/hands/folded_through.h"
#include "core/hands/gussets.h"
#include "core/hands/known_handles.h"
#include "core/model/segment2.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

namespace paperbake {
namespace {

// [1] of the longer side
constexpr double same_line = 0.01, same_place = 1e-4;

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
  std::stable_sort(axes.begin(), axes.end(),
                   [](const FoldAxis& a, const FoldAxis& b) { return a.reach < b.reach; });
  return axes;
}

/// Where a corner of a crease goes that is drawn within `near` [m] of a line: onto the line, or to
/// one of its ends. Nothing: it is not as near.
std::optional<Vector2d> place_on(const Segment2& line, const Vector2d& p, double near) {
  const double length = (line.b - line.a).norm();
  const Vector2d direction = (line.b - line.a) / length;
  const double along = direction.dot(p - line.a);
  if (std::abs(cross(direction, p - line.a)) > near || along < -near || along > length + near)
    return std::nullopt;
  if (along < near) return line.a;
  return along > length - near ? line.b : Vector2d(line.a + along * direction);
}

/// The part of a line along which a segment is drawn, to within `near` [m], in the direction of the
/// line; nothing: it runs elsewhere.
std::optional<Segment2> part_along(const Segment2& line, const Segment2& drawn, double near) {
  constexpr double same_direction = 0.99;  // [1] cosine
  const Vector2d along = drawn.b - drawn.a, direction = (line.b - line.a).normalized();
  const std::optional<Vector2d> a = place_on(line, drawn.a, near),
                                b = place_on(line, drawn.b, near);
  if (!a || !b || *a == *b || std::abs(direction.dot(along)) < same_direction * along.norm())
    return std::nullopt;
  return direction.dot(along) > 0 ? Segment2{*a, *b} : Segment2{*b, *a};
}

// [1] of the longer side: so near to its line is a handle on it that goes with one of the clamps
constexpr double on_own_line = 3e-4;

/// Whether a handle so far from a line [m] is taken for a point of it. One that goes with a clamp
/// stays in its place on that clamp: were the line moved onto it, one flap would be longer than the
/// way from the line to its hand, and bulge. Slack s in a flap of length L makes it
/// (2/pi) (s L)^1/2 high.
bool is_point_of(const FoldAxis& line, int handle, double distance, const Clamps& clamps) {
  const double near = on_own_line * clamps.side();
  if (distance < near || distance >= on_line * clamps.side()) return distance < near;
  int row = 0;
  double most = 0;
  for (int r = 0; r < static_cast<int>(line.turn.size()); ++r)
    if (std::abs(line.turn[r]) > most) most = std::abs(line.turn[row = r]);
  const Vector2d p = clamps.place(handle);
  const auto goes_with = [&](const Clamp& clamp) {
    if (std::find(clamp.handles.begin(), clamp.handles.end(), handle) != clamp.handles.end())
      return true;
    if (!clamp.is_plate || !clamps.held(handle, row)) return false;
    const std::optional<RigidMotion> pose = clamps.pose(clamp, row);
    return pose && (clamps.keyed(handle, row) - (*pose)({p.x(), p.y(), 0})).norm() < near;
  };
  return !goes_with(*line.plate) && !goes_with(*line.other);
}

/// The line through the two handles on it that are farthest from each other, or through the only
/// one.
FoldAxis through_handles(FoldAxis line, const Clamps& clamps, const Shot& shot) {
  const double side = longer_side(shot.pattern);
  std::vector<Vector2d> on;
  for (std::size_t h = 0; h < shot.handles.size(); ++h)
    if (const Vector2d& p = shot.handles[h].pattern;
        is_point_of(line, static_cast<int>(h), std::abs(line.side(p)), clamps))
      on.push_back(p);
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

/// The parts of the line that have paper on both sides: those along the border have not.
std::vector<Segment2> on_paper(const FoldAxis& line, const Clamps& clamps, const Shot& shot) {
  const double side = longer_side(shot.pattern), on_border = 1e-4 * side;
  std::vector<double> cuts;
  const auto cut = [&](const std::vector<Vector2d>& polygon) {
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vector2d p = polygon[i], q = polygon[(i + 1) % polygon.size()];
      const double sp = line.side(p), sq = line.side(q);
      if (std::abs(sp) <= on_border)
        cuts.push_back(line.direction.dot(p - line.point));
      else if (std::abs(sq) > on_border && (sp > 0) != (sq > 0))
        cuts.push_back(line.direction.dot(p + sp / (sp - sq) * (q - p) - line.point));
    }
  };
  cut(shot.pattern.outline);
  for (const auto& hole : shot.pattern.holes) cut(hole);
  std::sort(cuts.begin(), cuts.end());
  const auto place = [&](double s) -> Vector2d { return line.point + s * line.direction; };
  const auto at = [&](double s) {
    for (std::size_t h = 0; h < shot.handles.size(); ++h)  // an end beside a handle is the handle
      if (const Vector2d& p = shot.handles[h].pattern;
          is_point_of(line, static_cast<int>(h), (p - place(s)).norm(), clamps))
        return p;
    return place(s);
  };
  const Vector2d across = 2 * on_border * Vector2d(-line.direction.y(), line.direction.x());
  const auto is_paper = [&](double from, double to) {
    const Vector2d middle = place(0.5 * (from + to));
    return contains(shot.pattern, middle + across) && contains(shot.pattern, middle - across);
  };
  std::vector<Segment2> parts;
  for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
    const double from = cuts[k];
    while (k + 1 < cuts.size() && is_paper(cuts[k], cuts[k + 1])) ++k;
    if (cuts[k] - from > same_line * side) parts.push_back({at(from), at(cuts[k])});
  }
  return parts;
}

/// A pattern that is cut in two along a segment, from one point of its outline to another.
class CutPattern {
 public:
  CutPattern(const Pattern& pattern, const Segment2& cut)
      : cut_(cut), near_(on_line * longer_side(pattern)) {
    const std::size_t from = edge_at(pattern, cut.a), to = edge_at(pattern, cut.b),
                      n = pattern.outline.size();
    if (from == n || to == n || from == to) return;
    part_.outline = {cut.a};
    for (std::size_t i = (from + 1) % n; i != (to + 1) % n; i = (i + 1) % n)
      part_.outline.push_back(pattern.outline[i]);
    part_.outline.push_back(cut.b);
    const Vector2d off = cut.b - cut.a;
    left_ = contains(part_, 0.5 * (cut.a + cut.b) + 1e-3 * Vector2d(-off.y(), off.x())) ? 1 : -1;
  }

  /// How two sets of points are separated: by the cut itself, or by the line through it.
  enum class By { cut, line };

  /// 1 or -1: the side on which all these points are; 0: they are on both. A cut that ends at a
  /// hole separates as its line does.
  int side_of(const std::vector<Vector2d>& points, By by) const {
    bool left = false, right = false;
    for (const Vector2d& p : points)
      if (distance_to_segment(p, cut_.a, cut_.b) > near_) (is_left(p, by) ? left : right) = true;
    return left == right ? 0 : left ? 1 : -1;
  }

 private:
  /// The edge of the outline on which a point lies; the number of edges if on none.
  static std::size_t edge_at(const Pattern& pattern, const Vector2d& p) {
    const double near = 2e-3 * longer_side(pattern);
    const std::vector<Vector2d>& all = pattern.outline;
    std::size_t best = all.size();
    double least = near;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (const double off = distance_to_segment(p, all[i], all[(i + 1) % all.size()]);
          off < least) {
        best = i;
        least = off;
      }
    return best;
  }
  bool is_left(const Vector2d& p, By by) const {
    if (by == By::line || part_.outline.empty()) return cross(cut_.b - cut_.a, p - cut_.a) > 0;
    return contains(part_, p, near_) == (left_ > 0);
  }

  Segment2 cut_;
  double near_;  // [m] points this near to the cut are on neither side
  Pattern part_{};
  int left_ = 1;  // whether that part is on the left of the cut
};

/// Whether a clamp holds in a frame in which those of the axis have folded the paper.
bool holds_while_folded(const Clamp& clamp, const FoldAxis& axis, const Clamps& clamps) {
  for (std::size_t row = 0; row < axis.turn.size(); ++row)
    if (std::abs(axis.turn[row]) > min_fold_turn && clamps.pose(clamp, static_cast<int>(row)))
      return true;
  return false;
}

/// The mirror image of a point in the straight line through a segment.
Vector2d mirror_image(const Vector2d& p, const Segment2& line) {
  const Vector2d along = (line.b - line.a).normalized(), off = p - line.a;
  return line.a + 2 * along.dot(off) * along - off;
}

/// Whether a fold runs along a line, as the other parts of a line that holes divide do.
bool runs_along(const Segment2& fold, const Segment2& line) {
  const Vector2d along = (line.b - line.a).normalized();
  const auto off = [&](const Vector2d& p) { return std::abs(cross(along, p - line.a)); };
  return std::max(off(fold.a), off(fold.b)) < same_line * (line.b - line.a).norm();
}

/// Where a point of the pattern lies in the layer that hands turn: it goes there through the folds
/// that are shut by then, from one layer to the next.
Vector2d in_layer_of(const ExpectedCrease& hands, Vector2d p,
                     const std::vector<ExpectedCrease>& folds) {
  constexpr int most_layers = 16;
  for (int layer = 0; layer < most_layers; ++layer) {
    double farthest = 0;  // [1] of the way from the hands to p
    const ExpectedCrease* next = nullptr;
    for (const ExpectedCrease& fold : folds)
      if (const auto met = meeting({hands.between, p}, fold.line);
          met && !runs_along(fold.line, hands.line) && *met > farthest && *met < 1 &&
          is_shut_before(fold, hands)) {
        farthest = *met;
        next = &fold;
      }
    if (!next) break;
    p = mirror_image(p, next->line);
  }
  return p;
}

/// Whether the line of two hands separates their clamps, and no other clamp keeps the paper flat
/// across it while they fold it. The line separates flaps beside each other that fold together.
/// folds  that are known
bool is_between(const ExpectedCrease& hands, const FoldAxis& axis, const Clamps& clamps,
                const Pattern& pattern, CutPattern::By by,
                const std::vector<ExpectedCrease>& folds) {
  using By = CutPattern::By;
  const CutPattern cut(pattern, hands.line);
  const auto side_of = [&](const Clamp& clamp, By how) {
    std::vector<Vector2d> points;
    for (const int h : clamp.handles) points.push_back(in_layer_of(hands, clamps.place(h), folds));
    return cut.side_of(points, how);
  };
  return side_of(*axis.plate, by) * side_of(*axis.other, by) < 0 &&
         std::none_of(clamps.all().begin(), clamps.all().end(), [&](const Clamp& clamp) {
           return side_of(clamp, By::cut) == 0 && side_of(clamp, By::line) == 0 &&
                  holds_while_folded(clamp, axis, clamps);
         });
}

/// Whether a crease is none, because another one lies between it and one of its clamps: what turns
/// there is the paper beyond that one, and not the clamp.
bool is_beyond(const ExpectedCrease& crease, const ExpectedCrease& nearer, const Clamps& clamps,
               const Pattern& pattern) {
  const auto folds = [&](const std::vector<int>& clamp) {
    return clamp == nearer.plate || clamp == nearer.other;
  };
  if (folds(crease.plate) && folds(crease.other)) return false;
  const CutPattern cut(pattern, nearer.line);
  const auto by = CutPattern::By::cut;
  const int side = cut.side_of({crease.line.a, crease.line.b}, by);
  const auto is_cut_off = [&](const std::vector<int>& clamp) {
    if (!folds(clamp)) return false;
    std::vector<Vector2d> points;
    for (const int h : clamp) points.push_back(clamps.place(h));
    return cut.side_of(points, by) * side < 0;
  };
  return is_cut_off(crease.plate) || is_cut_off(crease.other);
}

/// Creases that end beside each other on the border, or beside a corner of it, end at one point.
/// Folds that meet there have axes from the keys of several hands, which hardly agree to the tenth
/// of a millimetre; paper cannot fold along lines that miss each other by so little, and the mesh
/// between them would have slivers.
/// fixed  the ends of so many creases, the first ones, stay where they are
void join_ends(std::vector<ExpectedCrease>& creases, std::size_t fixed, const Pattern& pattern) {
  const double near = on_line * longer_side(pattern);
  std::vector<Vector2d> known = pattern.outline;
  std::vector<Vector2d*> open;
  for (std::size_t k = 0; k < creases.size(); ++k)
    for (Vector2d* end : {&creases[k].line.a, &creases[k].line.b}) {
      const auto there = std::find_if(known.begin(), known.end(),
                                      [&](const Vector2d& p) { return (p - *end).norm() < near; });
      if (k < fixed)
        known.push_back(*end);
      else if (there != known.end())
        *end = *there;
      else
        open.push_back(end);
    }
  while (!open.empty()) {
    std::vector<Vector2d*> together{open.back()};
    open.pop_back();
    for (std::size_t k = 0; k < together.size(); ++k) {
      const auto apart = [&](const Vector2d* end) { return (*end - *together[k]).norm() >= near; };
      const auto others = std::stable_partition(open.begin(), open.end(), apart);
      together.insert(together.end(), others, open.end());
      open.erase(others, open.end());
    }
    if (together.size() == 1) continue;
    Vector2d sum = Vector2d::Zero();
    for (const Vector2d* end : together) sum += *end;
    for (Vector2d* end : together) *end = sum / together.size();
  }
}

/// Finds what the artist has drawn along a line, and what is missing between.
void look_for_drawn(ExpectedCrease& crease, const Pattern& pattern) {
  const double near = same_line * longer_side(pattern);
  for (std::size_t c = 0; c < pattern.prescribed_creases.size(); ++c) {
    const std::vector<Vector2d>& drawn = pattern.prescribed_creases[c].line;
    const std::size_t before = crease.drawn.size();
    for (std::size_t k = 0; k + 1 < drawn.size(); ++k)
      if (const auto part = part_along(crease.line, {drawn[k], drawn[k + 1]}, near))
        crease.drawn.push_back(*part);
    if (crease.drawn.size() > before) crease.creases.push_back(static_cast<int>(c));
  }
  const Vector2d direction = (crease.line.b - crease.line.a).normalized();
  const auto at = [&](const Vector2d& p) { return direction.dot(p - crease.line.a); };
  std::sort(crease.drawn.begin(), crease.drawn.end(),
            [&](const Segment2& a, const Segment2& b) { return at(a.a) < at(b.a); });
  Vector2d end = crease.line.a;  // of what there is
  const auto look_until = [&](const Vector2d& p) {
    if (at(p) - at(end) > near) crease.missing.push_back({end, p});
  };
  for (const Segment2& part : crease.drawn) {
    look_until(part.a);
    if (at(part.b) > at(end)) end = part.b;
  }
  look_until(crease.line.b);
}

/// A segment of a crease that is drawn along a line.
struct DrawnAlong {
  double from, to;           // [m] along the line, where it begins and ends
  double beside, beside_to;  // [m] from the line there, positive on its left
  bool is_at(double along) const { return from <= along && along <= to; }
  double beside_at(double along) const {
    return beside + (along - from) / (to - from) * (beside_to - beside);
  }
};

std::vector<DrawnAlong> drawn_along(const Segment2& line, const Pattern& pattern) {
  const Vector2d direction = (line.b - line.a).normalized();
  std::vector<DrawnAlong> all;
  for (const PrescribedCrease& crease : pattern.prescribed_creases)
    for (std::size_t k = 0; k + 1 < crease.line.size(); ++k) {
      Segment2 drawn{crease.line[k], crease.line[k + 1]};
      if (!part_along(line, drawn, same_line * longer_side(pattern))) continue;
      if (direction.dot(drawn.b - drawn.a) < 0) std::swap(drawn.a, drawn.b);
      all.push_back({direction.dot(drawn.a - line.a), direction.dot(drawn.b - line.a),
                     cross(direction, drawn.a - line.a), cross(direction, drawn.b - line.a)});
    }
  return all;
}

/// Whether creases are drawn along a line, and along most of what they cover two of them beside
/// each other.
bool is_between_two_drawn(const Segment2& line, const Pattern& pattern) {
  const std::vector<DrawnAlong> all = drawn_along(line, pattern);
  constexpr int samples = 128;
  int covered = 0, twice = 0;
  for (int k = 0; k < samples; ++k) {
    const double along = (k + 0.5) / samples * (line.b - line.a).norm();
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const DrawnAlong& drawn : all)
      if (drawn.is_at(along)) {
        low = std::min(low, drawn.beside_at(along));
        high = std::max(high, drawn.beside_at(along));
      }
    covered += low <= high;
    twice += high - low > on_line * longer_side(pattern);
  }
  return twice > 0.5 * covered;
}

/// Adds the frames in which other hands fold along a line that is known, and the first ones do not
/// hold.
void add_turn(ExpectedCrease& crease, const ExpectedCrease& other) {
  for (std::size_t row = 0; row < crease.turn.size(); ++row)
    if (std::isnan(crease.turn[row])) crease.turn[row] = other.turn[row];
}

/// Whether two pairs of hands that turn about one line of the pattern fold different layers: a fold
/// that is shut by then lies between them.
bool are_on_other_layers(const ExpectedCrease& one, const ExpectedCrease& two,
                         const std::vector<ExpectedCrease>& folds) {
  return std::any_of(folds.begin(), folds.end(), [&](const ExpectedCrease& fold) {
    const std::optional<double> met = meeting({one.between, two.between}, fold.line);
    return met && *met > 0 && *met < 1 && is_shut_before(fold, one) && is_shut_before(fold, two);
  });
}

bool is_same_line(const Segment2& a, const Segment2& b, double side) {
  const auto near = [&](const Vector2d& p) {
    return distance_to_segment(p, b.a, b.b) < same_line * side;
  };
  return near(a.a) && near(a.b);
}

/// Whether a part of a line is one of a strip that other folds than those of its hands give its
/// shape: it ends at a hole or a slit, and the paper there does not begin folded as its hands are
/// turned by then. Such are the strips of a pop-up card that stand up from its spine.
bool is_of_other_strip(const Segment2& part, const FoldAxis& axis, const Shot& shot) {
  constexpr double clearly = radians_of(5);  // assumed
  const double hands = axis.turn.front(), near = same_line * longer_side(shot.pattern);
  if (!(std::abs(hands) > clearly)) return false;  // or not known
  const auto ends_at_hole = [&](const Vector2d& p) {
    return std::any_of(shot.pattern.holes.begin(), shot.pattern.holes.end(), [&](const auto& hole) {
      return (nearest_border_point({hole, {}}, p) - p).norm() < near;
    });
  };
  if (!ends_at_hole(part.a) && !ends_at_hole(part.b)) return false;
  const double paper = fold_of_line(shot.start, {part.a, part.b}, near);
  return std::abs(std::remainder(paper - hands, 2 * M_PI)) > clearly;
}

/// The lines about which clamps turn, as often as two of them do.
/// folds  that are known
std::vector<ExpectedCrease> lines_of_hands(const Clamps& clamps, const Shot& shot,
                                           const std::vector<ExpectedCrease>& folds) {
  using By = ExpectedCrease::By;
  std::vector<ExpectedCrease> found;
  const std::vector<FoldAxis> axes = axes_of(clamps);
  for (const auto by_what : {CutPattern::By::cut, CutPattern::By::line})
    for (const FoldAxis& axis : axes)
      for (const Segment2& part : on_paper(through_handles(axis, clamps, shot), clamps, shot)) {
        if (is_of_other_strip(part, axis, shot)) continue;
        ExpectedCrease crease{part,
                              {},
                              {},
                              {},
                              axis.other->is_plate ? By::two_plates : By::plate_and_row,
                              axis.turn,
                              axis.between,
                              {},
                              axis.plate->handles,
                              axis.other->handles};
        if (is_between(crease, axis, clamps, shot.pattern, by_what, folds))
          found.push_back(std::move(crease));
      }
  return found;
}

/// Each line once, and once more for every layer between these folds in which hands turn about it.
std::vector<ExpectedCrease> one_of_each_line(const std::vector<ExpectedCrease>& found,
                                             const std::vector<ExpectedCrease>& folds,
                                             double side) {
  std::vector<ExpectedCrease> lines;
  for (const ExpectedCrease& crease : found) {
    const auto same = std::find_if(lines.begin(), lines.end(), [&](const ExpectedCrease& known) {
      return is_same_line(known.line, crease.line, side) &&
             !are_on_other_layers(known, crease, folds);
    });
    if (same != lines.end())
      add_turn(*same, crease);
    else
      lines.push_back(crease);
  }
  return lines;
}

/// Those of the creases along which the paper between their own clamps turns.
std::vector<ExpectedCrease> without_those_beyond(std::vector<ExpectedCrease> creases,
                                                 const Clamps& clamps, const Pattern& pattern) {
  const std::vector<ExpectedCrease> all = creases;
  const auto is_none = [&](const ExpectedCrease& crease) {
    const auto cuts_off = [&](const ExpectedCrease& nearer) {
      return is_beyond(crease, nearer, clamps, pattern);
    };
    return is_between_two_drawn(crease.line, pattern) ||
           std::any_of(all.begin(), all.end(), cuts_off);
  };
  creases.erase(std::remove_if(creases.begin(), creases.end(), is_none), creases.end());
  return creases;
}

using Hand = std::vector<int>;  // handles

/// Whether a hand has no handle of those that are known.
bool is_new(const Hand& hand, const std::vector<Hand>& known) {
  return std::none_of(hand.begin(), hand.end(), [&](int handle) {
    return std::any_of(known.begin(), known.end(), [&](const Hand& other) {
      return std::find(other.begin(), other.end(), handle) != other.end();
    });
  });
}

/// Whether there are two plates or more, and a new one among them.
bool may_fold(const Clamps& clamps, const std::vector<Hand>& known) {
  int plates = 0;
  bool any_new = false;
  for (const Clamp& clamp : clamps.all()) {
    if (!clamp.is_plate) continue;
    ++plates;
    any_new = any_new || is_new(clamp.handles, known);
  }
  return plates > 1 && any_new;
}

/// Whether a row is a part of one of the hands.
bool is_row_of(const std::vector<Hand>& hands, const ExpectedCrease& crease) {
  return crease.by == ExpectedCrease::By::plate_and_row &&
         std::any_of(hands.begin(), hands.end(), [&](const Hand& hand) {
           return std::includes(hand.begin(), hand.end(), crease.other.begin(), crease.other.end());
         });
}

/// The lines along which clamps fold the sheet of a shot, but for those that are none.
std::vector<ExpectedCrease> folds_of(const Clamps& clamps, const Shot& shot,
                                     const std::function<bool(const ExpectedCrease&)>& is_none) {
  const auto lines_between = [&](const std::vector<ExpectedCrease>& folds) {
    std::vector<ExpectedCrease> found = lines_of_hands(clamps, shot, folds);
    found.erase(std::remove_if(found.begin(), found.end(), is_none), found.end());
    return without_those_beyond(one_of_each_line(found, folds, clamps.side()), clamps,
                                shot.pattern);
  };
  // which layers there are is known from the folds themselves
  std::vector<ExpectedCrease> folds = lines_between({});
  const std::vector<ExpectedCrease> in_other_layers = lead_through_layers(folds, shot.pattern);
  folds.insert(folds.end(), in_other_layers.begin(), in_other_layers.end());
  std::vector<ExpectedCrease> expected = lines_between(folds);
  join_ends(expected, 0, shot.pattern);
  const auto known = [&](const Segment2& line) {
    return std::find_if(expected.begin(), expected.end(), [&](const ExpectedCrease& known) {
      return is_same_line(known.line, line, clamps.side());
    });
  };
  const auto add = [&](std::vector<ExpectedCrease> more) {
    const std::size_t before = expected.size();
    for (ExpectedCrease& crease : more)
      if (known(crease.line) == expected.end() && !is_between_two_drawn(crease.line, shot.pattern))
        expected.push_back(std::move(crease));
    join_ends(expected, before, shot.pattern);
  };
  add(lead_through_layers(expected, shot.pattern));
  add(gussets(shot, clamps, expected));
  return expected;
}

/// Adds lines, and the turn of those that are known to what is known of it.
void add_new_lines(std::vector<ExpectedCrease>& all, std::vector<ExpectedCrease> more,
                   const Pattern& pattern) {
  const std::size_t before = all.size();
  std::vector<int> place;  // in all, of each of them
  for (ExpectedCrease& crease : more) {
    const auto known = std::find_if(all.begin(), all.end(), [&](const ExpectedCrease& one) {
      return is_same_line(one.line, crease.line, longer_side(pattern));
    });
    place.push_back(static_cast<int>(known - all.begin()));
    if (known == all.end())
      all.push_back(std::move(crease));
    else
      add_turn(*known, crease);
  }
  for (std::size_t k = before; k < all.size(); ++k)
    if (all[k].by == ExpectedCrease::By::folds_that_cross)
      for (TurnBeyond& part : all[k].beyond) {
        part.line = place[part.line];
        part.across = place[part.across];
      }
  join_ends(all, before, pattern);
}

}  // namespace

std::vector<ExpectedCrease> expected_creases(const Shot& as_keyed, int first_frame) {
  Shot shot = as_keyed;
  shot.handles = with_known_places(std::move(shot.handles), shot.start, first_frame);
  const Clamps whole(shot, first_frame);
  std::vector<Hand> hands;  // that are known
  for (const Clamp& clamp : whole.all())
    if (clamp.is_plate) hands.push_back(clamp.handles);
  const std::size_t never_part = hands.size();
  std::vector<std::vector<ExpectedCrease>> before_parting;
  Shot part = shot;
  for (const int row : whole.rows_of_parting()) {
    for (std::size_t h = 0; h < part.handles.size(); ++h)
      part.handles[h].release_frame = std::min(shot.handles[h].release_frame, first_frame + row);
    const Clamps clamps(part, first_frame);
    if (!may_fold(clamps, hands)) continue;
    before_parting.push_back(folds_of(clamps, part, [&](const ExpectedCrease& crease) {
      return crease.by != ExpectedCrease::By::two_plates ||
             (!is_new(crease.plate, hands) && !is_new(crease.other, hands));
    }));
    for (const ExpectedCrease& crease : before_parting.back())
      hands.insert(hands.end(), {crease.plate, crease.other});
  }
  const std::vector<Hand> for_a_while(hands.begin() + never_part, hands.end());
  std::vector<ExpectedCrease> expected = folds_of(
      whole, shot, [&](const ExpectedCrease& crease) { return is_row_of(for_a_while, crease); });
  for (std::vector<ExpectedCrease>& lines : before_parting)
    add_new_lines(expected, std::move(lines), shot.pattern);
  for (ExpectedCrease& crease : expected) look_for_drawn(crease, shot.pattern);
  return expected;
}

double largest_turn(const ExpectedCrease& crease) {
  double largest = 0;
  for (const double turn : crease.turn)
    if (std::abs(turn) > std::abs(largest)) largest = turn;
  return largest;
}

std::vector<PrescribedCrease> drawn_creases(const Pattern& pattern,
                                            const std::vector<ExpectedCrease>& expected) {
  const double side = longer_side(pattern), near = same_line * side;
  std::vector<PrescribedCrease> creases = pattern.prescribed_creases;
  for (const ExpectedCrease& fold : expected) {
    std::vector<Segment2> along;
    for (const int c : fold.creases)
      for (std::size_t k = 0; k + 1 < creases[c].line.size(); ++k)
        if (const Segment2 drawn{creases[c].line[k], creases[c].line[k + 1]};
            part_along(fold.line, drawn, near))
          along.push_back(drawn);
    const auto moved = [&](const Vector2d& p) {
      return std::any_of(along.begin(), along.end(), [&](const Segment2& drawn) {
        return distance_to_segment(p, drawn.a, drawn.b) < same_place * side;
      });
    };
    for (PrescribedCrease& crease : creases)
      for (Vector2d& p : crease.line)
        if (moved(p)) p = place_on(fold.line, p, near).value_or(p);
  }
  for (PrescribedCrease& crease : creases)
    crease.line.erase(std::unique(crease.line.begin(), crease.line.end()), crease.line.end());
  return creases;
}

void add_expected_creases(Shot& shot, std::vector<ExpectedCrease> all) {
  const int first = static_cast<int>(shot.hands.size());
  shot.pattern.prescribed_creases = drawn_creases(shot.pattern, all);
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
