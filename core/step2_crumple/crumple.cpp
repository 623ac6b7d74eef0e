#include "core/step2_crumple/crumple.h"

#include "core/geometry/curvature.h"
#include "core/geometry/developable_curvature.h"
#include "core/geometry/mesh_transfer.h"
#include "core/model/degrees.h"
#include "core/model/serializer.h"
#include "core/step2_crumple/conflicts.h"
#include "core/step2_crumple/edge_flips.h"
#include "core/step2_crumple/find_fold_lines.h"
#include "core/step2_crumple/lone_cone.h"
#include "core/step2_crumple/singular_points.h"
#include "core/step2_crumple/vertex_insertion.h"

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

// [h] a pending conflict this near to a singular point gets no vertex of its own
constexpr double beside_point = 0.5;
// how often a ruled mesh is tried, and how much farther apart its rulings are each time [1]: the
// first may have too many triangles, or needles
constexpr int most_tries = 3;
constexpr double farther_apart = 1.35;
constexpr double rounding_of_corners = 1e-9;  // [m]

/// The curvature that rulings and edge flips follow. Around a singular point a sheet of few
/// triangles is not developable, so that the general estimate is used there.
Points3 bending_of(const Sheet& sheet) {
  return sheet.singular.empty() ? developable_curvature(sheet) : vertex_curvature(sheet);
}

bool is_corner(const Pattern& polygons, const Vector2d& p) {
  return std::any_of(polygons.outline.begin(), polygons.outline.end(), [&](const Vector2d& corner) {
    return (corner - p).norm() < rounding_of_corners;
  });
}

}  // namespace

Crumple::Crumple(const Pattern& pattern, const Paper& paper, const CrumpleOptions& options,
                 std::uint32_t seed, std::uint32_t sheet)
    : pattern_(pattern),
      paper_(paper),
      options_(options),
      seed_(seed),
      sheet_(sheet),
      crumpled_(pattern, paper, options, seed, sheet),
      regions_(pattern, options.rulings) {}

void Crumple::set_base_mesh(const Points2& pattern, const Triangles& triangles, int required) {
  base_ = base_mesh(pattern, triangles);
  required_ = required;
}

void Crumple::allow_triangles(int most) {
  options_.max_triangles = std::max(options_.max_triangles, most);
  crumpled_.allow_triangles(options_.max_triangles);
}

static void archive(Serializer& a, Ruling& r) { a(r.a, r.b, r.k, r.region); }

void Crumple::archive(Serializer& a) { a(pending_, crumpled_, regions_, rulings_, when_); }

std::optional<Sheet> Crumple::propose(const Sheet& sheet,
                                      const std::vector<int>& isolated_moving_handles,
                                      bool rests_on_contact, const FrameTime& now) {
  RulingOptions options = options_.rulings;
  if (options.turn_per_ruling <= 0 || is_crumpled(sheet)) return std::nullopt;
  const Points3 curvature = bending_of(sheet);
  const BendingField field(sheet, curvature);
  regions_.update(field);
  if (!when_.due(mesh_fit(sheet, field, regions_), now,
                 options.stale_fold * options.turn_per_ruling))
    return std::nullopt;

  std::vector<Vector2d> required, singular;
  for (int v = 0; v < required_; ++v) required.push_back(sheet.pattern.row(v));
  for (const SingularPoint& s : sheet.singular) singular.push_back(s.pattern);
  // a mesh without a vertex at a pending conflict would not show whether the conflict persists
  for (const Vector2d& place : pending_.places())
    if (std::none_of(singular.begin(), singular.end(), [&](const Vector2d& p) {
          return (p - place).norm() < beside_point * base_.h;
        }))
      singular.push_back(place);
  PulledPlaces pulled;
  for (const int v : isolated_moving_handles) {
    const Vector2d p = sheet.pattern.row(v);
    if (rests_on_contact && is_corner(base_.polygons, p))
      pulled.loaded_corners.push_back(p);
    else
      pulled.keep_out_discs.push_back({p, options.guard * shorter_side(pattern_)});
  }
  std::optional<RuledMesh> mesh;
  for (int tried = 0; tried < most_tries; ++tried, options.turn_per_ruling *= farther_apart) {
    proposed_ = place_rulings(base_.polygons, field, regions_, pulled, base_.h, options);
    if (proposed_.empty()) return std::nullopt;
    mesh = ruled_mesh(base_, required, singular, proposed_, pulled.keep_out_discs, options);
    if (mesh && mesh->triangles.rows() <= options.max_share * base_.triangles + 2 * singular.size())
      break;
  }
  if (!mesh) {
    when_.on_proposal_result(false, now);
    return std::nullopt;
  }
  const MeshTransfer onto(sheet.pattern, sheet.triangles, mesh->pattern);
  Sheet proposal = on_other_mesh(sheet, std::move(mesh->pattern), std::move(mesh->triangles), onto);
  flip_towards_rulings(proposal, onto(curvature), options_.flip_gain);
  return proposal;
}

