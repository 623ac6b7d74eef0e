#include "formats/scene/joined_cuts.h"

#include "core/geometry/measure.h"
#include "core/geometry/mesh_edges.h"

#include <algorithm>
#include <vector>

namespace paperbake {
namespace {

bool is_flat(const WeldedMesh& mesh) {
  constexpr double off = 1e-3;  // [1] of a normal: no exporter splits vertices for that
  const auto normal = [&](int t) {
    const Vector3d a = mesh.x.row(mesh.triangles(t, 0)), b = mesh.x.row(mesh.triangles(t, 1)),
                   c = mesh.x.row(mesh.triangles(t, 2));
    return triangle_normal(a, b, c);
  };
  for (int t = 1; t < mesh.triangles.rows(); ++t)
    if ((normal(t) - normal(0)).norm() > off) return false;
  return true;
}

/// The vertices of all meshes of a node, one mesh after the other.
class VerticesOfNode {
 public:
  VerticesOfNode(const ImportedFile& file, int node) {
    for (const int m : file.nodes[node].meshes)
      for (int v = 0; v < file.meshes[m].x.rows(); ++v) places_.push_back({&file.meshes[m], v});
  }

  /// Whether the file does not tell two vertices in one place apart. Those of a mesh with blend
  /// shapes may differ in the normals of these.
  bool are_alike(int a, int b) const {
    const auto [mesh, row] = places_[a];
    const auto [other_mesh, other_row] = places_[b];
    if (mesh != other_mesh || mesh->deformed) return false;
    return std::all_of(mesh->attributes.begin(), mesh->attributes.end(),
                       [row = row, other = other_row](const AuthoredAttribute& attribute) {
                         return attribute.values.row(row) == attribute.values.row(other);
                       });
  }

 private:
  struct Place {
    const ImportedMesh* mesh;
    int row;
  };
  std::vector<Place> places_;
};

}  // namespace

int joined_cuts(const ImportedFile& file, int node, const WeldedMesh& all,
                const WeldedMesh& welded) {
  if (!is_flat(welded)) return 0;
  const VerticesOfNode vertices(file, node);
  int inner = 0, joined = 0;
  for (const MeshEdge& edge : MeshEdges(welded.triangles)) {
    if (edge.size() != 2) continue;
    ++inner;
    const int s = edge[0].triangle, t = edge[1].triangle;
    bool is_joined = false;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const int w = welded.triangles(s, i), a = all.triangles(s, i), b = all.triangles(t, j);
        if (w == welded.triangles(t, j) && a != b) is_joined |= vertices.are_alike(a, b);
      }
    joined += is_joined;
  }
  return 2 * joined > inner ? 0 : joined;
}

}  // namespace paperbake
