#include "core/animation/animate.h"
#include "core/geometry/intersections.h"
#include "core/geometry/measure.h"
#include "core/geometry/point_location.h"
#include "core/methods/adaptive.h"
#include "core/methods/fem.h"
#include "core/methods/hybrid.h"
#include "formats/scene/scene_file.h"
#include "tests/core/test_shots.h"
#include "tests/validation/cases.h"

#include <algorithm>

namespace paperbake::validation {
namespace {

constexpr double side = 0.1;  // [m]
const char* const source = "V9";

/// Largest |2 pi - sum of angles| at a singular point inside the sheet: a d-cone closes after one
/// turn. [rad]
double cone_defect(const Sheet& sheet) {
  std::vector<double> sum(sheet.x.rows(), 0.0), flat(sheet.x.rows(), 0.0);
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i) {
      const int v = sheet.triangles(t, i), a = sheet.triangles(t, (i + 1) % 3),
                b = sheet.triangles(t, (i + 2) % 3);
      const auto angle = [&](const auto& p) {
        const Vector3d to_a = Vector3d(p(a) - p(v)).normalized(),
                       to_b = Vector3d(p(b) - p(v)).normalized();
        return std::atan2(to_a.cross(to_b).norm(), to_a.dot(to_b));
      };
      sum[v] += angle([&](int k) { return Vector3d(sheet.x.row(k)); });
      flat[v] +=
          angle([&](int k) { return Vector3d(sheet.pattern(k, 0), sheet.pattern(k, 1), 0); });
    }
  double most = 0;
  for (const SingularPoint& apex : sheet.singular)
    for (const int v :
         vertices_where(sheet, [&](const Vector2d& p) { return (p - apex.pattern).norm() < 1e-9; }))
      if (flat[v] > 2 * M_PI - 1e-6) most = std::max(most, std::abs(2 * M_PI - sum[v]));
  return most;
}

struct Played {
  Sheet last;
  double miss = 0;  // [m] largest distance of a held handle from its target
  // worst of all frames: c_m, length error of an edge, angle defect
  double mean = 0, edge = 0, defect = 0;
  double cone = 0;               // angle defect at singular points
  double rise = 0;               // [1] largest rise of the energy by an accepted mesh
  int crossings = 0, taken = 0;  // pairs of triangles; meshes
};

Played play(const Shot& shot, const MethodChoice& method, const AnimateOptions& options) {
  Played played;
  animate(shot, method, options, [&](const AnimatedFrame& frame) {
    const LengthDistortion lengths = length_distortion(*frame.sheet);
    for (const HandleFrame& handle : frame.handles)
      if (handle.state == HandleFrame::held)
        played.miss = std::max(played.miss, (handle.at - handle.keyed).norm());
    played.mean = std::max(played.mean, lengths.mean);
    played.edge = std::max(played.edge, lengths.largest);
    played.defect = std::max(played.defect, angle_defect_max(*frame.sheet));
    played.cone = std::max(played.cone, cone_defect(*frame.sheet));
    if (frame.statistics.remesh == FrameStatistics::accepted) {
      ++played.taken;
      played.rise = std::max(played.rise, frame.statistics.remesh_rise);
    }
    played.crossings += crossings(*frame.sheet);
    played.last = *frame.sheet;
    return true;
  });
  return played;
}

/// S1 without the push from above, at 24 x `times` frames a second.
Shot push(int times = 1) {
  Shot shot = test::s1_push();
  shot.handles.pop_back();
  for (Handle& handle : shot.handles) {
    Points3 slow = handle.keyed;
    handle.keyed.resize((slow.rows() - 1) * times + 1, 3);
    for (int f = 0; f < handle.keyed.rows(); ++f) {
      const int before = std::min<int>(f / times, static_cast<int>(slow.rows()) - 2);
      handle.keyed.row(f) = slow.row(before) + (double(f) / times - before) *
                                                   (slow.row(before + 1) - slow.row(before));
    }
  }
  return shot;
}

Vector3d at(const PointLocator& locator, const Sheet& sheet, double u, double v) {
  return interpolate(locator.locate({u, v}), sheet.triangles, sheet.x);
}

double mid_height(const Sheet& sheet) {
  return at(PointLocator(sheet.pattern, sheet.triangles), sheet, 0.5 * side, 0.5 * side).z();
}

/// Largest difference in height between a sheet and its mirror image about the middle between its
/// hinges. [m]
double asymmetry(const Sheet& sheet) {
  const PointLocator locator(sheet.pattern, sheet.triangles);
  double most = 0;
  for (int i = 1; i < 40; ++i)
    for (int j = 0; j <= 8; ++j) {
      const double u = side * i / 40, v = side * j / 8;
      most = std::max(most,
                      std::abs(at(locator, sheet, u, v).z() - at(locator, sheet, side - u, v).z()));
    }
  return most;
}

void judge(Rows& rows, const std::string& name,
           const std::function<MethodChoice(const Shot&, double turn)>& method) {
  AnimateOptions options;
  options.last_frame = 30;
  options.elastic.stop = 1e-7;
  const Shot shot = push();
  const Played once = play(shot, method(shot, 0), options),
               again = play(shot, method(shot, 0), options);
  const bool same = once.last.triangles.rows() == again.last.triangles.rows() &&
                    once.last.triangles == again.last.triangles &&
                    once.last.pattern == again.last.pattern && once.last.x == again.last.x;
  rows.push_back({name, "farthest handle, m", 0, once.miss, 1e-300, source, ""});
  rows.push_back({name, "c_m", 0, once.mean, 5e-4, source, ""});
  rows.push_back({name, "largest |dl|/l", 0, once.edge, 0.01, source, ""});
  rows.push_back({name, "angle defect, rad", 0, once.defect, 1e-3, source, ""});
  rows.push_back({name, "same bits a second time", 1, double(same), 1e-300, source, ""});
  rows.push_back({name, "mirror image, m", 0, asymmetry(once.last), 1e-6, source, ""});

  const Shot turned = push();
  rows.push_back({name, "mid height, lattice turned", mid_height(once.last),
                  mid_height(play(turned, method(turned, M_PI / 6), options).last), 0.02,
                  "V2: spread on turned meshes", ""});

  const Shot fine = push(2);
  AnimateOptions halved = options;
  halved.fps = 48;
  halved.last_frame = 59;
  rows.push_back({name, "mid height, dt halved", mid_height(once.last),
                  mid_height(play(fine, method(fine, 0), halved).last), 0.005, source, ""});

  const Shot there_and_back = test::s1_push(true);
  AnimateOptions longer = options;
  longer.last_frame = 50;
  const Sheet flat = play(there_and_back, method(there_and_back, 0), longer).last;
  rows.push_back(
      {name, "height there and back, m", 0, flat.x.col(2).cwiseAbs().maxCoeff(), 1e-4, source, ""});
}

void judge_hybrid(Rows& rows, const std::string& file) {
  const Scene scene = read_scene(PAPERBAKE_SAMPLES "/" + file + ".glb");
  const SceneSheet& s = scene.sheets.front();
  const Shot shot{s.name, s.pattern, s.start, s.handles, Paper{}};
  AnimateOptions options;
  options.fps = scene.fps;
  options.last_frame = scene.last_frame;
  options.plasticity = Plasticity::on;
  const Played played = play(shot, hybrid(shot.pattern, shot.paper, 120, {}, 0, 0), options);
  const std::string name = "hybrid 120, " + file;
  rows.push_back({name, "farthest handle not jammed, m", 0, played.miss, 1e-4, source, ""});
  rows.push_back({name, "c_m", 0, played.mean, 5e-4, source, ""});
  rows.push_back({name, "largest |dl|/l", 0, played.edge, 0.01, source, ""});
  rows.push_back({name, "angle defect, rad", 0, played.defect, 1e-3, source, ""});
  if (!played.last.singular.empty())
    rows.push_back({name, "angle defect of cones, rad", 0, played.cone, 1e-3, source, ""});
  rows.push_back({name, "crossings", 0, double(played.crossings), 0.5, source, ""});
  rows.push_back({name, "meshes taken", 0, double(played.taken), 0, "", ""});
  rows.push_back({name, "rise of energy by one of them", 0, played.rise, 0.01, source,
                  played.taken > 0 ? "" : "none was taken"});
}

}  // namespace

Rows exactness() {
  Rows rows;
  judge(rows, "fem 1700", [](const Shot&, double turn) { return fem({1700, turn}); });
  judge(rows, "hybrid 120", [](const Shot& shot, double turn) {
    return hybrid(shot.pattern, shot.paper, {120, turn}, {}, 0, 0);
  });
  judge(rows, "adaptive 3000", [](const Shot& shot, double turn) {
    SizingOptions options;
    options.turn = turn;
    return adaptive(shot.pattern, 3000, options);
  });
  for (const char* const scene : {"S4_crumple", "S5_roll", "S8_dcone"}) judge_hybrid(rows, scene);
  rows.push_back({"fem", "rise of energy by a mesh", 0, 0, 0, "", "its mesh never changes"});
  rows.push_back(
      {"adaptive", "rise of energy by a mesh", 0, 0, 0, "",
       "its mesh changes before the step that relaxes it: there are not two minima to compare"});
  rows.push_back({"any", "planarity of ruling quads", 0, 0, 0, "", "meshes are of triangles"});
  return rows;
}

}  // namespace paperbake::validation
