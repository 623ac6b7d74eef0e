#include "formats/scene/flat_sheet.h"

#include "core/geometry/measure.h"
#include "core/geometry/mesh_edges.h"
#include "core/model/error.h"
#include "core/model/segment2.h"
#include "formats/scene/joined_cuts.h"
#include "formats/scene/open_slits.h"
#include "formats/scene/scene_unroll.h"
#include "formats/scene/welded_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace paperbake {
namespace {

using Loop = std::vector<int>;

// of the size: a border vertex nearer than this to a straight line is not a corner
constexpr double straightness = 1e-6;

/// The attribute of another mesh of the same node that belongs to attribute n of the first one: the
/// uv set of the same number, or what has the same name, kind and width. Null: there is none.
const AuthoredAttribute* counterpart(const AuthoredAttribute& of, std::size_t n,
                                     const ImportedMesh& mesh) {
  const std::vector<AuthoredAttribute>& all = mesh.attributes;
  if (of.kind == AttributeKind::uv)
    return n < all.size() && all[n].kind == of.kind ? &all[n] : nullptr;
  const auto found = std::find_if(all.begin(), all.end(), [&](const AuthoredAttribute& other) {
    return other.name == of.name && other.kind == of.kind &&
           other.values.cols() == of.values.cols();
  });
  return found == all.end() ? nullptr : &*found;
}

/// Attribute n of the first mesh of the node that has faces, at the corners of combined_mesh.
/// Nothing: another one that has faces does not have it.
std::optional<AuthoredAttribute> on_corners(const ImportedFile& file, int node,
                                            const AuthoredAttribute& first, std::size_t n,
                                            const WeldedMesh& all) {
  AttributeValues of_vertices = AttributeValues::Zero(all.x.rows(), first.values.cols());
  Eigen::Index v = 0;
  for (const int m : file.nodes[node].meshes) {
    const ImportedMesh& mesh = file.meshes[m];
    const AuthoredAttribute* part = counterpart(first, n, mesh);
    if (!part && mesh.triangles.rows() > 0) return {};
    if (part) of_vertices.middleRows(v, mesh.x.rows()) = part->values;
    v += mesh.x.rows();
  }
  AuthoredAttribute found{first.name, first.kind, {}};
  found.values.resize(all.triangles.size(), first.values.cols());
  for (Eigen::Index t = 0; t < all.triangles.rows(); ++t)
    for (int k = 0; k < 3; ++k) found.values.row(3 * t + k) = of_vertices.row(all.triangles(t, k));
  return found;
}

/// The attributes that all meshes of the node with faces have, and the materials, of the triangles
/// of combined_mesh.
AuthoredSurface authored_on(const ImportedFile& file, int node, const WeldedMesh& all) {
  const std::vector<int>& meshes = file.nodes[node].meshes;
  AuthoredSurface authored;
  const auto first = std::find_if(meshes.begin(), meshes.end(),
                                  [&](const int m) { return file.meshes[m].triangles.rows() > 0; });
  for (std::size_t n = 0; first != meshes.end() && n < file.meshes[*first].attributes.size(); ++n)
    if (auto found = on_corners(file, node, file.meshes[*first].attributes[n], n, all))
      authored.attributes.push_back(std::move(*found));
  const auto number_of = [&](const std::string& name) {
    const auto known = std::find(authored.materials.begin(), authored.materials.end(), name);
    if (known == authored.materials.end()) authored.materials.push_back(name);
    return static_cast<int>(std::find(authored.materials.begin(), authored.materials.end(), name) -
                            authored.materials.begin());
  };
  for (const int m : meshes) {
    const ImportedMesh& mesh = file.meshes[m];
    for (Eigen::Index t = 0; t < mesh.triangles.rows(); ++t) {
      const int material = mesh.material_of.empty() ? -1 : mesh.material_of[t];
      const bool named = material >= 0 && !mesh.materials[material].empty();
      authored.material_of.push_back(named ? number_of(mesh.materials[material]) : -1);
    }
  }
  if (authored.materials.empty()) authored.material_of.clear();
  return authored;
}

/// The loops of the border, with the paper on their left: outlines counter-clockwise, holes
/// clockwise.
std::vector<Loop> border_loops(const Triangles& triangles, const std::string& place) {
  std::map<int, int> next;
  for (const auto& [from, to] : border_of(MeshEdges(triangles)))
    if (!next.emplace(from, to).second)
      throw Error(ErrorCode::scene, place, "The border of the mesh touches itself at a vertex.",
                  "Split that vertex, or join the faces there by an edge.");
  std::vector<Loop> loops;
  while (!next.empty()) {
    loops.emplace_back();
    for (auto at = next.begin(); at != next.end();) {
      loops.back().push_back(at->first);
      const int to = at->second;
      next.erase(at);
      at = next.find(to);
    }
  }
  return loops;
}

double distance_to_line(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
  const Vector2d ab = b - a;
  return std::abs(cross(ab, p - a)) / ab.norm();
}

/// The corners of a loop, beginning with the lowest of its leftmost vertices, which must be one.
std::vector<Vector2d> corners_of(const Loop& loop, const Points2& flat, double size) {
  std::vector<Vector2d> points;
  for (int v : loop) points.push_back(flat.row(v));
  const auto rounded = [&](double x) { return std::round(x / (straightness * size)); };
  std::rotate(points.begin(),
              std::min_element(points.begin(), points.end(),
                               [&](const Vector2d& a, const Vector2d& b) {
                                 return std::pair(rounded(a.x()), a.y()) <
                                        std::pair(rounded(b.x()), b.y());
                               }),
              points.end());
  std::vector<Vector2d> corners = {points.front()};
  std::size_t last = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vector2d& next = points[(i + 1) % points.size()];
    bool on_line = true;
    for (std::size_t k = last + 1; k <= i; ++k)
      on_line = on_line && distance_to_line(points[k], points[last], next) <= straightness * size;
    if (on_line) continue;
    last = i;
    corners.push_back(points[i]);
  }
  return corners;
}

