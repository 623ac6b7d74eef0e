#include "core/step2_crumple/crumpled_mesh.h"

#include "core/geometry/curvature.h"
#include "core/geometry/edge_operations.h"
#include "core/geometry/prescribed_creases.h"
#include "core/geometry/singular_vertices.h"
#include "core/model/degrees.h"
#include "core/model/serializer.h"
#include "core/step2_crumple/conflicts.h"
#include "core/step2_crumple/singular_points.h"
#include "core/step2_crumple/vertex_moves.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace paperbake {
namespace {

// A junction: a vertex that turns in its second direction and at which so many folds meet
constexpr double junction_fold = radians_of(18);
constexpr int junction_folds = 3;
constexpr double junction_way = 0.002;  // [1] for which it must last
// [1] of the size of its ring, within which a junction is the same as in the step before
constexpr double junction_reach = 0.3;
constexpr double apart = 1.2;  // [1] of the ring of a new point: nothing else changes there
// least distance of two points: [1] of the local edge length, and [1] of min_spacing
constexpr double facet_share = 0.45, closest_share = 0.5;

// A vertex without such a fold has no reason to slide, and one with a sharper one no way to: paper
// that was folded by so much has broken there, and the fold stays.
constexpr double sliding_fold = radians_of(8), lasting_fold = radians_of(90);
// [1] of its longest edge: how far a vertex slides while the sheet is deformed by full_travel
constexpr double stride = 0.2, full_travel = 0.004;
constexpr double steep = 3;  // [1] a force of E/3h and more moves a vertex by a full stride
constexpr double least_rate = 0.05, slower = 0.5, faster = 1.3;

constexpr double flat_fold = radians_of(4);   // an edge that carries no fold may be flipped
constexpr double kept_fold = radians_of(12);  // vertices with such a fold are not merged
constexpr double near_point = 0.8;            // [1] of the edge length around a singular point
constexpr double merged_below = 0.8;          // [1] in the metric
// [1] membrane energy over bending energy, of the whole sheet, and of a ring in itself or in the
// mean ring. In a ridge the membrane stores a sixth of the energy [Lobkovsky 1997], in crumpled
// sheets up to a third: what stores more is a mesh that cannot fold.
constexpr double locked = 0.5, locked_ring = 0.5;
constexpr double refinement = 0.9;  // [1] of the lengths of edges there, by full_travel

}  // namespace

/// The mesh as the elastic step left it, and what is measured on it before anything moves: a vertex
/// that has moved is not in equilibrium, and its energies mean nothing.
struct CrumpledMesh::Mesh {
  Hinges hinges;
  VertexRings rings;
  std::vector<double> folds;    // [rad] |dihedral angle| of the hinges; 0 on a prescribed crease
  std::vector<double> largest;  // |V| [rad] the largest fold at a vertex
  std::vector<int> meeting;     // |V| number of folds that make a junction
  std::vector<double> turn;     // |V| [rad] Conflicts::turn
  Eigen::VectorXd membrane, bending;  // |V| [J] of the triangles around it
  std::vector<char> kept;             // |V| 1: a handle, a singular point or the end of a crease
  std::vector<char> free;       // |V| 1: may move on the pattern: inside the sheet, and not kept
  std::vector<Vector2d> born;   // [m] points of this step
  std::vector<double> cleared;  // [m] and how far around them nothing else changes

  Mesh(const Sheet&, const CrumpledMesh&, const Input&);
  bool is_cleared(const Vector2d& p) const {
    for (std::size_t k = 0; k < born.size(); ++k)
      if ((born[k] - p).norm() < cleared[k]) return true;
    return false;
  }
};

