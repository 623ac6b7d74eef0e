#include "formats/scene/scene_deformation.h"

#include <algorithm>

namespace paperbake {
namespace {

Points3 moved_by(const Eigen::Affine3d& t, const Points3& x) {
  return (x * t.linear().transpose()).rowwise() + t.translation().transpose();
}

/// |V|x3 in the space of the mesh, moved by its blend shapes.
Points3 blended(const ImportedMesh& mesh, const std::vector<Track<Vector3d>>& weights, int frame) {
  Points3 x = mesh.x;
  for (std::size_t k = 0; k < mesh.targets.size(); ++k) {
    const Vector3d rest(mesh.target_weights[k], 0, 0);
    x += (k < weights.size() ? value_at(weights[k], frame, rest) : rest).x() * mesh.targets[k];
  }
  return x;
}

/// |V|x3 [m] moved by the bones; a vertex without bones follows the node.
Points3 skinned(const Skin& skin, const Points3& x, const std::vector<Eigen::Affine3d>& world,
                int node) {
  std::vector<Eigen::Affine3d> places;
  for (std::size_t b = 0; b < skin.bones.size(); ++b)
    places.push_back(world[skin.bones[b]] * skin.to_bone[b]);
  Points3 sum = Points3::Zero(x.rows(), 3);
  Eigen::VectorXd weight = Eigen::VectorXd::Zero(x.rows());
  for (Eigen::Index i = 0; i < skin.influences.rows(); ++i) {
    const int v = skin.influences(i, 0);
    const Vector3d p = x.row(v);
    sum.row(v) += skin.weights[i] * (places[skin.influences(i, 1)] * p).transpose();
    weight[v] += skin.weights[i];
  }
  for (Eigen::Index v = 0; v < x.rows(); ++v)
    if (weight[v] > 0)
      sum.row(v) /= weight[v];
    else
      sum.row(v) = (world[node] * Vector3d(x.row(v))).transpose();
  return sum;
}

}  // namespace

bool is_deformed(const ImportedFile& file, const ImportedNode& node) {
  return std::any_of(node.meshes.begin(), node.meshes.end(),
                     [&](int m) { return file.meshes[m].deformed; });
}

std::string not_followed(const ImportedFile& file, const ImportedNode& node) {
  for (const int m : node.meshes)
    if (!file.meshes[m].not_followed.empty()) return file.meshes[m].not_followed;
  return "";
}

Points3 vertices_at(const SceneNodes& scene, int node, const std::vector<Eigen::Affine3d>& world,
                    int frame) {
  Points3 all(0, 3);
  for (const int m : scene.file.nodes[node].meshes) {
    const ImportedMesh& mesh = scene.file.meshes[m];
    const Points3 x = blended(mesh, scene.shapes[node], frame);
    const Points3 placed =
        mesh.skin.bones.empty() ? moved_by(world[node], x) : skinned(mesh.skin, x, world, node);
    all.conservativeResize(all.rows() + placed.rows(), 3);
    all.bottomRows(placed.rows()) = placed;
  }
  return all;
}

}  // namespace paperbake
