#include "formats/scene/scene_colliders.h"

#include "formats/scene/scene_properties.h"
#include "formats/scene/scene_sheet.h"

#include <Eigen/SVD>
#include <fmt/format.h>

#include <algorithm>

namespace paperbake {
namespace {

/// The triangles that have an area.
Triangles with_area(const WeldedMesh& mesh) {
  std::vector<int> kept;
  for (int t = 0; t < mesh.triangles.rows(); ++t) {
    const Vector3d a = mesh.x.row(mesh.triangles(t, 0)), b = mesh.x.row(mesh.triangles(t, 1)),
                   c = mesh.x.row(mesh.triangles(t, 2));
    const double longest2 =
        std::max({(b - a).squaredNorm(), (c - a).squaredNorm(), (c - b).squaredNorm()});
    if ((b - a).cross(c - a).norm() > 1e-9 * longest2) kept.push_back(t);
  }
  return mesh.triangles(kept, Eigen::all);
}

/// The rigid part of a motion. stretched [1] is raised to the largest relative change of length of
/// the motion, if that is larger.
Eigen::Isometry3d rigid(const Eigen::Affine3d& motion, double& stretched) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(motion.linear(),
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = svd.matrixU() * svd.matrixV().transpose();
  // a reflection has no rigid part
  if (pose.linear().determinant() < 0) {
    pose.linear() = Eigen::Matrix3d::Identity();
    stretched = 1;
  }
  pose.translation() = motion.translation();
  stretched = std::max(stretched, (svd.singularValues().array() - 1).abs().maxCoeff());
  return pose;
}

}  // namespace

bool is_collider(const ImportedNode& node) {
  return !node.meshes.empty() && !name_begins_with(node.name, "paper") &&
         (flag_property(node, "paper_collider") || name_begins_with(node.name, "collider"));
}

std::vector<ColliderMesh> read_colliders(const SceneNodes& scene,
                                         std::vector<std::string>& warnings) {
  constexpr double unmoved = 1e-9;    // [m], and [1] for the entries of a rotation
  constexpr double same_size = 1e-3;  // [1]
  const auto& nodes = scene.file.nodes;
  std::vector<int> found;
  std::vector<Eigen::Affine3d> from_first_frame;
  std::vector<ColliderMesh> colliders;
  const auto first = world_at(scene, scene.first_frame);
  for (int i = 0; i < static_cast<int>(nodes.size()); ++i) {
    if (!is_collider(nodes[i])) continue;
    const WeldedMesh mesh = welded_mesh(scene.file, i, first[i]);
    ColliderMesh collider{nodes[i].name, mesh.x, with_area(mesh), {}};
    collider.friction =
        nonnegative_property(scene.source, nodes[i], "paper_friction").value_or(collider.friction);
    if (collider.triangles.rows() == 0 || std::abs(first[i].linear().determinant()) < 1e-300) {
      warnings.push_back(
          fmt::format("The collider \"{}\" has no faces: it is ignored.", collider.name));
      continue;
    }
    for (const int m : nodes[i].meshes)
      if (scene.file.meshes[m].deformed) {
        warnings.push_back(fmt::format(
            "Bones and blend shapes of the collider \"{}\" are not followed: it is rigid.",
            collider.name));
        break;
      }
    found.push_back(i);
    from_first_frame.push_back(first[i].inverse());
    colliders.push_back(std::move(collider));
  }
  std::vector<double> stretched(found.size(), 0);
  for (int frame = scene.first_frame; frame <= scene.last_frame && !found.empty(); ++frame) {
    const auto world = world_at(scene, frame);
    for (std::size_t c = 0; c < found.size(); ++c)
      colliders[c].motion.push_back(rigid(world[found[c]] * from_first_frame[c], stretched[c]));
  }
  for (std::size_t c = 0; c < found.size(); ++c) {
    auto& motion = colliders[c].motion;
    if (stretched[c] > same_size)
      warnings.push_back(
          fmt::format("The size of the collider \"{}\" is keyed: it keeps that of the first frame.",
                      colliders[c].name));
    if (std::all_of(motion.begin(), motion.end(), [&](const Eigen::Isometry3d& m) {
          return (m.matrix() - Eigen::Matrix4d::Identity()).cwiseAbs().maxCoeff() < unmoved;
        }))
      motion.clear();
  }
  return colliders;
}

}  // namespace paperbake
