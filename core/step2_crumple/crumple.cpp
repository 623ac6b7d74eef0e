#include "core/step2_crumple/crumple.h"

#include "core/geometry/curvature.h"
#include "core/geometry/developable_curvature.h"
#include "core/geometry/mesh_transfer.h"
#include "core/model/serializer.h"
#include "core/step2_crumple/edge_flips.h"
#include "core/step2_crumple/singular_points.h"

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

/// The curvature that rulings and edge flips follow. Around a singular point a sheet of few
/// triangles is not developable, so that the general estimate is used there.
Points3 bending_of(const Sheet& sheet) {
  return sheet.singular.empty() ? developable_curvature(sheet) : vertex_curvature(sheet);
}

bool is_corner(const Pattern& polygons, const Vector2d& p) {
  return std::any_of(polygons.outline.begin(), polygons.outline.end(),
                     [&](const Vector2d& corner) { return (corner - p).norm() < 1e-9; });
}

}  // namespace

Crumple::Crumple(const Pattern& pattern, const Paper& paper, const CrumpleOptions& options,
                 std::uint32_t seed, std::uint32_t sheet)
    : pattern_(pattern),
      paper_(paper),
      options_(options),
      seed_(seed),
      sheet_(sheet),
      regions_(pattern, options.rulings) {}

void Crumple::begin_with(const Points2& pattern, const Triangles& triangles, int required) {
  base_ = base_mesh(pattern, triangles);
  required_ = required;
}

static void archive(Archive& a, Ruling& r) { a(r.a, r.b, r.k, r.region); }

void Crumple::archive(Archive& a) {
  std::vector<std::pair<Vector2d, double>> suspicions;
  for (const Suspicion& s : suspicions_) suspicions.emplace_back(s.p, s.seconds);
  a(suspicions, regions_, rulings_, when_);
  suspicions_.clear();
  for (const auto& [p, seconds] : suspicions) suspicions_.push_back({p, seconds});
}

std::optional<Sheet> Crumple::propose(const Sheet& sheet, const std::vector<int>& pulled, bool lies,
                                      const Moment& now) {
  RulingOptions options = options_.rulings;
  if (options.facet_turn <= 0 || required_ < 0) return std::nullopt;
  const Points3 curvature = bending_of(sheet);
  const BendingField field(sheet, curvature);
  regions_.follow(field);
  if (!when_.due(mesh_fit(sheet, field, regions_), now, options.stale_fold * options.facet_turn))
    return std::nullopt;

  std::vector<Vector2d> required, singular;
  for (int v = 0; v < required_; ++v) required.push_back(sheet.pattern.row(v));
  for (const SingularPoint& s : sheet.singular) singular.push_back(s.pattern);
  // a mesh without a vertex at a pending conflict would not show whether the conflict persists
  for (const Suspicion& s : suspicions_)
    if (std::none_of(singular.begin(), singular.end(),
                     [&](const Vector2d& p) { return (p - s.p).norm() < 0.5 * base_.h; }))
      singular.push_back(s.p);
  std::vector<Disc> guards;
  std::vector<Vector2d> tips;
  for (const int v : pulled) {
    const Vector2d p = sheet.pattern.row(v);
    if (lies && is_corner(base_.polygons, p))
      tips.push_back(p);
    else
      guards.push_back({p, options.guard * shorter_side(pattern_)});
  }
  std::optional<RuledMesh> mesh;
  for (int attempt = 0; attempt < 3; ++attempt, options.facet_turn *= 1.35) {
    proposed_ = lay_rulings(base_.polygons, field, regions_, guards, tips, base_.h, options);
    if (proposed_.empty()) return std::nullopt;
    mesh = ruled_mesh(base_, required, singular, proposed_, guards, options);
    if (mesh &&
        mesh->triangles.rows() <= options.most_share * base_.triangles + 2 * singular.size())
      break;
  }
  if (!mesh) {
    when_.judged(false, now);
    return std::nullopt;
  }
  Sheet proposal;
  const Transfer onto(sheet.pattern, sheet.triangles, mesh->pattern);
  proposal.x = onto(sheet.x);
  proposal.v = onto(sheet.v);
  proposal.pattern = std::move(mesh->pattern);
  proposal.triangles = std::move(mesh->triangles);
  proposal.singular = sheet.singular;
  flip_towards_rulings(proposal, onto(curvature), options_.flip_gain);
  return proposal;
}

