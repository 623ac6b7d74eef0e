#include "tests/core/test_meshes.h"
#include "tests/validation/cases.h"
#include "tests/validation/gripped_cone.h"

// An excess angle needs a pattern that overlaps itself. The energy accepts one: a fan of more than
// a full turn, whose last rulings are at the same place as its first. Two more sectors without
// stiffness lie over the seam, because the hinges of the seam need their far corners. Pattern
// meshes, and so the methods, know only regions of the plane. Core and membrane are as in
// d_cone.cpp.

namespace paperbake::validation {
namespace {

constexpr double R = 0.05, hole = 0.3 * R;  // [m]
constexpr double stiffer = 100;             // [1] stiffness of the membrane over that of paper

struct Fan {
  Sheet sheet;
  std::vector<int> twin;        // |V| as in Grips (gripped_cone.h)
  std::vector<double> factors;  // |T| on the bending stiffness; 0 over the seam
};

/// Columns k = -1 to rulings + 1 at the angles total k/rulings; columns -1, rulings and rulings + 1
/// are at the places of rulings - 1, 0 and 1.
Fan fan(int rulings, int rings, double total) {
  const int columns = rulings + 3;
  Points2 p((rings + 1) * columns, 2);
  Triangles t(2 * rings * (columns - 1), 3);
  Fan result;
  const auto at = [&](int ring, int k) { return ring * columns + k + 1; };
  for (int ring = 0, next = 0; ring <= rings; ++ring)
    for (int k = -1; k <= rulings + 1; ++k) {
      const double r = hole * std::pow(R / hole, double(ring) / rings), angle = total * k / rulings;
      p.row(at(ring, k)) << r * std::cos(angle), r * std::sin(angle);
      result.twin.push_back(at(ring, (k + rulings) % rulings));
      if (ring == rings || k > rulings) continue;
      t.row(next++) << at(ring, k), at(ring + 1, k), at(ring + 1, k + 1);
      t.row(next++) << at(ring, k), at(ring + 1, k + 1), at(ring, k + 1);
      result.factors.insert(result.factors.end(), 2, k < 0 || k >= rulings ? 0 : 1);
    }
  result.sheet = test::flat_sheet(std::move(p), std::move(t));
  return result;
}

/// Puts the rulings at the elevation a cos 2t, with a such that they close after one turn. In
/// column k = 0, t is 0.
void bend_to_saddle(Sheet& sheet, int rulings, double total) {
  constexpr int per_sector = 64;
  const int n = rulings * per_sector;
  const double ds = total / n;
  std::vector<double> elevation(n + 1), azimuth(n + 1, 0.0);
  double low = 0, high = 1.5;
  for (int halving = 0; halving < 60; ++halving) {
    const double a = 0.5 * (low + high);
    for (int k = 0; k <= n; ++k) elevation[k] = a * std::cos(4 * M_PI * k / n);
    for (int k = 0; k < n; ++k)
      azimuth[k + 1] =
          azimuth[k] +
          std::sqrt(std::max(0.0, ds * ds - std::pow(elevation[k + 1] - elevation[k], 2))) /
              std::cos(0.5 * (elevation[k] + elevation[k + 1]));
    (azimuth[n] > 2 * M_PI ? low : high) = a;
  }
  const int columns = rulings + 3;
  for (int v = 0; v < sheet.x.rows(); ++v) {
    const int k = (v % columns - 1 + rulings) % rulings * per_sector;
    const double r = sheet.pattern.row(v).norm();
    sheet.x.row(v) << r * std::cos(elevation[k]) * std::cos(azimuth[k]),
        r * std::cos(elevation[k]) * std::sin(azimuth[k]), r * std::sin(elevation[k]);
  }
}

void judge(Rows& rows, int rulings, double excess, double squared, double highest) {
  Paper paper;
  paper.membrane_stiffness *= stiffer;
  paper.poisson = 0;
  Fan paper_fan = fan(rulings, rulings / 6, 2 * M_PI + excess);
  Sheet& sheet = paper_fan.sheet;
  bend_to_saddle(sheet, rulings, 2 * M_PI + excess);
  Grips grips;
  grips.on_spheres = vertices_where(sheet, [](const Vector2d& p) {
    return p.norm() > R * (1 - 1e-3) || p.norm() < hole * (1 + 1e-3);
  });
  grips.twin = paper_fan.twin;
  GrippedCone cone(paper, sheet, std::move(grips), 0, paper_fan.factors);
  const double move = cone.minimise();
  double steepest = 0;
  for (int v = 0; v < sheet.x.rows(); ++v)
    steepest =
        std::max(steepest, std::atan2(sheet.x(v, 2), std::hypot(sheet.x(v, 0), sheet.x(v, 1))));
  char label[80];
  std::snprintf(label, sizeof label, "%d rulings, phi %.2f", rulings, excess);
  const char* const source = "V4b: exact spherical curve";
  rows.push_back({label, "2 E / (D ln R/r)", squared,
                  2 * cone.parts().bending / (paper.bending_stiffness * std::log(R / hole)), 0.02,
                  source, ""});
  rows.push_back(
      {label, "highest elevation, degrees", highest, steepest * 180 / M_PI, 0.02, source, ""});
  if (move > 1e-8) rows.push_back({label, "Newton's last move, m", 0, move, 1e-7, "", ""});
}

}  // namespace

Rows e_cone() {
  // phi, int kg^2, degrees
  constexpr double table[][3] = {
      {0.05, 0.2946, 5.92}, {0.2, 1.122, 11.90}, {0.5, 2.548, 19.0}, {1.0, 4.367, 27.3}};
  Rows rows;
  for (const int rulings : {72, 96})
    for (const auto& [excess, squared, highest] : table)
      judge(rows, rulings, excess, squared, highest);
  for (const char* const method : {"fem", "hybrid", "adaptive"})
    rows.push_back(
        {method, "any", 0, 0, 0, "", "a pattern is a plane region: nothing can be inserted in it"});
  return rows;
}

}  // namespace paperbake::validation
