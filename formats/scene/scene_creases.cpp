#include "formats/scene/scene_creases.h"

#include "core/geometry/hinges.h"
#include "core/geometry/line_fold.h"
#include "core/geometry/measure.h"
#include "core/geometry/prescribed_creases.h"
#include "core/model/degrees.h"
#include "core/model/error.h"
#include "core/model/segment2.h"
#include "formats/scene/scene_colliders.h"
#include "formats/scene/scene_deformation.h"
#include "formats/scene/scene_properties.h"
#include "formats/scene/sheet_point.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace paperbake {
namespace {

constexpr double max_distance = 1e-3;  // [m] from the sheet
constexpr double max_angle = 170;      // [degrees]
constexpr double same_place =
    1e-4;  // of the longer side: tolerance for the same place and for straight lines
constexpr double min_length = 2e-3;  // of the longer side: shortest segment of a crease
constexpr std::size_t max_edges = 1000;

/// The marked edges of a mesh as a graph whose vertices are welded.
struct EdgeGraph {
  std::vector<Vector3d> x;  // [m] world
  std::set<std::pair<int, int>> edges;
};

/// The vertices of all meshes of a node at the first frame, one mesh after the other. |V|x3 [m]
/// world  of every node at the first frame
Points3 vertices_of(const SceneNodes& scene, int node, const std::vector<Eigen::Affine3d>& world,
                    bool deformed) {
  if (deformed) return vertices_at(scene, node, world, scene.first_frame);
  std::vector<Vector3d> x;
  for (const int m : scene.file.nodes[node].meshes)
    for (Eigen::Index i = 0; i < scene.file.meshes[m].x.rows(); ++i)
      x.push_back(world[node] * Vector3d(scene.file.meshes[m].x.row(i)));
  return Eigen::Map<const Points3>(x.empty() ? nullptr : x.front().data(),
                                   static_cast<Eigen::Index>(x.size()), 3);
}

/// x  |V|x3 [m] the vertices of all meshes of the node
EdgeGraph edge_graph(const ImportedFile& file, const ImportedNode& node, const Points3& x,
                     const std::string& place) {
  std::vector<std::pair<int, int>> marked;  // rows of x
  Eigen::AlignedBox3d box;
  int before = 0;  // vertices of the meshes before
  for (const int m : node.meshes) {
    const ImportedMesh& mesh = file.meshes[m];
    for (int e = 0; e < mesh.creases.rows(); ++e) {
      marked.emplace_back(before + mesh.creases(e, 0), before + mesh.creases(e, 1));
      box.extend(Vector3d(x.row(marked.back().first)));
      box.extend(Vector3d(x.row(marked.back().second)));
    }
    before += static_cast<int>(mesh.x.rows());
  }
  const std::size_t count = marked.size();
  if (count > max_edges)
    throw Error(ErrorCode::scene, place,
                fmt::format("{} edges are marked as creases: more than {}.", count, max_edges),
                "Mark only those that are folded.");
  EdgeGraph graph;
  const double near = count > 0 ? 1e-6 * box.diagonal().norm() : 0;
  const auto vertex_at = [&](const Vector3d& p) {
    for (std::size_t i = 0; i < graph.x.size(); ++i)
      if ((graph.x[i] - p).norm() <= near) return static_cast<int>(i);
    graph.x.push_back(p);
    return static_cast<int>(graph.x.size()) - 1;
  };
  for (const auto& [from, to] : marked) {
    const int a = vertex_at(Vector3d(x.row(from))), b = vertex_at(Vector3d(x.row(to)));
    if (a != b) graph.edges.insert(std::minmax(a, b));
  }
  return graph;
}

/// Divides the edges of a graph into chains of vertices, each edge in one: first those between end
/// points and branchings, then closed loops.
std::vector<std::vector<int>> chains_of(std::set<std::pair<int, int>> edges, std::size_t vertices) {
  std::vector<std::set<int>> neighbours(vertices);
  for (const auto& [a, b] : edges) {
    neighbours[a].insert(b);
    neighbours[b].insert(a);
  }
  const std::vector<std::set<int>> all_neighbours = neighbours;
  const auto chain_from = [&](int first) {
    std::vector<int> chain{first};
    for (int at = first; !neighbours[at].empty();) {
      const int next = *neighbours[at].begin();
      neighbours[at].erase(next);
      neighbours[next].erase(at);
      chain.push_back(at = next);
      if (all_neighbours[at].size() != 2) break;
    }
    return chain;
  };
  std::vector<std::vector<int>> chains;
  for (const bool closed : {false, true})
    for (int v = 0; v < static_cast<int>(vertices); ++v)
      while (!neighbours[v].empty() && (closed || all_neighbours[v].size() != 2))
        chains.push_back(chain_from(v));
  return chains;
}

/// A polyline without the points that lie on a straight line or too close to another point.
std::vector<Vector2d> simplified(const std::vector<Vector2d>& points, double side) {
  const auto off_line = [](const Vector2d& p, const Vector2d& a, const Vector2d& b) {
    const Vector2d d = b - a;
    return d.norm() > 0 ? std::abs(cross(d, p - a)) / d.norm() : (p - a).norm();
  };
  std::vector<Vector2d> line{points.front()};
  std::size_t last = 0;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    bool straight = true;
    for (std::size_t k = last + 1; k <= i; ++k)
      straight = straight && off_line(points[k], points[last], points[i + 1]) <= same_place * side;
    if (straight || (points[i] - line.back()).norm() < min_length * side ||
        (points[i] - points.back()).norm() < min_length * side)
      continue;
    line.push_back(points[i]);
    last = i;
  }
  line.push_back(points.back());
  return line;
}

