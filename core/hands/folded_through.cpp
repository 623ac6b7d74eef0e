#include "core/hands/folded_through.h"

#include "core/hands/fold_axis.h"
#include "core/hands/folding_hands.h"
#include "core/model/segment2.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace paperbake {
namespace {

constexpr int most_layers = 16;   // through which a line is followed
constexpr double at_once = 1e-9;  // [m] what is met nearer is where the way begins

/// How far ahead of p in a direction a segment is met; nothing: it is not. [m]
std::optional<double> met_at(const Vector2d& p, const Vector2d& direction, const Segment2& s) {
  const std::optional<double> ahead = meeting({p, p + direction}, s);
  return ahead && *ahead > at_once ? ahead : std::nullopt;
}

/// How far from p in a direction the paper ends. [m]
double way_to_border(const Pattern& pattern, const Vector2d& p, const Vector2d& direction) {
  double least = std::numeric_limits<double>::infinity();
  const auto look_at = [&](const std::vector<Vector2d>& polygon) {
    for (std::size_t i = 0; i < polygon.size(); ++i)
      if (const auto at = met_at(p, direction, {polygon[i], polygon[(i + 1) % polygon.size()]}))
        least = std::min(least, *at);
  };
  look_at(pattern.outline);
  for (const auto& hole : pattern.holes) look_at(hole);
  return least;
}

/// Paper that lies double, as lines of hands find it.
class Layers {
 public:
  Layers(const std::vector<ExpectedCrease>& folds, const Pattern& pattern)
      : folds_(folds), pattern_(pattern), near_(on_line * longer_side(pattern)) {}

  /// The straight parts of a line from p in a direction to the border, through all layers.
  std::vector<Segment2> follow(const ExpectedCrease& line, Vector2d p, Vector2d direction) {
    std::vector<Segment2> parts;
    const ExpectedCrease* last = nullptr;  // the fold at p
    while (parts.size() < most_layers) {
      double length = way_to_border(pattern_, p, direction);
      const ExpectedCrease* next = nullptr;
      for (const ExpectedCrease& fold : folds_)
        if (&fold != &line && &fold != last && is_shut_before(fold, line))
          if (const auto at = met_at(p, direction, fold.line);
              at && *at < length - near_ && !is_straight_on(p + *at * direction, direction, fold)) {
            length = *at;
            next = &fold;
          }
      if (!std::isfinite(length)) break;
      parts.push_back({p, p + length * direction});
      if (!next) break;
      p = parts.back().b = crossing(parts.back().b);
      direction = mirrored(direction, next->line);
      last = next;
    }
    return parts;
  }

 private:
  static Vector2d mirrored(const Vector2d& direction, const Segment2& fold) {
    const Vector2d along = (fold.b - fold.a).normalized();
    // the way goes on across the fold
    return direction - 2 * along.dot(direction) * along;
  }

  /// Whether the mirror image beyond a fold goes on in the same straight line.
  bool is_straight_on(const Vector2d& at, const Vector2d& direction,
                      const ExpectedCrease& fold) const {
    const Vector2d then = mirrored(direction, fold.line);
    return way_to_border(pattern_, at, then) * (then - direction).norm() < near_;
  }

  /// The same point as another crossing beside it: between them there would be slivers.
  Vector2d crossing(const Vector2d& p) {
    const auto known =
        std::find_if(crossings_.begin(), crossings_.end(),
                     [&](const Vector2d& other) { return (p - other).norm() < near_; });
    if (known != crossings_.end()) return *known;
    crossings_.push_back(p);
    return p;
  }

  const std::vector<ExpectedCrease>& folds_;
  const Pattern& pattern_;
  std::vector<Vector2d> crossings_;
  double near_;  // [m]
};

}  // namespace

bool is_shut_before(const ExpectedCrease& fold, const ExpectedCrease& hands) {
  const auto size = [](double turn) { return std::isnan(turn) ? 0 : std::abs(turn); };
  const auto most = std::max_element(hands.turn.begin(), hands.turn.end(),
                                     [&](double a, double b) { return size(a) < size(b); });
  const int begin = begin_of_turn(hands.turn, static_cast<int>(most - hands.turn.begin()));
  return std::cos(turn_at(fold.turn, begin)) < 0;
}

std::vector<ExpectedCrease> lead_through_layers(std::vector<ExpectedCrease>& creases,
                                                const Pattern& pattern) {
  const std::vector<ExpectedCrease> folds = creases;
  Layers layers(folds, pattern);
  std::vector<ExpectedCrease> mirrored;
  for (std::size_t k = 0; k < folds.size(); ++k) {
    const Segment2 line = folds[k].line;
    const Vector2d direction = (line.b - line.a).normalized();
    const Vector2d middle = line.a + std::clamp(direction.dot(folds[k].between - line.a), 0.0,
                                                (line.b - line.a).norm()) *
                                         direction;
    // from where the hands are, both ways
    const auto lead = [&](Vector2d& end, const Vector2d& towards) {
      const std::vector<Segment2> parts = layers.follow(folds[k], middle, towards);
      const bool ends_sooner =
          parts.size() > 1 && (parts.front().b - middle).norm() < (end - middle).norm();
      if (!ends_sooner) return;
      end = parts.front().b;
      for (std::size_t i = 1; i < parts.size(); ++i) {
        mirrored.push_back(folds[k]);
        mirrored.back().line = parts[i];
      }
    };
    lead(creases[k].line.b, direction);
    lead(creases[k].line.a, -direction);
  }
  return mirrored;
}

}  // namespace paperbake
