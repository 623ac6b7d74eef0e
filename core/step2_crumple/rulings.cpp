#include "core/step2_crumple/rulings.h"

#include "core/model/segment2.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace paperbake {
namespace {

Vector2d turned(const Vector2d& d) { return {-d.y(), d.x()}; }
/// Where the ray from p in the unit direction d meets the segment a-b, as a length along it. [m]
std::optional<double> meets(const Vector2d& p, const Vector2d& d, const Vector2d& a,
                            const Vector2d& b) {
  const std::optional<LinesMeet> meet = where_lines_meet({p, d}, {a, b - a}, 1e-12);
  if (!meet || meet->on_first < 0) return std::nullopt;
  if (meet->on_second < -1e-9 || meet->on_second > 1 + 1e-9) return std::nullopt;
  return meet->on_first;
}

/// Places the rulings of one sheet and keeps those that are placed already.
class RulingPlacer {
 public:
  RulingPlacer(const Pattern& polygons, const BendingField& field, const Regions& regions,
               const PulledPlaces& pulled, double h, const RulingOptions& options)
      : polygons_(polygons),
        field_(field),
        regions_(regions),
        pulled_(pulled),
        h_(h),
        options_(options),
        window_(options.window * std::sqrt(area(polygons))),
        size_(shorter_side(polygons)),
        samples_(regions.all().size()) {
    for (int i = 0; i < regions.grid().count(); ++i) {
      const Principal& bend = regions.bending()[i];
      if (const int region = regions.region_of_sample()[i]; region >= 0)
        samples_[region].push_back(
            {regions.grid().sample_points[i], bend.across, bend.k1 * bend.k1});
    }
  }