double signed_area(const std::vector<Vector2d>& loop) { return area(Pattern{loop, {}}); }

/// Whether two edges cross, and do not merely touch or lie in one line.
bool cross_each_other(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  const double rounding = 1e-7 * std::max((b - a).norm(), (d - c).norm());
  // 1, -1 or 0: on which side of the line p-q the point r is
  const auto side = [&](const Vector2d& p, const Vector2d& q, const Vector2d& r) {
    const double off = cross(q - p, r - p) / (q - p).norm();
    return off > rounding ? 1 : off < -rounding ? -1 : 0;
  };
  return side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0;
}

bool overlaps_itself(const Pattern& pattern) {
  std::vector<std::pair<Vector2d, Vector2d>> edges;
  const auto add = [&](const std::vector<Vector2d>& loop) {
    for (std::size_t i = 0; i < loop.size(); ++i)
      edges.emplace_back(loop[i], loop[(i + 1) % loop.size()]);
  };
  add(pattern.outline);
  for (const auto& hole : pattern.holes) add(hole);
  for (std::size_t i = 0; i < edges.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (cross_each_other(edges[i].first, edges[i].second, edges[j].first, edges[j].second))
        return true;
  return false;
}

/// Rotates an unrolled sheet, whose direction is arbitrary, so that its longest straight border,
/// the first of equals, runs along x.
void lay_along_longest_side(Points2& flat, const Pattern& pattern) {
  Vector2d longest = Vector2d::UnitX();
  double length = 0;
  for (std::size_t i = 0; i < pattern.outline.size(); ++i) {
    const Vector2d side = pattern.outline[(i + 1) % pattern.outline.size()] - pattern.outline[i];
    if (side.norm() > 1.001 * length) {
      length = side.norm();
      longest = side.normalized();
    }
  }
  Eigen::Matrix2d rotation;
  rotation << longest.x(), longest.y(), -longest.y(), longest.x();
  flat = (flat * rotation.transpose()).eval();
}

/// Rotates a sheet by quarter turns to agree best with the directions of its UVs, whatever their
/// proportions.
/// all  the same triangles with their uv
void turn_as_uv(Points2& flat, const Triangles& triangles, const WeldedMesh& all) {
  // agreement of the uv with the flat shape as it is, and rotated by 90 degrees
  double same = 0, quarter = 0, area = 0;
  for (const int mirrored : {1, -1}) {
    same = quarter = area = 0;
    for (int t = 0; t < triangles.rows(); ++t) {
      const auto edge = [&](const Points2& p, const Triangles& of, int k) {
        return Vector2d(p.row(of(t, (k + 1) % 3)) - p.row(of(t, k)));
      };
      const auto uv = [&](int k) {
        return Vector2d(edge(all.uv, all.triangles, k).cwiseProduct(Vector2d(mirrored, 1)));
      };
      area += cross(uv(0), uv(1));
      for (int k = 0; k < 3; ++k) {
        const Vector2d a = uv(k), b = edge(flat, triangles, k);
        same += a.dot(b);
        quarter += a.y() * b.x() - a.x() * b.y();
      }
    }
    if (area >= 0) break;
  }
  Eigen::Matrix2d turn;
  if (std::abs(same) >= std::abs(quarter))
    turn = (same < 0 ? -1 : 1) * Eigen::Matrix2d::Identity();
  else
    turn << 0, quarter < 0 ? 1 : -1, quarter < 0 ? -1 : 1, 0;
  flat = (flat * turn.transpose()).eval();
}

}  // namespace

