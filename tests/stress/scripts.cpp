#include "tests/stress/scripts.h"

#include "core/geometry/pattern_mesh.h"
#include "core/geometry/random.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace paperbake::stress {
namespace {

/// Random numbers in [a, b), one after the other.
class Dice {
 public:
  Dice(std::uint32_t seed, int index) : seed_(seed), at_(std::uint64_t(index) << 20) {}
  double operator()(double a, double b) { return a + (b - a) * 0.5 * (1 + uniform(seed_, at_++)); }
  int below(int n) { return std::min(n - 1, static_cast<int>((*this)(0, n))); }

 private:
  std::uint32_t seed_;
  std::uint64_t at_;
};

std::vector<Vector2d> ellipse(const Vector2d& centre, const Vector2d& radii, int n,
                              bool clockwise = false) {
  std::vector<Vector2d> points;
  for (int i = 0; i < n; ++i) {
    const double t = (clockwise ? -2 : 2) * M_PI * i / n;
    points.push_back(centre + Vector2d(radii.x() * std::cos(t), radii.y() * std::sin(t)));
  }
  return points;
}

Pattern make_pattern(Dice& dice) {
  // [m] 2 mm to 10 m, evenly over the decades
  const double side = 0.002 * std::pow(5000, dice(0, 1));
  const double w = side, h = side * dice(0.15, 1);
  switch (dice.below(4)) {
    case 0:
      return {{{0, 0}, {w, 0}, {w, h}, {0, h}}, {}};
    case 1:
      return {ellipse({w / 2, h / 2}, {w / 2, h / 2}, 40), {}};
    case 2:
      return {{{0, 0}, {w, 0}, {w, 0.4 * h}, {0.4 * w, 0.4 * h}, {0.4 * w, h}, {0, h}}, {}};
    default:
      return {{{0, 0}, {w, 0}, {w, h}, {0, h}},
              {ellipse({0.5 * w, 0.5 * h}, {0.2 * w, 0.2 * h}, 16, true)}};
  }
}

/// A flat start shape, on the mesh that a scene might bring: fine, or full of slivers.
Sheet make_start(const Pattern& pattern, bool slivers) {
  std::vector<Vector2d> border = pattern.outline;
  for (const std::vector<Vector2d>& hole : pattern.holes)
    border.insert(border.end(), hole.begin(), hole.end());
  const PatternMesh mesh =
      mesh_pattern(pattern, longer_side(pattern) * (slivers ? 0.4 : 0.1), border);
  Sheet start;
  start.pattern = mesh.vertices;
  start.triangles = mesh.triangles;
  if (slivers) {  // splits every triangle into three at a point almost on an edge
    const int old_points = static_cast<int>(mesh.vertices.rows()),
              old = static_cast<int>(mesh.triangles.rows());
    start.pattern.conservativeResize(old_points + old, 2);
    start.triangles.resize(3 * old, 3);
    for (int t = 0; t < old; ++t) {
      const Eigen::RowVector3i c = mesh.triangles.row(t);
      const int middle = old_points + t;
      start.pattern.row(middle) = 0.4999 * mesh.vertices.row(c[0]) +
                                  0.4999 * mesh.vertices.row(c[1]) +
                                  0.0002 * mesh.vertices.row(c[2]);
      for (int i = 0; i < 3; ++i) start.triangles.row(3 * t + i) << c[i], c[(i + 1) % 3], middle;
    }
  }
  start.x = Points3::Zero(start.pattern.rows(), 3);
  start.x.leftCols<2>() = start.pattern;
  return start;
}

std::vector<Vector2d> points_on(const Pattern& pattern, int n, Dice& dice) {
  const Vector2d size = extent(pattern);
  std::vector<Vector2d> points;
  while (static_cast<int>(points.size()) < n) {
    Vector2d p(dice(0, size.x()), dice(0, size.y()));
    if (dice(0, 1) < 0.5) p = nearest_border_point(pattern, p);  // artists hold borders
    if (contains(pattern, p, 1e-9 * size.x())) points.push_back(p);
  }
  return points;
}

using Motion = std::function<void(Script&, Dice&)>;

Vector3d flat(const Handle& handle) { return {handle.pattern.x(), handle.pattern.y(), 0}; }

/// Handles go to places that paper can reach: they are drawn together towards a point and lifted.
/// way  [1] how far they are in frame f, from 0 to 1
void gather(Script& script, Dice& dice, const std::function<double(int)>& way) {
  const double side = longer_side(script.shot.pattern), closer = dice(0.3, 0.95);
  const Vector2d middle = extent(script.shot.pattern) / 2;
  for (Handle& handle : script.shot.handles) {
    const double lift = dice(-0.1, 0.1) * side;
    // two points whose distance shrinks to the share c may differ in height by what is then left of
    // the paper between them
    const Vector2d to = middle + closer * (handle.pattern - middle);
    double least = side;
    for (const Handle& other : script.shot.handles)
      if (const double apart = (other.pattern - handle.pattern).norm(); apart > 0)
        least = std::min(least, apart);
    const double room = 0.5 * least * std::sqrt(std::max(0.0, 1 - closer * closer));
    for (int f = 0; f < handle.keyed.rows(); ++f) {
      const double s = way(f);
      handle.keyed.row(f) << (1 - s) * handle.pattern.x() + s * to.x(),
          (1 - s) * handle.pattern.y() + s * to.y(), s * std::clamp(lift, -room, room);
    }
  }
}

double smooth(int f, int frames) {
  const double t = std::clamp(double(f) / frames, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

const std::vector<std::pair<std::string, Motion>>& motions() {
  static const std::vector<std::pair<std::string, Motion>> all{
      {"smooth",
       [](Script& s, Dice& d) {
         gather(s, d, [&](int f) { return smooth(f, s.options.last_frame); });
       }},
      {"jerks",
       [](Script& s, Dice& d) {
         gather(s, d, [&](int f) {
           return 0.25 * ((f / 3) % 2) + 0.5 * smooth(f, s.options.last_frame);
         });
       }},
      {"teleport",
       [](Script& s, Dice& d) { gather(s, d, [&](int f) { return f < 5 ? 0.0 : 1.0; }); }},
      {"16x", [](Script& s, Dice& d) { gather(s, d, [&](int f) { return smooth(16 * f, 48); }); }},
      {"there and back",
       [](Script& s, Dice& d) {
         gather(s, d,
                [&](int f) { return 0.5 - 0.5 * std::cos(2 * M_PI * f / s.options.last_frame); });
       }},
      {"over-stretch",
       [](Script& s, Dice&) {
         const Vector2d middle = extent(s.shot.pattern) / 2;
         for (Handle& handle : s.shot.handles)
           for (int f = 0; f < handle.keyed.rows(); ++f)
             handle.keyed.row(f).head<2>() += 0.2 * smooth(f, 8) * (handle.pattern - middle);
       }},
      {"coincident",
       [](Script& s, Dice& d) {
         Handle& first = s.shot.handles.front();
         s.shot.handles.push_back(first);
         Handle& second = s.shot.handles.back();
         second.name += ".twin";
         const double off = d(0.01, 0.1) * longer_side(s.shot.pattern);
         for (int f = 0; f < second.keyed.rows(); ++f) second.keyed(f, 2) += off * smooth(f, 8);
       }},
      // handles change places with their mirror images, on an arc
      {"crossing",
       [](Script& s, Dice& d) {
         const double middle = extent(s.shot.pattern).x() / 2;
         for (Handle& handle : s.shot.handles) {
           const double arm = handle.pattern.x() - middle, up = d(-0.2, 0.2);
           for (int f = 0; f < handle.keyed.rows(); ++f) {
             const double turn = M_PI * smooth(f, s.options.last_frame);
             handle.keyed(f, 0) = middle + arm * std::cos(turn);
             handle.keyed(f, 2) = up * std::abs(arm) * std::sin(turn);
           }
         }
       }},
      {"all released",
       [](Script& s, Dice& d) {
         gather(s, d, [&](int f) { return smooth(f, 10); });
         for (Handle& handle : s.shot.handles) handle.release_frame = 12;
       }},
      {"released and grabbed again",
       [](Script& s, Dice& d) {
         gather(s, d, [&](int f) { return smooth(f, 8); });
         const std::vector<Handle> once = s.shot.handles;
         for (Handle& handle : s.shot.handles) handle.release_frame = 9;
         for (Handle again : once) {
           again.name += ".again";
           again.mode = HandleMode::relative;
           again.grab_frame = 12;
           s.shot.handles.push_back(again);
         }
       }},
      {"bad start mesh",
       [](Script& s, Dice& d) {
         s.shot.start = make_start(s.shot.pattern, true);
         gather(s, d, [&](int f) { return smooth(f, s.options.last_frame); });
       }},
      // an arch between two borders is pushed through from above
      {"snap-through",
       [](Script& s, Dice& d) {
         const double w = extent(s.shot.pattern).x();
         gather(s, d, [](int) { return 0.0; });
         for (Handle& handle : s.shot.handles)
           for (int f = 0; f < handle.keyed.rows(); ++f)
             handle.keyed(f, 0) += 0.12 * smooth(f, 8) * (w / 2 - handle.pattern.x());
         Handle push = s.shot.handles.front();
         push.name = "push";
         push.pattern = nearest_border_point(s.shot.pattern, {w / 2, 0});
         push.mode = HandleMode::relative;
         push.grab_frame = 9;
         for (int f = 0; f < push.keyed.rows(); ++f)
           push.keyed.row(f) << 0, 0, -0.25 * w * smooth(f - 9, s.options.last_frame - 9);
         s.shot.handles.push_back(push);
       }},
      // in the plane of the sheet, where nothing tells it to which side to buckle
      {"compressed flat",
       [](Script& s, Dice& d) {
         const double closer = d(0.5, 0.95);
         const Vector2d middle = extent(s.shot.pattern) / 2;
         for (Handle& handle : s.shot.handles)
           for (int f = 0; f < handle.keyed.rows(); ++f)
             handle.keyed.row(f).head<2>() -=
                 (1 - closer) * smooth(f, 6) * (handle.pattern - middle);
       }},
      {"wild",
       [](Script& s, Dice& d) {  // every handle jumps anywhere every third frame
         const double side = longer_side(s.shot.pattern);
         for (Handle& handle : s.shot.handles)
           for (int f = 3; f < handle.keyed.rows(); f += 3) {
             const Vector3d to(d(-1, 1) * side, d(-1, 1) * side, d(-1, 1) * side);
             for (int g = f; g < std::min<int>(f + 3, handle.keyed.rows()); ++g)
               handle.keyed.row(g) = to;
           }
       }},
  };
  return all;
}

}  // namespace

const std::vector<std::string>& kinds() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const auto& [name, motion] : motions()) all.push_back(name);
    return all;
  }();
  return names;
}

