#include "core/render/render_surface.h"

#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/geometry/prescribed_creases.h"
#include "core/model/segment2.h"
#include "core/render/curved_surface.h"
#include "core/render/strain_limit.h"

#include <algorithm>
#include <set>

namespace paperbake {
namespace {

CreasedNormals normals_of(const RenderMesh& mesh) {
  std::vector<char> sharp;
  for (const auto& [a, b] : mesh.creases)
    sharp.push_back(is_on_crease(mesh.prescribed_creases, mesh.pattern, a, b));
  return CreasedNormals(mesh.triangles, mesh.creases, sharp);
}

}  // namespace

struct RenderSurface::ForFrames {
  ShapeFit shape_fit;
  StrainLimit coarse_limit;
  std::optional<StrainLimit> fine_limit;
  CrossingCounter counter;  // of mesh()

  const StrainLimit& limit() const { return fine_limit ? *fine_limit : coarse_limit; }
};

RenderSurface::RenderSurface(RenderMesh mesh, const ShapeFitOptions& options, int refine)
    : simulated_edges_(mesh.simulated_edges),
      coarse_(std::move(mesh)),
      fit_options_(options),
      coarse_normals_(normals_of(coarse_)),
      coarse_creases_(coarse_.pattern, coarse_.creases) {
  if (refine > 0) fine_ = subdivide(coarse_, coarse_normals_.of_corner());
  apart_.emplace(this->mesh().pattern, this->mesh().triangles);
  mean_edge_ = mean_edge(this->mesh().pattern, this->mesh().triangles);
  if (fine_) {
    fine_normals_.emplace(normals_of(fine_->mesh));
    fine_creases_.emplace(fine_->mesh.pattern, fine_->mesh.creases);
  }
}

RenderSurface::RenderSurface(RenderSurface&&) = default;
RenderSurface& RenderSurface::operator=(RenderSurface&&) = default;
RenderSurface::~RenderSurface() = default;

std::vector<MeshPoint> RenderSurface::locate_on(const Points2& pattern,
                                                const Triangles& triangles) const {
  const PointLocator locator(pattern, triangles);
  std::vector<MeshPoint> places;
  const Points2& all = mesh().pattern;
  places.reserve(all.rows());
  for (int v = 0; v < all.rows(); ++v) {
    const Vector2d p = all.row(v);
    MeshPoint place = locator.locate(p);
    const auto corner = [&](int i) -> Vector2d {
      return pattern.row(triangles(place.triangle, i));
    };
    Vector2d found(0, 0);
    for (int i = 0; i < 3; ++i) found += place.weights[i] * corner(i);
    const Vector2d u = corner(1) - corner(0), w = corner(2) - corner(0), off = p - found;
    const double area = cross(u, w);
    // outside the border the triangle is extended, but not farther than its own size: a needle
    // would end anywhere
    if (off.squaredNorm() > 1e-18 && area > 0 && off.squaredNorm() < 0.1 * area) {
      const double more1 = cross(off, w) / area, more2 = cross(u, off) / area;
      place.weights += Vector3d(-more1 - more2, more1, more2);
    }
    places.push_back(place);
  }
  return places;
}

void RenderSurface::hold(const std::vector<int>& points) {
  if (!for_frames_) {
    const RenderMesh& all = mesh();
    for_frames_.reset(new ForFrames{{coarse_.pattern, coarse_.triangles, fit_options_,
                                     coarse_.prescribed_creases, coarse_.creases},
                                    {coarse_.pattern, coarse_.triangles},
                                    {},
                                    {all.pattern, all.triangles}});
    if (fine_) for_frames_->fine_limit.emplace(all.pattern, all.triangles);
  }
  held_.clear();
  for (const int p : points) held_.push_back(coarse_.point_vertex[p]);
  std::vector<int> vertices = held_;
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  for_frames_->shape_fit.hold(vertices);
  is_held_.assign(mesh().pattern.rows(), 0);
  for (const int v : vertices) is_held_[v] = 1;
}

RenderSurface::Shape RenderSurface::shape(const Sheet& sheet,
                                          const std::vector<MeshPoint>& places) const {
  std::vector<int> exact;  // simulated vertices at held points
  for (const int v : held_)
    for (int i = 0; i < 3; ++i)
      if (places[v].weights[i] > 1 - 1e-6) exact.push_back(sheet.triangles(places[v].triangle, i));
  const CurvedSurface surface = curve(sheet, exact);
  Shape shape{Points3(coarse_.pattern.rows(), 3), Points3(coarse_.pattern.rows(), 3)};
  for (int v = 0; v < coarse_.pattern.rows(); ++v) {
    shape.x.row(v) = surface.at(places[v]);
    shape.curvature.row(v) = interpolate(places[v], sheet.triangles, surface.curvature);
  }
  return shape;
}

RenderFrame RenderSurface::frame(const Sheet& sheet, const std::vector<MeshPoint>& places,
                                 Shape shape, const Points3& held_at) const {
  for (std::size_t k = 0; k < held_.size(); ++k) shape.x.row(held_[k]) = held_at.row(k);

  RenderFrame frame;
  frame.remembered = coarse_creases_.least_shares(sheet.pattern, sheet.remembered);
  frame.x = for_frames_->shape_fit(shape.x, shape.curvature, frame.remembered);
  for_frames_->coarse_limit(frame.x, is_held_);
  if (fine_) {
    frame.x = fine_->positions(frame.x, coarse_normals_.normals(frame.x, frame.remembered));
    frame.remembered = fine_creases_->least_shares(sheet.pattern, sheet.remembered);
    limit_strain(frame.x);
  }
  frame.counted.x = frame.x.cast<float>().cast<double>();
  frame.counted.crossings = crossings(frame.counted.x);
  if (frame.counted.crossings > 0) frame.kept_apart = keep_apart(frame.x, sheet, places);
  shade(frame);
  return frame;
}

void RenderSurface::limit_strain(Points3& x) const { for_frames_->limit()(x, is_held_); }

double RenderSurface::worst_edge(const Points3& x) const { return for_frames_->limit().worst(x); }

int RenderSurface::crossings(const Points3& x) const { return for_frames_->counter(x); }

void RenderSurface::shade(RenderFrame& frame) const {
  const CreasedNormals& normals = fine_ ? *fine_normals_ : coarse_normals_;
  frame.normals = normals.normals(frame.x, frame.remembered);
  frame.crease = normals.strength(frame.x);
}

Points3 RenderSurface::linear_positions(const Sheet& sheet,
                                        const std::vector<MeshPoint>& places) const {
  Points3 linear_positions(mesh().pattern.rows(), 3);
  for (std::size_t v = 0; v < places.size(); ++v)
    linear_positions.row(v) = interpolate(places[v], sheet.triangles, sheet.x);
  return linear_positions;
}

bool RenderSurface::may_have_intersecting_triangles(const Sheet& sheet) const {
  // a chord across a fold is no farther from it than half its length
  const double farthest = 0.5 * mean_edge_;
  return may_meet_itself(sheet, Eigen::VectorXd::Constant(sheet.triangles.rows(), farthest));
}

std::vector<int> RenderSurface::intersecting_triangles(const Sheet& sheet,
                                                       const std::vector<MeshPoint>& places) const {
  const std::vector<std::pair<int, int>> pairs =
      apart_->intersections(linear_positions(sheet, places));
  if (pairs.empty() || paperbake::crossings(sheet) > 0) return {};
  std::set<int> triangles;
  for (const auto& [a, b] : pairs)
    for (int i = 0; i < 3; ++i) {
      triangles.insert(places[mesh().triangles(a, i)].triangle);
      triangles.insert(places[mesh().triangles(b, i)].triangle);
    }
  return {triangles.begin(), triangles.end()};
}

/// returns  whether x was changed
bool RenderSurface::keep_apart(Points3& x, const Sheet& sheet,
                               const std::vector<MeshPoint>& places) const {
  const Points3 exact = linear_positions(sheet, places);
  const Untangler::Lengths lengths{[this](Points3& at) { limit_strain(at); },
                                   [this](const Points3& at) { return worst_edge(at); }};
  // between simulated edges there are needles, which may turn over where no layers meet
  if (simulated_edges_ == SimulatedEdges::kept)
    return apart_->untangle_alternating(x, exact, lengths, is_held_).changed;
  // lengths that are wrong after this are restored, as far as the layers stay apart
  constexpr int max_turns = 6;
  Points3 mended = exact;
  limit_strain(mended);
  const PointLocator locator(sheet.pattern, sheet.triangles);
  const auto flat_at = [&](const Vector2d& p) {
    return interpolate(locator.locate(p), sheet.triangles, sheet.x);
  };
  Untangler::Outcome outcome = (*apart_)(x, mended, flat_at, is_held_);
  const bool changed = outcome.changed;
  for (int turn = 0; outcome.changed && turn < max_turns; ++turn) {
    limit_strain(x);
    const std::size_t before = outcome.left;
    outcome = (*apart_)(x, mended, flat_at, is_held_);
    if (before > 0 && outcome.left >= before) break;  // no other turn will help
  }
  if (!outcome.apart()) apart_->untangle_alternating(x, exact, lengths, is_held_);
  return changed;
}

RenderSurface make_render_surface(const Pattern& pattern, const RenderFeatures& features,
                                  double simulated_edge, Quality quality) {
  constexpr int max_triangles = 400000;
  // [m] length of an edge on a sheet of this longer side, as --quality has it; hero halves it
  constexpr double draft = 0.005, shot = 0.002, of_side = 0.2;
  // [1] length over width of a sheet from which the width counts: a shot has eight edges across
  constexpr double slender = 12.5;
  const double side = std::min(longer_side(pattern), slender * mean_width(pattern));
  const double edge = (quality == Quality::draft ? draft : shot) * side / of_side;
  const int refine = quality == Quality::hero ? 1 : 0;
  ShapeFitOptions options;
  options.length = simulated_edge / 6;
  options.may_crease = features.may_crease;
  Pattern folded = pattern;
  folded.prescribed_creases = features.prescribed_creases;
  RenderMesh mesh = mesh_for_render(folded, edge, features, max_triangles >> (2 * refine));
  return RenderSurface(std::move(mesh), options, refine);
}

}  // namespace paperbake
