#include "core/render/render_mesh.h"

#include "core/geometry/pattern_mesh.h"
#include "core/geometry/prescribed_creases.h"
#include "core/model/error.h"
#include "core/model/segment2.h"
#include "core/render/crease_rows.h"
#include "core/render/short_edges.h"
#include "core/render/turnable_edges.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

namespace paperbake {
namespace {

// [1] total length of simulated edges, at most this x area / edge
constexpr double max_length = 6;
constexpr double border = 1e-3;  // [edges] how closely the mesh follows the border
// [edges] shorter edges, where lines cross beside each other, are merged
constexpr double shortest = 0.02;

/// Straight lines, to look for those that a point lies on.
class Lines {
 public:
  /// near  [m] how far from a line a point may be that lies on it
  Lines(std::vector<CreaseSegment> lines, double near) : lines_(std::move(lines)), near_(near) {
    for (const CreaseSegment& line : lines_) {
      Eigen::AlignedBox2d box(line.a);
      box.extend(line.b);
      boxes_.emplace_back((box.min().array() - near).matrix(), (box.max().array() + near).matrix());
    }
  }
  /// The numbers of the lines that a point [m] lies on, in order.
  std::vector<int> at(const Vector2d& p) const {
    std::vector<int> found;
    for (std::size_t k = 0; k < lines_.size(); ++k)
      if (boxes_[k].contains(p) && distance_to_segment(p, lines_[k].a, lines_[k].b) <= near_)
        found.push_back(static_cast<int>(k));
    return found;
  }