CrumpledMesh::Mesh::Mesh(const Sheet& sheet, const CrumpledMesh& method, const Input& input)
    : hinges(find_hinges(sheet.triangles)),
      rings(sheet.triangles, hinges, sheet.pattern.rows()),
      folds(bending_turns(sheet, hinges)),
      largest(sheet.pattern.rows(), 0.0),
      meeting(sheet.pattern.rows(), 0),
      turn(find_conflicts(sheet, vertex_curvature(sheet.pattern, sheet.triangles, hinges, folds),
                          input.fixed, method.options_)
               .turn),
      membrane(Eigen::VectorXd::Zero(sheet.pattern.rows())),
      bending(membrane),
      kept(singular_vertices(sheet)),
      free(sheet.pattern.rows()) {
  for (std::size_t h = 0; h < folds.size(); ++h) {
    folds[h] = std::abs(folds[h]);
    const auto& ends = hinges.hinges[h].vertices;
    const bool on_crease = is_on_crease(sheet.prescribed_creases, sheet.pattern, ends[0], ends[1]);
    for (int k = 0; k < 2; ++k) {
      const int v = ends[k];
      largest[v] = std::max(largest[v], folds[h]);
      meeting[v] += folds[h] > junction_fold;
      kept[v] |= on_crease;
    }
  }
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i) {
      membrane[sheet.triangles(t, i)] += input.stored.membrane[t];
      bending[sheet.triangles(t, i)] += input.stored.bending[t];
    }
  for (std::size_t v = 0; v < free.size(); ++v) {
    kept[v] |= v < input.fixed.size() && input.fixed[v];
    free[v] = !kept[v] && !rings.border[v];
  }
}

CrumpledMesh::CrumpledMesh(const Pattern& pattern, const Paper& paper,
                           const CrumpleOptions& options, std::uint32_t seed, std::uint32_t sheet)
    : pattern_(pattern),
      paper_(paper),
      options_(options),
      seed_(seed),
      sheet_(sheet),
      sizes_(pattern, paper) {}

bool CrumpledMesh::promote_vertex(Sheet& sheet, const Mesh& mesh, int vertex, int frame) {
  const Vector2d place = sheet.pattern.row(vertex);
  // where folds are known to meet, points may be nearer to each other than where one is guessed
  const double spacing = std::max(closest_share * min_spacing(pattern_, paper_, options_),
                                  facet_share * sizes_.at(place));
  const auto event = static_cast<std::uint32_t>(sheet.singular.size());
  const auto p = draw_singular_point(sheet, pattern_, paper_, {place, spacing}, options_,
                                     {seed_, sheet_, event});
  if (!p) return false;
  move_vertex(sheet, mesh.rings, vertex, *p);
  const Vector2d born = sheet.pattern.row(vertex);
  if (options_.singular_point_rules.forbids(born)) return false;
  sheet.singular.push_back({born, frame, std::to_string(mesh.meeting[vertex]) + " folds meet"});
  return true;
}

int CrumpledMesh::promote(Sheet& sheet, Mesh& mesh, const Input& input) {
  std::vector<int> junctions;
  std::vector<LastingPlaces::Seen> seen;
  for (int v = 0; v < sheet.pattern.rows(); ++v)
    if (mesh.free[v] && mesh.turn[v] >= options_.conflict_turn &&
        mesh.meeting[v] >= junction_folds) {
      junctions.push_back(v);
      seen.push_back({sheet.pattern.row(v), junction_reach * ring_size(sheet, mesh.rings, v)});
    }
  const std::vector<double> lasted = junctions_.see(seen, input.travel);
  std::vector<int> order(junctions.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return mesh.turn[junctions[a]] > mesh.turn[junctions[b]]; });
  int births = 0;
  for (const int k : order) {
    const int v = junctions[k];
    if (lasted[k] < junction_way || mesh.is_cleared(sheet.pattern.row(v))) continue;
    if (static_cast<int>(sheet.singular.size()) >= options_.max_points) break;
    const double reach = apart * ring_size(sheet, mesh.rings, v);
    if (!promote_vertex(sheet, mesh, v, input.frame)) continue;
    mesh.kept[v] = 1;
    mesh.free[v] = 0;
    mesh.born.push_back(sheet.pattern.row(v));
    mesh.cleared.push_back(reach);
    ++births;
  }
  return births;
}

