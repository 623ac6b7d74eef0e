#include "formats/files/collider_record.h"

#include "core/geometry/rigid_motion.h"
#include "core/model/error.h"
#include "formats/files/json.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace paperbake {
namespace {

constexpr double motion_exact_to = 1e-7;  // [m], more than scenes are rounded to

Json json_of(const RigidMotion& motion) {
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> turn = motion.turn;
  return {{"turn", std::vector<double>(turn.data(), turn.data() + 9)},
          {"shift", std::vector<double>(motion.shift.data(), motion.shift.data() + 3)}};
}

bool is_rotation(const Eigen::Matrix3d& turn) {
  constexpr double rounding = 1e-9;
  return (turn * turn.transpose() - Eigen::Matrix3d::Identity()).norm() < rounding &&
         turn.determinant() > 0;
}

RigidMotion motion_of(const Json& json) {
  const auto turn = json.at("turn").get<std::array<double, 9>>();
  const auto shift = json.at("shift").get<std::array<double, 3>>();
  const RigidMotion motion{
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(turn.data()),
      Vector3d(shift[0], shift[1], shift[2])};
  if (json.at("turn").size() != 9 || json.at("shift").size() != 3 || !is_rotation(motion.turn))
    throw Error(ErrorCode::scene, "colliders.json", "A frame is turned by what is no rotation.");
  return motion;
}

/// Whether these are places, and not what is left of them in a damaged file.
bool are_places(const Points3& x) {
  constexpr double anywhere = 1e6;  // [m]
  return x.allFinite() && (x.size() == 0 || x.cwiseAbs().maxCoeff() < anywhere);
}

/// The shape of a mesh in one of its frames.
Json frame_json(const ColliderMesh& mesh, const Points3& x) {
  if (const auto motion = rigid_motion_between(mesh.x, x, motion_exact_to)) return json_of(*motion);
  return std::vector<double>(x.data(), x.data() + x.size());
}

Points3 frame_of(const ColliderMesh& mesh, const Json& json) {
  if (json.is_object()) return moved(motion_of(json), mesh.x);
  const std::vector<double> numbers = json.get<std::vector<double>>();
  if (static_cast<long>(numbers.size()) != mesh.x.size())
    throw Error(ErrorCode::scene, "colliders.json", "A frame does not have all vertices.");
  return Eigen::Map<const Points3>(numbers.data(), mesh.x.rows(), 3);
}

Json json_of(const ColliderMesh& mesh) {
  Json vertices = Json::array(), triangles = Json::array(), frames = Json::array();
  for (int v = 0; v < mesh.x.rows(); ++v)
    vertices.push_back({mesh.x(v, 0), mesh.x(v, 1), mesh.x(v, 2)});
  for (int t = 0; t < mesh.triangles.rows(); ++t)
    triangles.push_back({mesh.triangles(t, 0), mesh.triangles(t, 1), mesh.triangles(t, 2)});
  for (const Points3& x : mesh.frames) frames.push_back(frame_json(mesh, x));
  return {{"name", mesh.name},
          {"vertices", std::move(vertices)},
          {"triangles", std::move(triangles)},
          {"frames", std::move(frames)}};
}

template <class Matrix>
Matrix matrix_of(const Json& rows) {
  Matrix m(static_cast<long>(rows.size()), 3);
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (std::size_t k = 0; k < 3; ++k)
      m(static_cast<long>(r), static_cast<long>(k)) = rows[r].at(k).get<typename Matrix::Scalar>();
  return m;
}

ColliderMesh mesh_of(const Json& json) {
  ColliderMesh mesh;
  mesh.name = json.at("name");
  mesh.x = matrix_of<Points3>(json.at("vertices"));
  mesh.triangles = matrix_of<Triangles>(json.at("triangles"));
  for (const Json& frame : json.at("frames")) mesh.frames.own().push_back(frame_of(mesh, frame));
  if (!are_places(mesh.x) || !std::all_of(mesh.frames.begin(), mesh.frames.end(), are_places))
    throw Error(ErrorCode::scene, "colliders.json", "A vertex is nowhere.");
  const bool exist = mesh.triangles.size() == 0 ||
                     (mesh.triangles.minCoeff() >= 0 && mesh.triangles.maxCoeff() < mesh.x.rows());
  if (!exist) throw Error(ErrorCode::scene, "colliders.json", "A collider has no such vertex.");
  return mesh;
}

void turn(Triangles& triangles) { triangles.col(1).swap(triangles.col(2)); }

}  // namespace

std::string collider_json(const ColliderRecord& record) {
  Json all{{"first_frame", record.first_frame}, {"colliders", Json::array()}};
  Json turned = Json::object(), inside_of = Json::object();
  const std::vector<ColliderMesh>* first = nullptr;
  for (const auto& [sheet, meshes] : record.of_sheet) {
    if (!first) {
      first = &meshes;
      for (const ColliderMesh& mesh : meshes) all["colliders"].push_back(json_of(mesh));
    }
    Json numbers = Json::array(), holding = Json::array();
    for (std::size_t c = 0; c < meshes.size(); ++c) {
      if (meshes[c].triangles != (*first)[c].triangles) numbers.push_back(c);
      if (meshes[c].paper_side == ColliderMesh::PaperSide::inside) holding.push_back(c);
    }
    turned[sheet] = std::move(numbers);
    inside_of[sheet] = std::move(holding);
  }
  all["turned"] = std::move(turned);
  all["inside_of"] = std::move(inside_of);
  return json_line(all) + "\n";
}

ColliderRecord parse_collider_json(const std::string& text) try {
  const Json all = parse_json(text);
  ColliderRecord record;
  record.first_frame = all.at("first_frame");
  std::vector<ColliderMesh> meshes;
  for (const Json& collider : all.at("colliders")) meshes.push_back(mesh_of(collider));
  for (const auto& [sheet, numbers] : all.at("turned").items()) {
    std::vector<ColliderMesh>& own = record.of_sheet[sheet] = meshes;
    for (const Json& number : numbers) turn(own.at(number.get<std::size_t>()).triangles);
  }
  for (const auto& [sheet, numbers] : all.at("inside_of").items())
    for (const Json& number : numbers)
      record.of_sheet.at(sheet).at(number.get<std::size_t>()).paper_side =
          ColliderMesh::PaperSide::inside;
  return record;
} catch (const std::exception& problem) {
  throw Error(ErrorCode::scene, "colliders.json",
              std::string("This version of paperbake does not write such a file (") +
                  problem.what() + ").");
}

}  // namespace paperbake