  std::vector<Ruling> place() {
    const auto& bending = regions_.bending();
    std::vector<int> order(regions_.grid().count());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int i, int j) {
      return std::abs(bending[i].k1) > std::abs(bending[j].k1);
    });
    for (const int seed : order) {
      if (regions_.region_of_sample()[seed] < 0) continue;
      const Vector2d p = regions_.grid().sample_points[seed];
      // gaps of less than 1.6 strips stay open
      if (!free(p, 0.8 * spacing(bending[seed].k1, min_spacing()))) continue;
      march_from(p, regions_.region_of_sample()[seed], turned(bending[seed].across));
    }
    return std::move(placed_);
  }

 private:
  double spacing(double k, double least) const {
    return std::clamp(options_.turn_per_ruling / std::max(std::abs(k), 1e-9), least,
                      options_.across_most * h_);
  }
  double min_spacing() const { return options_.across_least * h_; }

  /// Towards a corner of the sheet rulings become shorter, and their smallest distance with them.
  double min_spacing_beside(const Ruling& r) const {
    constexpr double of_length = 0.15, least = 0.1;  // [1]; [h]
    return r.cuts_corner ? std::min(min_spacing(), std::max(of_length * r.length(), least * h_))
                         : min_spacing();
  }

  bool free(const Vector2d& p, double clear) const {
    for (const Disc& disc : pulled_.keep_out_discs)
      if ((p - disc.centre).norm() < disc.radius) return false;
    return std::none_of(placed_.begin(), placed_.end(),
                        [&](const Ruling& r) { return distance_to_segment(p, r.a, r.b) < clear; });
  }

  int region_at(const Vector2d& p) const {
    if (!contains(polygons_, p)) return -1;
    const int sample = regions_.grid().nearest(p);
    return sample < 0 ? -1 : regions_.region_of_sample()[sample];
  }

  void march_from(const Vector2d& seed, int region, const Vector2d& direction) {
    const std::optional<Ruling> first = ruling_at(seed, region, direction);
    if (!first) return;
    placed_.push_back(*first);
    for (const double side : {1.0, -1.0}) {
      Ruling last = *first;
      for (int guard = 0; guard < 200; ++guard) {
        const Vector2d middle = 0.5 * (last.a + last.b), d = (last.b - last.a).normalized();
        const double least = min_spacing_beside(last);
        double step = spacing(last.k, least);
        const double ahead = field_.at(middle + side * step * turned(d)).k1;
        step = spacing(0.5 * (std::abs(last.k) + std::abs(ahead)), least);
        const Vector2d next = middle + side * step * turned(d);
        if (region_at(next) != region || !free(next, 0.6 * step)) break;
        const std::optional<Ruling> ruling = ruling_at(next, region, d);
        if (!ruling) break;
        placed_.push_back(*ruling);
        last = *ruling;
        if ((last.b - last.a).dot(d) < 0) std::swap(last.a, last.b);
      }
    }
  }

  std::optional<Ruling> ruling_at(const Vector2d& p, int region, Vector2d direction) const {
    for (int k = 0; k < 2; ++k) {
      const Vector2d d = cone_at(p, region, direction).ruling(p);
      direction = d.dot(direction) < 0 ? Vector2d(-d) : d;
    }
    double radii = 0;  // [m]
    int count = 0;
    const double ahead = reach(p, direction, radii, count),
                 behind = reach(p, -direction, radii, count);
    constexpr double shortest = 0.8, min_at_tip = 0.2;  // [h]
    Ruling ruling{p - behind * direction, p + ahead * direction, 0, region};
    ruling.cuts_corner = cuts_a_tip(ruling);
    if (ruling.length() < (ruling.cuts_corner ? min_at_tip : shortest) * h_ || count == 0)
      return std::nullopt;
    ruling.k = count / radii;
    return ruling;
  }

  /// The cone whose rulings run nearly along `direction` at p, fitted to the sample points of the
  /// region in a window across the rulings.
  Cone cone_at(const Vector2d& p, int region, const Vector2d& direction) const {
    // [1] cosine of 50 degrees between the directions in which two samples bend: with more they are
    // of no one cone; assumed
    constexpr double aligned = 0.64;
    const Vector2d e = turned(direction);
    near_.clear();
    for (const RulingSample& s : samples_[region]) {
      const double offset = (s.p - p).dot(e) / window_;
      if (std::abs(offset) > 2 || std::abs(s.across.dot(e)) < aligned) continue;
      near_.push_back(s);
      near_.back().weight *= std::exp(-offset * offset);
    }
    if (near_.size() >= 4) return fit_cone(near_, window_, options_.cylinder_regularization);
    Cone cylinder;
    cylinder.apex << direction, 0;
    return cylinder;
  }

  /// True when the ruling runs from one side of a loaded corner to the other.
  bool cuts_a_tip(const Ruling& r) const {
    const std::vector<Vector2d>& outline = polygons_.outline;
    const std::size_t n = outline.size();
    for (std::size_t i = 0; i < n; ++i) {
      if (std::none_of(pulled_.loaded_corners.begin(), pulled_.loaded_corners.end(),
                       [&](const Vector2d& tip) { return (outline[i] - tip).norm() < 1e-9; }))
        continue;
      const auto on = [&](const Vector2d& p, const Vector2d& other) {
        return distance_to_segment(p, outline[i], other) < 1e-3 * h_;
      };
      const Vector2d &before = outline[(i + n - 1) % n], &after = outline[(i + 1) % n];
      if ((on(r.a, before) && on(r.b, after)) || (on(r.a, after) && on(r.b, before))) return true;
    }
    return false;
  }

  /// How far a ruling extends from p along d: as long as the sheet bends across it as it does at p.
  /// Adds the radii of curvature on the way to `radii` and their number to `count`. [m]
  double reach(const Vector2d& p, const Vector2d& d, double& radii, int& count) const {
    constexpr int max_bad = 2;  // samples in a row, after which the ruling has ended; assumed
    double end = std::numeric_limits<double>::infinity();
    for (const auto* polygon : all_polygons())
      for (std::size_t s = 0; s < polygon->size(); ++s)
        if (const auto t = meets(p, d, (*polygon)[s], (*polygon)[(s + 1) % polygon->size()]))
          end = std::min(end, *t);
    if (!std::isfinite(end)) return 0;
    const double border = end;
    end = std::min(end, obstacle(p, d));
    const double k = field_.at(p).k1, step = size_ / 30;
    double good = 0;
    int bad = 0;
    for (double t = step; t < end && bad < max_bad; t += step) {
      const Principal here = field_.at(p + t * d);
      const double least =
          std::max(0.25 * std::abs(k),
                   0.7 * options_.flat_below * options_.curved_above / longer_side(polygons_));
      const bool along = here.k1 * k > 0 && std::abs(here.k1) > least &&
                         std::abs(turned(here.across).dot(d)) > 0.866 &&
                         std::abs(here.k2) < options_.coherent * std::abs(here.k1);
      bad = along ? 0 : bad + 1;
      if (!along) continue;
      good = t;
      radii += 1 / here.k1;
      ++count;
    }
    if (bad < max_bad) return end;
    if (end == border && border - good < 0.5 * h_) return border;
    return good;
  }

  /// Length along a ray to the first keep-out disc, or to a little before the first ruling. [m]
  double obstacle(const Vector2d& p, const Vector2d& d) const {
    double end = std::numeric_limits<double>::infinity();
    for (const Disc& disc : pulled_.keep_out_discs) {
      const double along = (disc.centre - p).dot(d), off = std::abs(cross(disc.centre - p, d));
      if (along > 0 && off < disc.radius)
        end = std::min(end, along - std::sqrt(disc.radius * disc.radius - off * off));
    }
    for (const Ruling& r : placed_)
      if (const auto t = meets(p, d, r.a, r.b)) end = std::min(end, std::max(0.0, *t - 0.4 * h_));
    return end;
  }

  std::vector<const std::vector<Vector2d>*> all_polygons() const {
    std::vector<const std::vector<Vector2d>*> all{&polygons_.outline};
    for (const auto& hole : polygons_.holes) all.push_back(&hole);
    return all;
  }

  const Pattern& polygons_;
  const BendingField& field_;
  const Regions& regions_;
  const PulledPlaces& pulled_;
  double h_;
  const RulingOptions& options_;
  double window_, size_;
  std::vector<std::vector<RulingSample>> samples_;  // of each region
  mutable std::vector<RulingSample> near_;          // samples of the last fit: memory to reuse
  std::vector<Ruling> placed_;
};

}  // namespace

std::vector<Ruling> place_rulings(const Pattern& polygons, const BendingField& field,
                                  const Regions& regions, const PulledPlaces& pulled, double h,
                                  const RulingOptions& options) {
  return RulingPlacer(polygons, field, regions, pulled, h, options).place();
}

}  // namespace paperbake