int CrumpledMesh::slide(Sheet& sheet, const Mesh& mesh, const Input& input) {
  sliders_.resize(sheet.pattern.rows());
  int moved = 0;
  for (int v = 0; v < sheet.pattern.rows(); ++v) {
    const Vector2d place = sheet.pattern.row(v), force = input.stored.configurational_force.row(v);
    const double f = force.norm();
    if (!mesh.free[v] || mesh.largest[v] < sliding_fold || mesh.largest[v] > lasting_fold ||
        !(f > 0) || mesh.is_cleared(place))
      continue;
    Slider& slider = sliders_[v];
    const Vector2d direction = force / f;
    slider.rate = std::clamp(slider.rate * (direction.dot(slider.direction) < 0 ? slower : faster),
                             least_rate, 1.0);
    slider.direction = direction;
    const double h = ring_size(sheet, mesh.rings, v);
    const double length = stride * h * slider.rate * input.travel / full_travel *
                          std::min(1.0, steep * f * h / mesh.bending[v]);
    moved += move_vertex(sheet, mesh.rings, v, place + length * direction) > 0;
  }
  return moved;
}

void CrumpledMesh::refine_where_locked(const Sheet& sheet, const Mesh& mesh, const Input& input) {
  const double membrane = input.stored.membrane.sum(), bending = input.stored.bending.sum();
  if (!(membrane > locked * bending)) return;
  const double rate = std::min(1.0, membrane / (locked * bending) - 1),
               factor = std::pow(refinement, rate * input.travel / full_travel);
  refine_locked_rings(sheet, mesh, factor);
}

void CrumpledMesh::refine_locked_rings(const Sheet& sheet, const Mesh& mesh, double factor) {
  const double mean_ring = mesh.bending.mean();
  for (int v = 0; v < sheet.pattern.rows(); ++v)
    if (mesh.membrane[v] > locked_ring * std::max(mesh.bending[v], mean_ring))
      sizes_.refine(sheet.pattern.row(v), 0.5 * ring_size(sheet, mesh.rings, v), factor);
}

int CrumpledMesh::fit_sizes(Sheet& sheet, const Mesh& mesh) {
  Points3 metric = sizes_.metric(sheet.pattern);
  std::vector<char> kept = mesh.kept;
  for (int v = 0; v < sheet.pattern.rows(); ++v) {
    const Vector2d p = sheet.pattern.row(v);
    const bool beside_point =
        std::any_of(sheet.singular.begin(), sheet.singular.end(), [&](const SingularPoint& s) {
          return (s.pattern - p).norm() < near_point * sizes_.at(s.pattern);
        });
    kept[v] |= mesh.largest[v] > kept_fold && !beside_point;
  }
  const int gone = collapse_short_edges(sheet, metric, kept, merged_below);
  // a collapse and a division in one step could leave as many vertices as there were, under other
  // numbers
  if (gone > 0) {
    sliders_.clear();
    return gone;
  }
  return split_long_edges(sheet, metric, options_.max_triangles);
}

CrumpleReport CrumpledMesh::step(Sheet& sheet, const Input& input) {
  CrumpleReport report;
  Mesh mesh(sheet, *this, input);
  report.births = promote(sheet, mesh, input);
  if (input.at_minimum) report.moves = slide(sheet, mesh, input);
  refine_where_locked(sheet, mesh, input);
  report.flips = flip_to_delaunay(sheet, sizes_.metric(sheet.pattern), flat_fold);
  report.resized = fit_sizes(sheet, mesh);
  return report;
}

int CrumpledMesh::refine_where_jammed(Sheet& sheet, const std::vector<char>& fixed,
                                      const LocalEnergies& stored) {
  constexpr double bisected = 0.7;  // [1] of the lengths of edges: each is divided once
  if (!(stored.membrane.sum() > locked * stored.bending.sum())) return 0;
  Mesh mesh(sheet, *this, {fixed, stored, 0, 0});
  refine_locked_rings(sheet, mesh, bisected);
  return fit_sizes(sheet, mesh);
}

static void archive(Serializer& a, CrumpledMesh::Slider& s) { a(s.rate, s.direction); }

void CrumpledMesh::archive(Serializer& a) { a(sizes_, junctions_, sliders_); }

}  // namespace paperbake