Script make_script(int index, std::uint32_t seed) {
  Dice dice(seed, index);
  Script script;
  const auto& [kind, motion] = motions()[index % motions().size()];
  script.kind = kind;
  script.shot.sheet_name = "paper";
  script.shot.pattern = make_pattern(dice);
  script.shot.start = make_start(script.shot.pattern, false);
  script.options.last_frame = 12 + dice.below(29);
  // half of the scripts have steps of 1/24 s, the others down to 1/2400 s
  script.options.fps = 24 * std::pow(100, std::max(0.0, dice(-1, 1)));
  script.options.seed = static_cast<unsigned>(dice.below(1000));
  script.options.plasticity = Plasticity::on;
  const int handles = 1 + dice.below(16);
  for (const Vector2d& p : points_on(script.shot.pattern, handles, dice)) {
    Handle handle;
    handle.name = "handle." + std::to_string(script.shot.handles.size());
    handle.pattern = p;
    if (dice(0, 1) < 0.5) handle.radius = 0;
    handle.keyed = Points3::Zero(script.options.last_frame, 3);
    for (int f = 0; f < handle.keyed.rows(); ++f) handle.keyed.row(f) = flat(handle);
    script.shot.handles.push_back(std::move(handle));
  }
  motion(script, dice);
  script.impossible = HandleFeasibility(script.shot.pattern, script.shot.handles)
                          .impossible_pairs(script.shot.handles, 1, script.options.last_frame);
  return script;
}

}  // namespace paperbake::stress