 private:
  std::vector<CreaseSegment> lines_;
  std::vector<Eigen::AlignedBox2d> boxes_;  // a little larger than the lines
  double near_;
};

bool have_common(const std::vector<int>& a, const std::vector<int>& b) {
  return std::any_of(a.begin(), a.end(),
                     [&](int k) { return std::find(b.begin(), b.end(), k) != b.end(); });
}

/// Edges on the prescribed creases of the pattern.
std::set<std::pair<int, int>> folded_edges(const RenderMesh& mesh,
                                           const std::vector<PrescribedCrease>& folds) {
  std::set<std::pair<int, int>> found;
  for (int t = 0; t < mesh.triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i)
      if (const int a = mesh.triangles(t, i), b = mesh.triangles(t, (i + 1) % 3);
          a < b && is_on_crease(folds, mesh.pattern, a, b))
        found.insert({a, b});
  return found;
}

bool has_room(const Pattern& pattern, double edge, const std::vector<CreaseSegment>& simulated) {
  double length = 0;
  for (const CreaseSegment& line : simulated) length += (line.b - line.a).norm();
  return length <= max_length * area(pattern) / edge;
}

/// The mesh that has every simulated edge as a row of edges, and the creases too, whose ends go to
/// those of simulated edges nearby; nothing when some of them cross so near to others that no
/// triangulation has them all.
std::optional<RenderMesh> mesh_along_edges(const Pattern& pattern, double edge,
                                           const RenderFeatures& features) {
  const double near = 3e-6 * longer_side(pattern);
  Pattern lined = pattern;
  Sites ends(merged_within * edge);
  for (const Vector2d& p : features.points) ends.add(p);
  for (const CreaseSegment& line : features.edges) {
    lined.prescribed_creases.push_back({{line.a, line.b}});
    ends.add(line.a);
    ends.add(line.b);
  }
  const std::vector<CreaseSegment> creases =
      chosen_creases(features.creases, 0.5 * area(pattern) / edge, edge, features.edges);
  std::vector<CreaseSegment> sharp = features.creases;
  for (const CreaseSegment& crease : creases) {
    const Vector2d a = ends.points[ends.nearest_or_new(crease.a)],
                   b = ends.points[ends.nearest_or_new(crease.b)];
    if (a == b) continue;
    lined.prescribed_creases.push_back({{a, b}});
    sharp.push_back({a, b});
  }
  std::optional<PatternMesh> mesh = try_mesh_pattern(lined, edge, features.points, 0, border);
  if (!mesh) return std::nullopt;
  RenderMesh result{std::move(mesh->vertices),  std::move(mesh->triangles), {}, {},
                    pattern.prescribed_creases, SimulatedEdges::kept};
  result.point_vertex.assign(mesh->point_vertex.begin(),
                             mesh->point_vertex.begin() + features.points.size());
  std::set<std::pair<int, int>> found = folded_edges(result, pattern.prescribed_creases);
  const Lines lines(std::move(sharp), near);
  std::vector<std::vector<int>> lines_at;
  for (int v = 0; v < result.pattern.rows(); ++v)
    lines_at.push_back(lines.at(result.pattern.row(v)));
  for (int t = 0; t < result.triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i)
      if (const int a = result.triangles(t, i), b = result.triangles(t, (i + 1) % 3);
          a < b && have_common(lines_at[a], lines_at[b]))
        found.insert({a, b});
  result.creases.assign(found.begin(), found.end());
  return result;
}

/// The mesh in which creases are rows of points at even distances.
RenderMesh mesh_along_rows(const Pattern& pattern, double edge, const RenderFeatures& features) {
  const double exact = 1e-6 * longer_side(pattern);
  Sites sites(merged_within * edge);
  std::vector<int> site_of_point;
  for (const Vector2d& p : features.points) {
    // a handle keeps its place even if another point is near
    const int known = sites.nearest(p);
    site_of_point.push_back(known >= 0 && (sites.points[known] - p).norm() <= exact ? known
                                                                                    : sites.add(p));
  }
  const std::size_t given = sites.points.size();
  // creases end in the corners of the border, not beside them
  for (const Vector2d& p : pattern.outline) sites.nearest_or_new(p);
  for (const auto& hole : pattern.holes)
    for (const Vector2d& p : hole) sites.nearest_or_new(p);
  for (const Vector2d& p : crease_points(pattern.prescribed_creases)) sites.nearest_or_new(p);
  const std::vector<CreaseSegment> prescribed = segments_of(pattern.prescribed_creases),
                                   creases =
                                       chosen_creases(features.creases, 0.5 * area(pattern) / edge,
                                                      edge, prescribed);
  std::vector<std::vector<int>> rows;
  for (const CreaseSegment& crease : creases)
    rows.push_back(lay(crease, creases, prescribed, pattern, edge, sites));

  // index of a needed site among the required points; -1: not needed
  std::vector<int> number(sites.points.size(), -1);
  std::vector<Vector2d> required(sites.points.begin(), sites.points.begin() + given);
  for (std::size_t s = 0; s < given; ++s) number[s] = static_cast<int>(s);
  for (const std::vector<int>& row : rows)
    for (const int s : row)
      if (number[s] < 0) {
        number[s] = static_cast<int>(required.size());
        required.push_back(sites.points[s]);
      }
  std::optional<PatternMesh> found_mesh = try_mesh_pattern(pattern, edge, required, 0, border);
  if (!found_mesh)
    throw Error(ErrorCode::simulation, "render mesh",
                "Some points and creases of the sheet are too near to each other or to its border.",
                "With another seed they lie elsewhere.");
  PatternMesh& mesh = *found_mesh;
  RenderMesh result{std::move(mesh.vertices), std::move(mesh.triangles), {}, {}};
  for (const int site : site_of_point)
    result.point_vertex.push_back(mesh.point_vertex[number[site]]);
  TurnableEdges edges(result.pattern, result.triangles);
  std::set<std::pair<int, int>> found = folded_edges(result, pattern.prescribed_creases);
  for (const std::vector<int>& row : rows)
    for (std::size_t k = 0; k + 1 < row.size(); ++k) {
      const int a = mesh.point_vertex[number[row[k]]], b = mesh.point_vertex[number[row[k + 1]]];
      if (a == b) continue;
      if (edges.has(a, b) || edges.turn_to(a, b, found)) {
        found.insert(std::minmax(a, b));
      } else if (const int v = edges.between(a, b, merged_within * edge); v >= 0) {
        found.insert(std::minmax(a, v));
        found.insert(std::minmax(v, b));
      }
    }
  result.creases.assign(found.begin(), found.end());
  result.prescribed_creases = pattern.prescribed_creases;
  return result;
}

std::vector<CreaseSegment> seams_and_jumps(const RenderFeatures& features) {
  std::vector<CreaseSegment> lines = features.seams;
  lines.insert(lines.end(), features.jumps.begin(), features.jumps.end());
  return lines;
}

/// The mesh along simulated edges, seams and jumps where there is one, else the one along rows.
RenderMesh mesh_with_features(const Pattern& pattern, double edge, const RenderFeatures& features) {
  if (const std::vector<CreaseSegment> lines = seams_and_jumps(features); !lines.empty()) {
    RenderFeatures with_lines = features, without = features;
    (features.jumps.empty() ? without.seams : without.jumps).clear();
    with_lines.edges.insert(with_lines.edges.end(), lines.begin(), lines.end());
    if (has_room(pattern, edge, with_lines.edges))
      if (auto mesh = mesh_along_edges(pattern, edge, with_lines)) {
        if (features.edges.empty()) mesh->simulated_edges = SimulatedEdges::none;
        return std::move(*mesh);
      }
    return mesh_with_features(pattern, edge, without);
  }
  SimulatedEdges simulated_edges = SimulatedEdges::none;
  if (!features.edges.empty()) {
    const bool fits = has_room(pattern, edge, features.edges);
    if (fits)
      if (auto mesh = mesh_along_edges(pattern, edge, features)) return std::move(*mesh);
    // a pattern that is wrong itself has no mesh below either, and that throws
    simulated_edges = fits ? SimulatedEdges::too_close : SimulatedEdges::too_long;
  }
  RenderMesh mesh = mesh_along_rows(pattern, edge, features);
  mesh.simulated_edges = simulated_edges;
  return mesh;
}

/// Merges edges so short that the positions of a cache cannot hold their lengths.
void merge_beside_crossings(RenderMesh& mesh, const std::vector<CreaseSegment>& seams,
                            double edge) {
  std::vector<char> kept(mesh.pattern.rows(), 0);
  for (const int v : mesh.point_vertex) kept[v] = 1;
  const Lines lines(seams, 1e-9);
  const Points2 before = mesh.pattern;
  const std::vector<int> became = merge_short_edges(
      mesh.pattern, mesh.triangles, kept,
      [&](int a, int b) {
        return is_on_crease(mesh.prescribed_creases, before, a, b) ||
               have_common(lines.at(before.row(a)), lines.at(before.row(b)));
      },
      shortest * edge);
  for (int& v : mesh.point_vertex) v = became[v];
  std::set<std::pair<int, int>> creases;
  for (const auto& [a, b] : mesh.creases)
    if (became[a] != became[b]) creases.insert(std::minmax(became[a], became[b]));
  mesh.creases.assign(creases.begin(), creases.end());
}

}  // namespace

RenderMesh mesh_for_render(const Pattern& pattern, double edge, const RenderFeatures& features) {
  RenderMesh mesh = mesh_with_features(pattern, edge, features);
  merge_beside_crossings(mesh, seams_and_jumps(features), edge);
  return mesh;
}

RenderMesh mesh_for_render(const Pattern& pattern, double edge, const RenderFeatures& features,
                           int max_triangles) {
  // so many fit without features; with features it takes another round or two
  edge = std::max(edge, equilateral_edge(pattern, max_triangles));
  RenderMesh mesh = mesh_for_render(pattern, edge, features);
  // with longer edges there are no fewer: what is left are the triangles between the features
  while (mesh.triangles.rows() > max_triangles && edge < longer_side(pattern)) {
    edge *= 1.02 * std::sqrt(double(mesh.triangles.rows()) / max_triangles);
    mesh = mesh_for_render(pattern, edge, features);
  }
  return mesh;
}

}  // namespace paperbake
