#include "core/step1_elastic/energies/ridge_yield.h"

#include "core/geometry/curvature.h"
#include "core/geometry/measure.h"
#include "core/model/degrees.h"

#include <algorithm>
#include <cmath>

namespace paperbake {
namespace {

// [rad] q up to which the paper bends smoothly, and from which it is a ridge: measured on S4
constexpr double smooth_turn = radians_of(6), ridge_turn = radians_of(15);
constexpr double neighbourhood = 0.5;  // [1] of X
constexpr int min_ends = 4;

/// s of each vertex alone.
Eigen::VectorXd sharpness(const Sheet& sheet, const Hinges& hinges, const Points3& curvature,
                          const std::vector<int>& held) {
  const SecondTurn second = second_turn(sheet, hinges, curvature);
  Eigen::VectorXd s(sheet.pattern.rows());
  for (int v = 0; v < s.size(); ++v)
    s[v] = second.border[v]
               ? 0
               : std::clamp((second.turn[v] - smooth_turn) / (ridge_turn - smooth_turn), 0.0, 1.0);
  for (const int v : held) s[v] = 0;
  if (s.isZero(0)) return s;
  const std::vector<char> obtuse = obtuse_rings(sheet.pattern, sheet.triangles, hinges);
  for (int v = 0; v < s.size(); ++v)
    if (obtuse[v]) s[v] = 0;
  return s;
}

/// [m] Size of a triangle across the ruling through it.
double size_across(const Sheet& sheet, int t, const Vector2d& across, double area) {
  const Vector2d along(-across.y(), across.x());
  double low = 1e300, high = -1e300;
  for (int i = 0; i < 3; ++i) {
    const double p = along.dot(sheet.pattern.row(sheet.triangles(t, i)));
    low = std::min(low, p);
    high = std::max(high, p);
  }
  return 2 * area / (high - low);
}

}  // namespace

RidgeField find_ridges(const Sheet& sheet, const Hinges& hinges, const Paper& paper,
                       const std::vector<int>& held, const Eigen::VectorXd& remembered) {
  const int triangles = static_cast<int>(sheet.triangles.rows());
  const Points3 curvature =
      vertex_curvature(sheet.pattern, sheet.triangles, hinges, bending_turns(sheet, hinges));
  std::vector<double> area(triangles);
  double whole = 0;
  for (int t = 0; t < triangles; ++t) whole += area[t] = pattern_area(sheet, t);
  const Eigen::VectorXd s = sharpness(sheet, hinges, curvature, held);

  RidgeField ridges{remembered, Eigen::VectorXd::Ones(triangles)};
  if (s.isZero(0) && remembered.isZero(0)) return ridges;
  const int ends = std::max<int>(min_ends, static_cast<int>(held.size() + sheet.singular.size()));
  const double X = std::sqrt(whole / ends);
  const double width = ridge_width(paper, X);
  for (int t = 0; t < triangles; ++t) {
    Eigen::RowVector2d centre(0, 0);
    for (int i = 0; i < 3; ++i) centre += sheet.pattern.row(sheet.triangles(t, i)) / 3;
    for (int i = 0; i < 3; ++i)
      ridges.share[t] = std::max(ridges.share[t], s[sheet.triangles(t, i)]);
    for (int v = 0; v < s.size(); ++v)
      if (s[v] > ridges.share[t] && (sheet.pattern.row(v) - centre).norm() < neighbourhood * X)
        ridges.share[t] = s[v];
    if (ridges.share[t] <= 0) continue;
    Vector3d tensor = Vector3d::Zero();
    for (int i = 0; i < 3; ++i) tensor += curvature.row(sheet.triangles(t, i)).transpose() / 3;
    const double across = std::max(
        size_across(sheet, t, principal_curvature(tensor).across, area[t]), neighbourhood * X);
    ridges.focus[t] = 1 - ridges.share[t] + ridges.share[t] * std::max(1.0, across / width);
  }
  return ridges;
}

}  // namespace paperbake
