#include "core/render/shot_record.h"

#include "core/geometry/hinges.h"
#include "core/geometry/measure.h"
#include "core/geometry/mesh_coarseness.h"
#include "core/geometry/prescribed_creases.h"
#include "core/render/crease_memory.h"
#include "core/render/curved_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace paperbake {
namespace {

/// An edge of a mesh with its ends in order, and the key that tells it from others.
CreaseSegment line_of(const Points2& pattern, int v, int w) {
  const Vector2d p = pattern.row(v), q = pattern.row(w);
  const bool in_order = std::make_pair(p.x(), p.y()) < std::make_pair(q.x(), q.y());
  return {in_order ? p : q, in_order ? q : p};
}
std::array<long, 4> key_of(const CreaseSegment& line) {
  const auto key = [](double c) { return std::lround(1e7 * c); };
  return {key(line.a.x()), key(line.a.y()), key(line.b.x()), key(line.b.y())};
}

/// By how much an edge is too short that runs straight across a fold, from one side to the other as
/// far beyond it. [1]
double shortening(double theta) { return 1 - std::cos(0.5 * theta); }

}  // namespace

void ShotRecord::add(const AnimatedFrame& frame) {
  const Sheet& sheet = *frame.sheet;
  const bool same = !meshes_.empty() && same_entries(meshes_.back().pattern, sheet.pattern) &&
                    same_entries(meshes_.back().triangles, sheet.triangles);
  if (!same) meshes_.push_back({sheet.pattern, sheet.triangles});
  RecordedFrame record;
  record.frame = frame.frame;
  record.mesh = static_cast<int>(meshes_.size()) - 1;
  record.x = sheet.x.cast<float>();
  record.carried = frame.carried.cast<float>();
  std::copy_if(sheet.crease_edges.begin(), sheet.crease_edges.end(),
               std::back_inserter(record.folded), [](const CreaseEdge& e) { return e.folded; });
  for (std::size_t h = 0; h < frame.handles.size(); ++h)
    if (frame.handles[h].state != HandleFrame::free) record.held.push_back(static_cast<int>(h));
  record.held_at.resize(record.held.size(), 3);
  record.keyed.resize(record.held.size(), 3);
  for (std::size_t k = 0; k < record.held.size(); ++k) {
    record.held_at.row(k) = frame.handles[record.held[k]].at;
    record.keyed.row(k) = frame.handles[record.held[k]].keyed;
  }
  begins_sharp_ |= frames_.empty() && sharpest_fold(sheet) > crease_begins;
  touched_ |= frame.statistics.on_colliders > 0 || frame.statistics.touching_others > 0;
  const Hinges hinges = find_hinges(sheet.triangles);
  if (is_crumpled(sheet)) remember(sheet, hinges, same, record);
  frames_.push_back(std::move(record));
  singular_ = sheet.singular;  // the list only grows: paper does not heal
  folds_ = folded_creases(sheet);
  edges_ += mean_edge(sheet.pattern, sheet.triangles);

  for (const Hinge& hinge : hinges.hinges) {
    const double theta = dihedral_angle(sheet.x, hinge);
    if (crease_share(theta) <= 0) continue;
    const CreaseSegment line = line_of(sheet.pattern, hinge.vertices[0], hinge.vertices[1]);
    FoldedEdge& crease = creases_[key_of(line)];
    crease.a = line.a;
    crease.b = line.b;
    crease.error += std::pow(shortening(theta), 2);
  }
}

/// Only of a crumpled sheet: the edges of smooth paper are those of its mesh.
void ShotRecord::remember(const Sheet& sheet, const Hinges& hinges, bool same_mesh,
                          RecordedFrame& record) {
  std::vector<std::pair<int, int>> edges;
  for (const Hinge& hinge : hinges.hinges) edges.emplace_back(hinge.vertices[0], hinge.vertices[1]);
  std::vector<double> sharpest(edges.size(), 0.0);
  if (!creases_so_far_.empty() && same_mesh)
    for (const auto& [hinge, crease] : creases_so_far_) sharpest[hinge] = crease.share;
  else if (!creases_so_far_.empty()) {
    std::vector<RememberedCrease> before;
    for (const auto& [hinge, crease] : creases_so_far_) before.push_back(crease);
    sharpest = CreasesOfMesh(sheet.pattern, edges)
                   .least_shares(meshes_[meshes_.size() - 2].pattern, before);
  }
  creases_so_far_.clear();
  for (std::size_t h = 0; h < edges.size(); ++h) {
    const double share = crease_share(dihedral_angle(sheet.x, hinges.hinges[h]));
    const RememberedCrease crease{edges[h].first, edges[h].second, std::max(share, sharpest[h])};
    if (crease.share > 0) creases_so_far_.emplace_back(h, crease);
    if (crease.share > share) record.remembered.push_back(crease);
  }
}

Sheet ShotRecord::sheet(const RecordedFrame& frame) const {
  const Mesh& mesh = meshes_[frame.mesh];
  Sheet sheet{mesh.pattern, frame.x.cast<double>(), {}, mesh.triangles, {}, folds_};
  sheet.crease_edges = frame.folded;
  sheet.remembered = frame.remembered;
  return sheet;
}

Sheet ShotRecord::carried(const RecordedFrame& frame) const {
  Sheet before = sheet(frame);
  before.x = frame.carried.cast<double>();
  return before;
}

RenderFeatures ShotRecord::features(const Shot& shot) const {
  RenderFeatures features;
  features.prescribed_creases = folds_;
  for (const Handle& handle : shot.handles) features.points.push_back(handle.pattern);
  for (std::size_t h = 0; h < shot.handles.size(); ++h)
    for (const Vector2d& p : disc_rim(shot.pattern, shot.handles[h].pattern,
                                      disc_radius(shot.handles, h, shot.pattern)))
      features.points.push_back(p);
  for (const SingularPoint& point : singular_) features.points.push_back(point.pattern);
  const double least =
      std::min(2.0, 0.25 * frames_.size()) * std::pow(shortening(crease_begins), 2);
  for (const auto& [key, crease] : creases_)
    if (crease.error >= least && !crease_under(folds_, crease.a, crease.b))
      features.creases.push_back({crease.a, crease.b, crease.error});
  return features;
}

std::vector<CreaseSegment> ShotRecord::edges(const std::set<SimulatedTriangle>& triangles) const {
  std::map<std::array<long, 4>, CreaseSegment> found;
  std::map<int, Hinges> hinges;  // of the meshes
  for (const auto& [m, triangle] : triangles) {
    const Mesh& mesh = meshes_[m];
    if (!hinges.count(m)) hinges[m] = find_hinges(mesh.triangles);
    for (const int h : hinges[m].of_triangle[triangle]) {
      if (h < 0) continue;
      const auto& ends = hinges[m].hinges[h].vertices;
      const CreaseSegment line = line_of(mesh.pattern, ends[0], ends[1]);
      found.emplace(key_of(line), line);
    }
  }
  std::vector<CreaseSegment> edges;
  for (const auto& [key, line] : found) edges.push_back(line);
  return edges;
}

double ShotRecord::edge() const { return frames_.empty() ? 0 : edges_ / frames_.size(); }

}  // namespace paperbake