Pattern pattern_of(const Points2& flat, const Triangles& triangles, const std::string& place) {
  const double size = longer_side(flat);
  Pattern pattern;
  for (const Loop& loop : border_loops(triangles, place)) {
    std::vector<Vector2d> corners = corners_of(loop, flat, size);
    if (signed_area(corners) <= 0) {
      pattern.holes.push_back(std::move(corners));
    } else {
      if (!pattern.outline.empty())
        throw Error(ErrorCode::scene, place, "The sheet overlaps itself when it is laid flat.",
                    "Cut it into sheets that can be laid flat.");
      pattern.outline = std::move(corners);
    }
  }
  if (pattern.outline.empty() || overlaps_itself(pattern))
    throw Error(ErrorCode::scene, place, "The sheet overlaps itself when it is laid flat.",
                "Cut it into sheets that can be laid flat.");
  return pattern;
}

FlatSheet flat_sheet(const ImportedFile& file, int node, const Eigen::Affine3d& world,
                     const Points3& x, const std::string& place) {
  WeldedMesh all = combined_mesh(file, node, world);
  all.x = x;
  if (all.triangles.rows() == 0)
    throw Error(ErrorCode::scene, place, "The mesh has no faces.",
                "Export the sheet as a mesh with faces.");
  WeldedMesh mesh = weld(all, all.uv.rows() > 0);
  std::optional<Points2> flat;
  if (triangles_without_area(mesh) == 0 && is_one_layer(mesh)) flat = pattern_from_uv(mesh);
  const bool from_uv = flat.has_value();
  if (!flat) {
    mesh = weld(all, false);
    check_mesh(mesh, place);
    flat = unrolled(mesh, place);
  }
  open_slits(*flat, mesh.triangles);
  if (!from_uv) {
    lay_along_longest_side(*flat, pattern_of(*flat, mesh.triangles, place));
    if (all.uv.rows() > 0) turn_as_uv(*flat, mesh.triangles, all);
  }
  // the bounding box starts at (0, 0)
  flat->rowwise() -= flat->colwise().minCoeff().eval();
  FlatSheet sheet;
  sheet.pattern = pattern_of(*flat, mesh.triangles, place);
  sheet.start.pattern = *flat;
  sheet.start.x = mesh.x;
  sheet.start.v = Points3::Zero(mesh.x.rows(), 3);
  sheet.start.triangles = mesh.triangles;
  sheet.kept = std::move(mesh.kept);
  sheet.from_uv = from_uv;
  sheet.joined_cuts = joined_cuts(file, node, all, mesh);
  sheet.authored = authored_on(file, node, all);  // welding keeps the triangles and their order
  sheet.authored.pattern = sheet.start.pattern;
  sheet.authored.triangles = sheet.start.triangles;
  return sheet;
}

}  // namespace paperbake
