#include "core/animation/animate.h"
#include "core/geometry/point_location.h"
#include "core/methods/adaptive.h"
#include "core/methods/fem.h"
#include "core/methods/hybrid.h"
#include "formats/scene/scene_file.h"
#include "tests/core/test_shots.h"
#include "tests/validation/cases.h"

#include <Eigen/Eigenvalues>

#include <algorithm>

namespace paperbake::validation {
namespace {

constexpr double L = 0.3, W = 0.03;  // [m]

/// Extents of the centre line along its principal axes, the longest first. [m]
Vector3d principal_box(const Sheet& sheet) {
  constexpr int n = 600;
  const PointLocator locator(sheet.pattern, sheet.triangles);
  Points3 line(n + 1, 3);
  for (int i = 0; i <= n; ++i)
    line.row(i) = interpolate(locator.locate({L * i / n, 0.5 * W}), sheet.triangles, sheet.x);
  const Points3 about = line.rowwise() - line.colwise().mean();
  const Eigen::Matrix3d axes =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(about.transpose() * about).eigenvectors();
  const Points3 along = about * axes;
  Vector3d size = (along.colwise().maxCoeff() - along.colwise().minCoeff()).transpose();
  std::sort(size.data(), size.data() + 3, std::greater<>());
  return size;
}

/// The strip with both ends clamped. In frames 1-60 the far end is brought around a circle to the
/// near one and turned by half a turn about its tangent. Once it is closed, the two clamps are one
/// flat piece of the strip, at a place where a Moebius strip is straight.
Shot closing_strip(double clamp) {
  constexpr int frames = 60;
  Shot shot = test::blank_shot(test::rectangle(L, W));
  for (const double u : {0.0, clamp, L - clamp, L})
    for (const double v : {0.0, W / 6, W / 3, W / 2, 2 * W / 3, 5 * W / 6, W}) {
      Handle handle = test::bare_handle("clamp", {u, v}, frames);
      for (int f = 0; u > 0.5 * L && f < frames; ++f) {
        const double way = f / (frames - 1.0), turn = std::max(1e-9, 2 * M_PI * way),
                     twist = M_PI * way;
        const Vector3d end(L * std::sin(turn) / turn, 0.5 * W, L * (1 - std::cos(turn)) / turn),
            tangent(std::cos(turn), 0, std::sin(turn));
        const Vector3d across = Eigen::AngleAxisd(twist, tangent) * Vector3d::UnitY();
        handle.keyed.row(f) = end + (u - L) * tangent + (v - 0.5 * W) * across;
      }
      shot.handles.push_back(handle);
    }
  return shot;
}

/// After the last frame of its handles the shot continues at rest.
void judge(Rows& rows, const std::string& name, const MethodChoice& method, const Shot& shot,
           const char* source, const Vector3d& expected_box, double expected_energy,
           int last_frame) {
  AnimateOptions options;
  options.elastic.contact = SelfContact::off;  // the seam lies on itself
  options.last_frame = last_frame;
  options.elastic.stop = 1e-6;
  Sheet sheet;
  AnimatedFrame last;
  animate(shot, method, options, [&](const AnimatedFrame& frame) {
    sheet = *frame.sheet;
    last = frame;
    return true;
  });
  // [J] of the untwisted ring
  const double ring = shot.paper.bending_stiffness * 0.5 * W * 2 * M_PI * 2 * M_PI / L;
  const Vector3d box = principal_box(sheet) / L;
  const double tolerance = expected_energy > 0 ? 0.03 : 0;
  rows.push_back({name, "energy / that of the ring", expected_energy, last.statistics.energy / ring,
                  tolerance, source, ""});
  for (int i = 0; i < 3; ++i)
    rows.push_back({name, "centre line box / L, axis " + std::to_string(i + 1), expected_box[i],
                    box[i], tolerance, source, ""});
  rows.push_back({name, "membrane share of the energy", 0,
                  last.statistics.membrane_energy / last.statistics.energy, 0, "", ""});
}

}  // namespace

Rows moebius() {
  Rows rows;
  const Vector3d closed(0.3710, 0.2015, 0.0882);
  const Shot shot = closing_strip(0.002);
  const char* const rulings = "V6: closed, exact rulings";
  for (const int triangles : {1700, 3400})
    judge(rows, "fem " + std::to_string(triangles), fem(triangles), shot, rulings, closed, 3.105,
          160);
  for (const int base : {120, 200})
    judge(rows, "hybrid " + std::to_string(base), hybrid(shot.pattern, shot.paper, base, {}, 0, 0),
          shot, rulings, closed, 3.105, 160);
  judge(rows, "adaptive 3000", adaptive(shot.pattern, 3000), shot, rulings, closed, 3.105, 160);

  // The sample scene holds only the end edges. The strip is free to kink there and finds a state
  // far below the closed one.
  const Scene scene = read_scene(PAPERBAKE_SAMPLES "/S2_moebius.glb");
  const SceneSheet& s = scene.sheets.front();
  judge(rows, "fem 1700, sample S2", fem(1700), {s.name, s.pattern, s.start, s.handles, Paper{}},
        "told: its ends are hinged", Vector3d::Zero(), 0, 84);
  return rows;
}

}  // namespace paperbake::validation