void Crumple::judged(bool accepted, const Moment& now) {
  when_.judged(accepted, now);
  if (!accepted) return;
  rulings_ = proposed_;
}

CrumpleReport Crumple::operate(Sheet& sheet, const std::vector<char>& fixed, const Moment& now,
                               bool moving) {
  CrumpleReport report;
  if (!moving) return report;
  const Points3 curvature = vertex_curvature(sheet);
  // creases run along the edges of a crumpled mesh, so that a flip would take its crease with it; a
  // sheet with only one or two singular points is smooth elsewhere
  constexpr std::size_t crumpled = 3;
  const bool smooth = sheet.singular.size() < crumpled;

  // a conflict counts once it has persisted, even across a change of mesh; the worst vertex and
  // those around it are one conflict
  const Conflicts conflicts = find_conflicts(sheet, curvature, fixed, options_);
  std::vector<Suspicion> seen;
  std::vector<int> ripe;
  const double rounding = 1e-3 * now.dt;
  for (int v = 0; v < sheet.pattern.rows(); ++v) {
    if (!conflicts.beyond[v]) continue;
    Suspicion s{sheet.pattern.row(v), now.dt};
    const double ring = ring_size(sheet, v);
    for (const Suspicion& old : suspicions_)
      if ((old.p - s.p).norm() < 0.6 * ring) s.seconds = std::max(s.seconds, old.seconds + now.dt);
    seen.push_back(s);
    const bool lasted =
        s.seconds + rounding >= (conflicts.sharp[v] ? options_.lasting_sharp : options_.lasting);
    if (lasted) ripe.push_back(v);
  }
  suspicions_ = std::move(seen);
  std::stable_sort(ripe.begin(), ripe.end(),
                   [&](int a, int b) { return conflicts.turn[a] > conflicts.turn[b]; });
  const bool room = static_cast<int>(sheet.singular.size()) < options_.most_points &&
                    sheet.triangles.rows() + 2 <= options_.most_triangles;
  for (const int worst : ripe) {  // the first conflict that has room for a singular point
    if (!room || report.births > 0) break;
    std::vector<int> members;
    const double reach = 1.2 * ring_size(sheet, worst);
    for (int v = 0; v < sheet.pattern.rows(); ++v)
      if (conflicts.beyond[v] && (sheet.pattern.row(v) - sheet.pattern.row(worst)).norm() <= reach)
        members.push_back(v);
    const auto event = static_cast<std::uint32_t>(sheet.singular.size());
    if (const auto p = draw_singular_point(sheet, pattern_, paper_, conflicts, members, options_,
                                           seed_, sheet_, event)) {
      Sheet grown = sheet;
      const int born = insert_vertex(grown, *p, fixed);
      // it may have come to lie a little beside p, where no singular point is allowed
      if (options_.pins.forbids(grown.pattern.row(born))) continue;
      sheet = std::move(grown);
      const int degrees = static_cast<int>(std::lround(conflicts.turn[worst] * 180 / M_PI));
      sheet.singular.push_back(
          {sheet.pattern.row(born).transpose(), now.frame,
           "bends " + std::to_string(degrees) + " degrees in the second direction"});
      suspicions_.clear();
      ++report.births;
    }
  }
  const auto periods = [&](double time) {
    return std::floor((time + rounding) / options_.flip_period);
  };
  const bool time_to_flip = periods(now.seconds()) > periods(now.seconds() - now.dt);
  if (smooth && (time_to_flip || report.births > 0)) {
    // strips hide bending that is not along their edges
    const Points3 bending = rulings_.empty() ? vertex_curvature(sheet) : bending_of(sheet);
    report.flips = flip_towards_rulings(sheet, bending, options_.flip_gain);
  }
  return report;
}

}  // namespace paperbake
