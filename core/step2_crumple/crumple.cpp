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

/// What rulings and flips follow. About a singular point a sheet of a few triangles is not
/// developable.
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

void Crumple::set_base_mesh(const Points2& pattern, const Triangles& triangles, int required) {
  base_ = base_mesh(pattern, triangles);
  required_ = required;
}

static void archive(Serializer& a, Ruling& r) { a(r.a, r.b, r.k, r.region); }

void Crumple::archive(Serializer& a) {
  std::vector<std::pair<Vector2d, double>> pending_conflicts;
  for (const PendingConflict& s : pending_) pending_conflicts.emplace_back(s.p, s.seconds);
  a(pending_conflicts, regions_, rulings_, when_);
  pending_.clear();
  for (const auto& [p, seconds] : pending_conflicts) pending_.push_back({p, seconds});
}

std::optional<Sheet> Crumple::propose(const Sheet& sheet,
                                      const std::vector<int>& isolated_moving_handles,
                                      bool rests_on_contact, const FrameTime& now) {
  RulingOptions options = options_.rulings;
  if (options.facet_turn <= 0 || required_ < 0) return std::nullopt;
  const Points3 curvature = bending_of(sheet);
  const BendingField field(sheet, curvature);
  regions_.update(field);
  if (!when_.due(mesh_fit(sheet, field, regions_), now, options.stale_fold * options.facet_turn))
    return std::nullopt;

  std::vector<Vector2d> required, singular;
  for (int v = 0; v < required_; ++v) required.push_back(sheet.pattern.row(v));
  for (const SingularPoint& s : sheet.singular) singular.push_back(s.pattern);
  // a mesh without that vertex would not show whether the conflict lasts
  for (const PendingConflict& s : pending_)
    if (std::none_of(singular.begin(), singular.end(),
                     [&](const Vector2d& p) { return (p - s.p).norm() < 0.5 * base_.h; }))
      singular.push_back(s.p);
  std::vector<Disc> keep_out_discs;
  std::vector<Vector2d> loaded_corners;
  for (const int v : isolated_moving_handles) {
    const Vector2d p = sheet.pattern.row(v);
    if (rests_on_contact && is_corner(base_.polygons, p))
      loaded_corners.push_back(p);
    else
      keep_out_discs.push_back({p, options.guard * shorter_side(pattern_)});
  }
  std::optional<RuledMesh> mesh;
  for (int attempt = 0; attempt < 3; ++attempt, options.facet_turn *= 1.35) {
    proposed_ = place_rulings(base_.polygons, field, regions_, keep_out_discs, loaded_corners,
                              base_.h, options);
    if (proposed_.empty()) return std::nullopt;
    mesh = ruled_mesh(base_, required, singular, proposed_, keep_out_discs, options);
    if (mesh && mesh->triangles.rows() <= options.max_share * base_.triangles + 2 * singular.size())
      break;
  }
  if (!mesh) {
    when_.on_proposal_result(false, now);
    return std::nullopt;
  }
  Sheet proposal;
  const MeshTransfer onto(sheet.pattern, sheet.triangles, mesh->pattern);
  proposal.x = onto(sheet.x);
  proposal.v = onto(sheet.v);
  proposal.pattern = std::move(mesh->pattern);
  proposal.triangles = std::move(mesh->triangles);
  proposal.singular = sheet.singular;
  flip_towards_rulings(proposal, onto(curvature), options_.flip_gain);
  return proposal;
}

void Crumple::on_proposal_result(bool accepted, const FrameTime& now) {
  when_.on_proposal_result(accepted, now);
  if (!accepted) return;
  rulings_ = proposed_;
}

CrumpleReport Crumple::step(Sheet& sheet, const std::vector<char>& fixed, const FrameTime& now,
                            bool moving) {
  CrumpleReport report;
  if (!moving) return report;
  const Points3 curvature = vertex_curvature(sheet);
  // the edges of a crumple are where it folds: one that turns takes its fold with it. A sheet with
  // a point or two is smooth elsewhere
  constexpr std::size_t crumpled = 3;
  const bool smooth = sheet.singular.size() < crumpled;

  // a conflict counts when it has lasted, on whatever mesh; the worst vertex and those about it are
  // one conflict
  const Conflicts conflicts = find_conflicts(sheet, curvature, fixed, options_);
  std::vector<PendingConflict> seen;
  std::vector<int> due_for_birth;
  const double rounding = 1e-3 * now.dt;
  for (int v = 0; v < sheet.pattern.rows(); ++v) {
    if (!conflicts.exceeds[v]) continue;
    PendingConflict s{sheet.pattern.row(v), now.dt};
    const double ring = ring_size(sheet, v);
    for (const PendingConflict& old : pending_)
      if ((old.p - s.p).norm() < 0.6 * ring) s.seconds = std::max(s.seconds, old.seconds + now.dt);
    seen.push_back(s);
    const bool lasted =
        s.seconds + rounding >=
        (conflicts.severe[v] ? options_.persistence_time_severe : options_.persistence_time);
    if (lasted) due_for_birth.push_back(v);
  }
  pending_ = std::move(seen);
  std::stable_sort(due_for_birth.begin(), due_for_birth.end(),
                   [&](int a, int b) { return conflicts.turn[a] > conflicts.turn[b]; });
  const bool room = static_cast<int>(sheet.singular.size()) < options_.max_points &&
                    sheet.triangles.rows() + 2 <= options_.max_triangles;
  for (const int worst : due_for_birth) {  // the first that has room for a point
    if (!room || report.births > 0) break;
    std::vector<int> members;
    const double reach = 1.2 * ring_size(sheet, worst);
    for (int v = 0; v < sheet.pattern.rows(); ++v)
      if (conflicts.exceeds[v] && (sheet.pattern.row(v) - sheet.pattern.row(worst)).norm() <= reach)
        members.push_back(v);
    const auto event = static_cast<std::uint32_t>(sheet.singular.size());
    if (const auto p = draw_singular_point(sheet, pattern_, paper_, conflicts, members, options_,
                                           seed_, sheet_, event)) {
      Sheet grown = sheet;
      const int born = insert_vertex(grown, *p, fixed);
      // it came to lie beside its place
      if (options_.pins.forbids(grown.pattern.row(born))) continue;
      sheet = std::move(grown);
      const int degrees = static_cast<int>(std::lround(conflicts.turn[worst] * 180 / M_PI));
      sheet.singular.push_back(
          {sheet.pattern.row(born).transpose(), now.frame,
           "bends " + std::to_string(degrees) + " degrees in the second direction"});
      pending_.clear();
      ++report.births;
    }
  }
  const auto periods = [&](double time) {
    return std::floor((time + rounding) / options_.flip_period);
  };
  const bool time_to_flip = periods(now.seconds()) > periods(now.seconds() - now.dt);
  if (smooth && (time_to_flip || report.births > 0)) {
    // strips hide what is not along their edges
    const Points3 bending = rulings_.empty() ? vertex_curvature(sheet) : bending_of(sheet);
    report.flips = flip_towards_rulings(sheet, bending, options_.flip_gain);
  }
  return report;
}

}  // namespace paperbake