void Crumple::on_proposal_result(bool accepted, const FrameTime& now) {
  when_.on_proposal_result(accepted, now);
  if (!accepted) return;
  rulings_ = proposed_;
}

std::vector<FoldLine> Crumple::fold_lines(const Sheet& sheet, const PlasticMemory& memory) const {
  if (is_crumpled(sheet)) return {};
  return find_fold_lines(sheet, memory, pattern_, yield_curvature(paper_));
}

std::vector<FoldLine> Crumple::pressed_lines(const Sheet& sheet,
                                             const std::function<PlasticMemory()>& memory,
                                             const ColliderShapes& colliders) const {
  if (is_crumpled(sheet)) return {};
  return find_pressed_lines(sheet, memory, colliders, pattern_, yield_curvature(paper_));
}

std::vector<int> Crumple::due_for_birth(const Sheet& sheet, const VertexRings& rings,
                                        const Conflicts& conflicts, double travel) {
  constexpr double reach = 0.6;      // [1] of the size of the ring
  constexpr double rounding = 1e-3;  // [1] of the travel: travels that differ by less are equal
  std::vector<int> found, due;
  std::vector<LastingPlaces::Seen> seen;
  for (int v = 0; v < sheet.pattern.rows(); ++v) {
    if (!conflicts.exceeds[v]) continue;
    found.push_back(v);
    seen.push_back({sheet.pattern.row(v), reach * ring_size(sheet, rings, v)});
  }
  const std::vector<double> lasted = pending_.see(seen, travel);
  for (std::size_t k = 0; k < found.size(); ++k)
    if (lasted[k] + rounding * travel >=
        (conflicts.severe[found[k]] ? options_.persistence_severe : options_.persistence))
      due.push_back(found[k]);
  std::stable_sort(due.begin(), due.end(),
                   [&](int a, int b) { return conflicts.turn[a] > conflicts.turn[b]; });
  return due;
}

bool Crumple::give_birth(Sheet& sheet, int worst, const Conflicts& conflicts,
                         const std::optional<Vector2d>& apex, const std::vector<char>& fixed,
                         int frame) {
  // the worst vertex and those around it are one conflict
  constexpr double around = 1.2;  // [1] of the size of the ring; assumed
  std::vector<int> members;
  const VertexRings rings(sheet.triangles, find_hinges(sheet.triangles), sheet.pattern.rows());
  const double reach = around * ring_size(sheet, rings, worst);
  for (int v = 0; v < sheet.pattern.rows(); ++v)
    if (conflicts.exceeds[v] && (sheet.pattern.row(v) - sheet.pattern.row(worst)).norm() <= reach)
      members.push_back(v);
  const auto event = static_cast<std::uint32_t>(sheet.singular.size());
  const auto p = draw_singular_point(sheet, pattern_, paper_,
                                     {apex ? *apex : middle_of_conflict(sheet, conflicts, members),
                                      min_spacing(pattern_, paper_, options_)},
                                     options_, {seed_, sheet_, event});
  if (!p) return false;
  Sheet grown = sheet;
  const int born = insert_vertex(grown, *p, fixed);
  // it may have come to lie a little beside p, where no singular point is allowed
  if (options_.singular_point_rules.forbids(grown.pattern.row(born))) return false;
  sheet = std::move(grown);
  const int degrees = static_cast<int>(std::lround(degrees_of(conflicts.turn[worst])));
  sheet.singular.push_back(
      {sheet.pattern.row(born).transpose(), frame,
       "bends " + std::to_string(degrees) + " degrees in the second direction"});
  pending_.forget();
  return true;
}