std::vector<Vector2d> on_pattern(const EdgeGraph& graph, const SceneSheet& sheet,
                                 const std::string& place) {
  std::vector<Vector2d> points;
  for (const Vector3d& p : graph.x) {
    const SheetPoint point = nearest_point(sheet.start, p);
    if (point.distance > max_distance)
      throw Error(
          ErrorCode::scene, place,
          fmt::format(
              "The crease is {:.3g} mm off the sheet \"{}\", at ({:.4g}, {:.4g}, {:.4g}) m.",
              1e3 * point.distance, sheet.name, p.x(), p.y(), p.z()),
          "Place its edges within 1 mm of the sheet as it is at the first frame, or name the "
          "sheet in paper_target.");
    const Vector2d border = nearest_border_point(sheet.pattern, point.pattern);
    points.push_back((border - point.pattern).norm() <= same_place * longer_side(sheet.pattern)
                         ? border
                         : point.pattern);
  }
  return points;
}

bool along_border(const Pattern& pattern, const Vector2d& a, const Vector2d& b) {
  const double near = same_place * longer_side(pattern);
  const auto on_it = [&](const Vector2d& p) {
    return (nearest_border_point(pattern, p) - p).norm() <= near;
  };
  return on_it(a) && on_it(b) && on_it(0.5 * (a + b)) && on_it(0.25 * a + 0.75 * b);
}

void check_inside(const PrescribedCrease& crease, const SceneSheet& sheet,
                  const std::string& place) {
  constexpr int samples = 64;  // of each part
  for (std::size_t k = 0; k + 1 < crease.line.size(); ++k)
    for (int i = 0; i <= samples; ++i)
      if (const Vector2d p =
              crease.line[k] + i / double(samples) * (crease.line[k + 1] - crease.line[k]);
          !contains(sheet.pattern, p, same_place * longer_side(sheet.pattern)))
        throw Error(
            ErrorCode::scene, place,
            fmt::format("The crease leaves the sheet \"{}\" at ({:.4g}, {:.4g}) m of its pattern.",
                        sheet.name, p.x(), p.y()),
            "Split the edge at the border of the sheet and delete the part outside.");
}

/// The rest angle of the creases that a node defines. [rad]
/// returns  nothing when each has the angle that it is modelled with
std::optional<double> rest_angle(const SceneNodes& scene, const ImportedNode& node,
                                 const std::string& place) {
  if (text_property(node, "paper_crease") == "modelled") return std::nullopt;
  const double angle =
      number_property(scene.source, node, "paper_crease", "a number or \"modelled\"").value_or(0);
  if (std::abs(angle) > max_angle)
    throw Error(ErrorCode::scene, place, fmt::format("paper_crease is {:g}.", angle),
                "It is the rest angle of the crease: from -170 to 170 degrees, or \"modelled\".");
  return radians_of(angle);
}

/// The angle by which the start shape is folded along a line of its pattern, at most max_angle.
/// [rad]
double modelled_angle(const Sheet& start, const std::vector<Vector2d>& line, double side) {
  const double most = radians_of(max_angle);
  return std::clamp(fold_of_line(start, line, same_place * side), -most, most);
}

/// Adds the creases that a node defines to a sheet; returns their number.
/// x       |V|x3 [m] its vertices
/// kind    of the node, for error messages: "sheet" or "crease"
/// origin  for SceneSheet::crease_origin
std::size_t add_creases_of(const SceneNodes& scene, int node, const Points3& x,
                           const std::string& kind, const std::string& origin, SceneSheet& sheet) {
  const ImportedNode& n = scene.file.nodes[node];
  const std::string place = place_of(scene.source, kind, n.name);
  EdgeGraph graph = edge_graph(scene.file, n, x, place);
  const std::optional<double> angle = rest_angle(scene, n, place);
  const std::vector<Vector2d> points = on_pattern(graph, sheet, place);
  for (auto edge = graph.edges.begin(); edge != graph.edges.end();)
    edge = along_border(sheet.pattern, points[edge->first], points[edge->second])
               ? graph.edges.erase(edge)
               : std::next(edge);
  const double side = longer_side(sheet.pattern);
  std::size_t added = 0;
  for (const std::vector<int>& chain : chains_of(graph.edges, points.size())) {
    std::vector<Vector2d> line;
    for (const int v : chain) line.push_back(points[v]);
    PrescribedCrease crease{simplified(line, side)};
    crease.angle = angle ? *angle : modelled_angle(sheet.start, crease.line, side);
    if (crease.line.size() == 2 && (crease.line[1] - crease.line[0]).norm() < min_length * side)
      continue;
    check_inside(crease, sheet, place);
    sheet.pattern.prescribed_creases.push_back(std::move(crease));
    sheet.crease_origin.push_back(origin);
    ++added;
  }
  return added;
}

