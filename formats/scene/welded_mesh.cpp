#include "formats/scene/welded_mesh.h"

#include "core/geometry/mesh_edges.h"
#include "core/model/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace paperbake {
namespace {

constexpr double weld_distance = 1e-6;  // of the size
constexpr double weld_uv = 1e-4;        // in uv

double size_of(const Points3& x) {
  return (x.colwise().maxCoeff() - x.colwise().minCoeff()).norm();
}

struct EdgeTopology {
  bool has_border = false;  // there are edges of one triangle
  int overfull = 0;         // edges of three or more triangles
  int inconsistent = 0;     // edges whose two triangles have opposite orientations
  int pieces = 0;           // connected components
};

EdgeTopology edge_topology(const Triangles& triangles) {
  EdgeTopology edges;
  std::vector<int> piece(triangles.rows());
  std::iota(piece.begin(), piece.end(), 0);
  const auto root = [&](int t) {
    while (piece[t] != t) t = piece[t] = piece[piece[t]];
    return t;
  };
  edges.pieces = static_cast<int>(triangles.rows());
  for (const MeshEdge& edge : MeshEdges(triangles)) {
    const auto forwards = std::count_if(edge.begin(), edge.end(),
                                        [](const TriangleSide& side) { return side.forwards; });
    const auto sides = static_cast<long>(edge.size());
    edges.has_border |= sides == 1;
    edges.overfull += sides > 2;
    edges.inconsistent += (forwards >= 2) + (sides - forwards >= 2);
    for (const TriangleSide& side : edge)
      if (root(side.triangle) != root(edge[0].triangle)) {
        piece[root(side.triangle)] = root(edge[0].triangle);
        --edges.pieces;
      }
  }
  return edges;
}

}  // namespace

WeldedMesh combined_mesh(const ImportedFile& file, int node, const Eigen::Affine3d& world) {
  int vertices = 0, triangles = 0;
  bool all_have_uv = true;
  for (int m : file.nodes[node].meshes) {
    vertices += static_cast<int>(file.meshes[m].x.rows());
    triangles += static_cast<int>(file.meshes[m].triangles.rows());
    all_have_uv = all_have_uv && has_uv(file.meshes[m].attributes);
  }
  WeldedMesh all{Points3(vertices, 3), Points2(all_have_uv ? vertices : 0, 2),
                 Triangles(triangles, 3)};
  int v = 0, t = 0;
  for (int m : file.nodes[node].meshes) {
    const ImportedMesh& mesh = file.meshes[m];
    const int n = static_cast<int>(mesh.x.rows());
    all.x.middleRows(v, n) =
        (mesh.x * world.linear().transpose()).rowwise() + world.translation().transpose();
    if (all_have_uv) all.uv.middleRows(v, n) = mesh.attributes.front().values;
    all.triangles.middleRows(t, mesh.triangles.rows()) = mesh.triangles.array() + v;
    v += n;
    t += static_cast<int>(mesh.triangles.rows());
  }
  // a reflection reverses the winding; swapping corners keeps the front where the artist sees it
  if (world.linear().determinant() < 0) all.triangles.col(1).swap(all.triangles.col(2));
  return all;
}

WeldedMesh weld(const WeldedMesh& mesh, bool keep_uv) {
  const double near = weld_distance * size_of(mesh.x);
  std::vector<int> used(mesh.triangles.data(), mesh.triangles.data() + mesh.triangles.size());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  int along = 0;  // the longest side: few vertices have the same place on it
  (mesh.x.colwise().maxCoeff() - mesh.x.colwise().minCoeff()).maxCoeff(&along);
  std::vector<int> in_order = used;
  std::stable_sort(in_order.begin(), in_order.end(),
                   [&](int a, int b) { return mesh.x(a, along) < mesh.x(b, along); });
  std::vector<int> same(mesh.x.rows());
  std::iota(same.begin(), same.end(), 0);
  const auto root = [&](int v) {
    while (same[v] != v) v = same[v];
    return v;
  };
  for (std::size_t i = 0; i < in_order.size(); ++i)
    for (std::size_t j = i;
         j-- > 0 && mesh.x(in_order[i], along) - mesh.x(in_order[j], along) <= near;) {
      if ((mesh.x.row(in_order[i]) - mesh.x.row(in_order[j])).norm() > near) continue;
      if (keep_uv && (mesh.uv.row(in_order[i]) - mesh.uv.row(in_order[j])).norm() > weld_uv)
        continue;
      const int a = root(in_order[i]), b = root(in_order[j]);
      same[std::max(a, b)] = std::min(a, b);
    }
  std::vector<int> kept, number(mesh.x.rows(), -1);
  for (int v : used)
    if (root(v) == v) {
      number[v] = static_cast<int>(kept.size());
      kept.push_back(v);
    }
  WeldedMesh welded{mesh.x(kept, Eigen::all), Points2(), mesh.triangles, kept};
  if (keep_uv) welded.uv = mesh.uv(kept, Eigen::all);
  for (int i = 0; i < welded.triangles.size(); ++i)
    welded.triangles.data()[i] = number[root(welded.triangles.data()[i])];
  return welded;
}

WeldedMesh welded_mesh(const ImportedFile& file, int node, const Eigen::Affine3d& world,
                       const Points3& x) {
  WeldedMesh all = combined_mesh(file, node, world);
  all.x = x;
  return weld(all, false);
}

int triangles_without_area(const WeldedMesh& mesh) {
  int count = 0;
  for (int t = 0; t < mesh.triangles.rows(); ++t) {
    const auto corner = [&](int k) { return Vector3d(mesh.x.row(mesh.triangles(t, k))); };
    const Vector3d a = corner(1) - corner(0), b = corner(2) - corner(0);
    const double longest2 = std::max({a.squaredNorm(), b.squaredNorm(), (a - b).squaredNorm()});
    count += a.cross(b).norm() <= 1e-6 * longest2;  // height below a millionth of the longest side
  }
  return count;
}

bool is_one_layer(const WeldedMesh& mesh) {
  const EdgeTopology edges = edge_topology(mesh.triangles);
  return edges.overfull == 0 && edges.inconsistent == 0 && edges.pieces == 1;
}

void check_mesh(const WeldedMesh& mesh, const std::string& place) {
  const auto reject = [&](const std::string& cause, const char* remedy) {
    throw Error(ErrorCode::scene, place, cause, remedy);
  };
  const int flat = triangles_without_area(mesh);
  if (flat > 0)
    reject(fmt::format("{} of the {} triangles of the mesh have no area.", flat,
                       mesh.triangles.rows()),
           "Merge doubled vertices and dissolve degenerate faces in the DCC.");
  const EdgeTopology edges = edge_topology(mesh.triangles);
  if (edges.overfull > 0)
    reject(fmt::format("Three or more faces meet at {} of the mesh's edges.", edges.overfull),
           "A sheet is one layer of paper: remove the extra faces.");
  if (edges.pieces > 1)
    reject(fmt::format("The mesh is made of {} pieces.", edges.pieces),
           "Make each sheet an object of its own, or merge the vertices where the pieces meet.");
  if (edges.inconsistent > 0)
    reject(fmt::format("The faces at {} of the mesh's edges disagree about the front.",
                       edges.inconsistent),
           "Recalculate the normals in the DCC; a sheet has two sides.");
  if (!edges.has_border)
    reject("The mesh is closed: a sheet of paper has a border.",
           "Remove its thickness (Solidify, Shell), or cut it open along edges.");
}

}  // namespace paperbake