CrumpleReport Crumple::step_smooth(Sheet& sheet, const std::vector<char>& fixed,
                                   const FrameTime& now, double travel) {
  CrumpleReport report;
  const Hinges hinges = find_hinges(sheet.triangles);
  const Points3 curvature = vertex_curvature(sheet);
  Conflicts conflicts = find_conflicts(sheet, curvature, fixed, options_);
  std::optional<Vector2d> apex;  // to which all conflicts belong
  if (conflicts.any()) apex = apex_of_lone_cone(sheet, pattern_, curvature);
  if (apex && is_apex_taken(sheet, fixed, *apex)) conflicts.exceeds.assign(sheet.pattern.rows(), 0);
  const std::vector<int> due = due_for_birth(
      sheet, VertexRings(sheet.triangles, hinges, sheet.pattern.rows()), conflicts, travel);
  if (static_cast<int>(sheet.singular.size()) < options_.max_points &&
      sheet.triangles.rows() + 2 <= options_.max_triangles)
    // the first conflict that has room for a singular point
    report.births = std::any_of(due.begin(), due.end(), [&](int worst) {
      return give_birth(sheet, worst, conflicts, apex, fixed, now.frame);
    });
  constexpr double rounding = 1e-3;  // [frames] times that differ by less are equal
  const auto periods = [&](double time) {
    return std::floor((time + rounding * now.dt) / options_.flip_period);
  };
  const bool time_to_flip = periods(now.seconds()) > periods(now.seconds() - now.dt);
  if (time_to_flip || report.births > 0) {
    // strips hide bending that is not along their edges
    const Points3 bending = rulings_.empty() ? vertex_curvature(sheet) : bending_of(sheet);
    report.flips = flip_towards_rulings(sheet, bending, options_.flip_gain);
  }
  return report;
}

CrumpleReport Crumple::step(Sheet& sheet, const std::vector<char>& fixed, const FrameTime& now,
                            const Deformation& deformation,
                            const std::function<LocalEnergies()>& stored) {
  if (!deformation.moving) return {};
  const double travel = std::min(options_.largest_travel, deformation.travel);
  if (is_crumpled(sheet)) {
    if (!(travel > 0) || !(deformation.at_minimum || deformation.pressed)) return {};
    return crumpled_.step(sheet, {fixed, stored(), travel, now.frame, deformation.at_minimum});
  }
  CrumpleReport report = step_smooth(sheet, fixed, now, travel);
  // as many points as would be born if the same travel was made in small steps
  for (double rest = deformation.travel - options_.persistence_severe;
       rest > 0 && report.births > 0 && !is_crumpled(sheet); rest -= options_.persistence_severe) {
    const CrumpleReport more = step_smooth(sheet, fixed, now, options_.persistence_severe);
    if (more.births == 0) break;
    report.births += more.births;
    report.flips += more.flips;
  }
  return report;
}

int Crumple::refine_where_jammed(Sheet& sheet, const std::vector<char>& fixed,
                                 const LocalEnergies& stored) {
  return is_crumpled(sheet) ? crumpled_.refine_where_jammed(sheet, fixed, stored) : 0;
}

int Crumple::load_parts(const Sheet& sheet, double travel) const {
  if (!is_crumpled(sheet)) return 1;
  return std::clamp(static_cast<int>(std::ceil(travel / options_.largest_travel)), 1,
                    most_load_parts);
}

}  // namespace paperbake
