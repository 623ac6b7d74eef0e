#include "core/animate.h"
#include "formats/scene_file.h"
#include "tests/validation/cases.h"

#include <Eigen/Eigenvalues>

#include <algorithm>

namespace paperbake::validation {
namespace {

/// Extents along the principal axes of the sheet's area, the longest first.
Vector3d principal_box(const Sheet& sheet) {
  Vector3d centre(0, 0, 0);
  double area = 0;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const bool second : {false, true})
    for (int t = 0; t < sheet.triangles.rows(); ++t) {
      const Vector3d a = sheet.x.row(sheet.triangles(t, 0)), b = sheet.x.row(sheet.triangles(t, 1)), c = sheet.x.row(sheet.triangles(t, 2));
      const double w = 0.5 * (b - a).cross(c - a).norm();
      const Vector3d m = (a + b + c) / 3;
      if (second) scatter += w * (m - centre / area) * (m - centre / area).transpose();
      else centre += w * m, area += w;
    }
  const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors();
  const Points3 along = sheet.x * axes;
  Vector3d size = (along.colwise().maxCoeff() - along.colwise().minCoeff()).transpose();
  std::sort(size.data(), size.data() + 3, std::greater<>());
  return size;
}

void judge(Rows& rows, const std::string& name, const Method& method, const Shot& shot, Memory memory, bool judged) {
  AnimateOptions options;
  options.memory = memory;
  options.last_frame = 84;  // closed at 72, then at rest
  Sheet sheet;
  double bending = 0, membrane = 0;
  animate(shot, method, options, [&](const AnimatedFrame& frame) {
    sheet = *frame.sheet;
    membrane = frame.membrane_energy;
    bending = frame.energy - frame.membrane_energy;
    return true;
  });
  const double L = 0.3, W = 0.03, ring = shot.paper.bending_stiffness * 0.5 * W * 2 * M_PI * 2 * M_PI / L;  // [J] untwisted
  const Vector3d box = principal_box(sheet) / L;
  const char* const source = "V6: rulings exact, hinged joint";
  const double tolerance = judged ? 0.03 : 0;
  rows.push_back({name, "energy / that of the ring", 3.102, (bending + membrane) / ring, tolerance, source, ""});
  const double expected[] = {0.368, 0.210, 0.087};
  for (int i = 0; i < 3; ++i) rows.push_back({name, "box / L, axis " + std::to_string(i + 1), expected[i], box[i], tolerance, source, ""});
  rows.push_back({name, "membrane share of the energy", 0, membrane / (bending + membrane), 0, "", ""});
}

}  // namespace

Rows moebius() {
  const Scene scene = read_scene(PAPERBAKE_SAMPLES "/S2_moebius.glb");
  const SceneSheet& s = scene.sheets.front();
  const Shot shot{s.name, s.pattern, s.start, s.handles, Paper{}};
  Rows rows;
  for (const int triangles : {1700, 3400}) judge(rows, "fem " + std::to_string(triangles), fem(triangles), shot, Memory::none, true);
  for (const int base : {120, 200}) judge(rows, "hybrid " + std::to_string(base), hybrid(shot.pattern, shot.paper, base, {}, 0, 0), shot, Memory::none, true);
  return rows;
}

}  // namespace paperbake::validation