bool has_edges(const ImportedFile& file, const ImportedNode& node) {
  return std::any_of(node.meshes.begin(), node.meshes.end(),
                     [&](int m) { return file.meshes[m].creases.rows() > 0; });
}

/// x  |V|x3 [m] the vertices of the node
std::size_t sheet_under(const SceneNodes& scene, int node, const Points3& x,
                        const std::vector<SceneSheet>& sheets) {
  const ImportedNode& n = scene.file.nodes[node];
  const std::string place = place_of(scene.source, "crease", n.name);
  if (const auto target = target_sheet(scene, sheets, node, place)) return *target;
  std::vector<double> off(sheets.size(), 0);
  for (const Vector3d& p : edge_graph(scene.file, n, x, place).x)
    for (std::size_t s = 0; s < sheets.size(); ++s)
      off[s] = std::max(off[s], nearest_point(sheets[s].start, p).distance);
  return std::min_element(off.begin(), off.end()) - off.begin();
}

/// thing  "mesh", or "object": exporters leave out a mesh of which they have no edges
Error no_edges(const std::string& place, const char* thing) {
  return Error(ErrorCode::scene, place,
               fmt::format("The {} has no edges without faces, which would be the crease.", thing),
               "Draw the crease as edges without faces, and export with Loose Edges (Blender) on.");
}

/// Says where a sheet begins folded sharply without a crease.
void warn_of_unmarked_folds(const SceneSheet& sheet, std::vector<std::string>& warnings) {
  constexpr double sharp = 50;  // [degrees] a roll that is drawn with eight faces a turn has 45
  const Sheet& start = sheet.start;
  double most = sharp;
  Vector2d where;
  for (const Hinge& hinge : find_hinges(start.triangles).hinges) {
    const auto [a, b, left, right] = hinge.vertices;
    const double turn = degrees_of(std::abs(dihedral_angle(start.x, hinge)));
    if (turn <= most || is_on_crease(sheet.pattern.prescribed_creases, start.pattern, a, b))
      continue;
    most = turn;
    where = 0.5 * (start.pattern.row(a) + start.pattern.row(b));
  }
  if (most > sharp)
    warnings.push_back(fmt::format(
        "The sheet \"{}\" begins folded by {:.0f} degrees at ({:.1f}, {:.1f}) mm, where no crease "
        "is: it is elastic there, and springs open where nothing holds it. To keep its folds, draw "
        "them as creases with paper_crease \"modelled\".",
        sheet.name, most, 1e3 * where.x(), 1e3 * where.y()));
}

}  // namespace

void add_creases(const SceneNodes& scene, std::vector<SceneSheet>& sheets,
                 std::vector<std::string>& warnings) {
  const auto& nodes = scene.file.nodes;
  const auto world = world_at(scene, scene.first_frame);
  for (int i = 0; i < static_cast<int>(nodes.size()); ++i) {
    const ImportedNode& node = nodes[i];
    if (node.pivot) continue;
    const bool has_angle = node.properties.count("paper_crease") > 0;
    if (node.meshes.empty()) {
      if (has_angle) throw no_edges(place_of(scene.source, "crease", node.name), "object");
      continue;
    }
    const auto sheet = std::find_if(sheets.begin(), sheets.end(),
                                    [&](const SceneSheet& s) { return s.name == node.name; });
    if (sheet != sheets.end()) {
      const std::size_t added =
          has_edges(scene.file, node)
              ? add_creases_of(scene, i, vertices_of(scene, i, world, sheet->deformed), "sheet",
                               "edges marked in the mesh", *sheet)
              : 0;
      if (has_angle && added == 0)
        warnings.push_back(fmt::format(
            "The sheet \"{}\" has paper_crease, but no edge within it is marked as a crease.",
            node.name));
    } else if (!is_collider(scene, i) && (has_angle || name_begins_with(node.name, "crease"))) {
      if (!has_edges(scene.file, node)) {
        if (has_angle) throw no_edges(place_of(scene.source, "crease", node.name), "mesh");
        warnings.push_back(
            fmt::format("The mesh \"{}\" is named like a crease, but has no edges without faces: "
                        "export with Loose Edges (Blender) on.",
                        node.name));
        continue;
      }
      const Points3 x = vertices_of(scene, i, world, is_deformed(scene.file, node));
      SceneSheet& under = sheets[sheet_under(scene, i, x, sheets)];
      if (add_creases_of(scene, i, x, "crease", fmt::format("\"{}\"", node.name), under) == 0)
        warnings.push_back(fmt::format(
            "The crease \"{}\" lies along the border of the sheet \"{}\": it has no effect.",
            node.name, under.name));
    }
  }
  for (const SceneSheet& sheet : sheets) warn_of_unmarked_folds(sheet, warnings);
}

}  // namespace paperbake
