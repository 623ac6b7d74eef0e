#include "core/step2_crumple/find_fold_lines.h"

#include "core/geometry/measure.h"
#include "core/model/degrees.h"
#include "core/model/segment2.h"
#include "core/step2_crumple/bent_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace paperbake {
namespace {

constexpr double one_way = 0.9;              // [1] of the plastic turn, about the line
constexpr double min_turn = radians_of(90);  // of the sheet, in three rows of triangles
// [1] of the curvature at which paper yields: what the mean over two rows of triangles must reach
// where single triangles have yielded
constexpr double least_bend = 0.5;
// [1] of what the sheet turns by in the three rows at a fold: the most that it goes on to turn by
// in the rows beside them. Paper beside a fold is nearly flat, or turns back.
constexpr double most_beside = 0.3;
// how many places a fold is tried in, and how far beyond where it may be [rows]
constexpr int places = 7;
constexpr double margin = 0.1;
constexpr double least_plastic = radians_of(1);  // turn that stays, in each part of the line

/// What happens across a line in parts of it that are two rows of triangles long.
struct Profile {
  // [rad] within a row and a half of the line; [1/m] mean with weights that fall to zero in a row;
  // [rad] plastic turn
  std::vector<double> turn, curvature, plastic;
};

/// Whether the sheet turns within three rows of triangles, and hardly in those beside them. A roll
/// or a loop that its mesh can show turns on and on.
bool is_localised(const BentMesh& mesh, const TurnAxis& axis) {
  double near = 0, all = 0;
  for_each_turn_within(3, mesh, axis, [&](const Vector2d&, double rows, double turn, std::size_t) {
    all += turn;
    if (std::abs(rows) <= 1.5) near += turn;
  });
  return std::abs(all) <= (1 + most_beside) * std::abs(near);
}

/// Moves the axis to where the sheet turns most: the mean of the turn within a row and a half,
/// which counts less the farther away it is.
void centre(const BentMesh& mesh, TurnAxis& axis) {
  for (int again = 0; again < 8; ++again) {
    double sum = 0, moment = 0;
    for_each_turn(mesh, axis, [&](const Vector2d&, double rows, double turn, std::size_t) {
      const double weight = 1.5 - std::abs(rows);
      sum += weight * turn;
      moment += weight * turn * rows;
    });
    if (!(std::abs(moment) < 0.5 * std::abs(sum))) return;
    axis.middle += moment / sum * mesh.row * axis.across;
  }
}

Profile profile_of(const BentMesh& mesh, const FoldLine& line, const TurnAxis& axis) {
  const double length = (line.b - line.a).norm();
  const int parts = std::max(2, static_cast<int>(std::lround(length / (2 * mesh.row))));
  const Vector2d along = (line.b - line.a) / length;
  const auto part_of = [&](const Vector2d& p) {
    return std::clamp(static_cast<int>((p - line.a).dot(along) / length * parts), 0, parts - 1);
  };
  const std::vector<double> zero(parts, 0.0);
  Profile profile{zero, zero, zero};
  for_each_turn(mesh, axis, [&](const Vector2d& at, double rows, double turn, std::size_t) {
    profile.turn[part_of(at)] += turn * parts / length;
    profile.curvature[part_of(at)] +=
        turn * parts / length * std::max(0.0, 1 - std::abs(rows)) / mesh.row;
  });
  for (const int t : line.band) {
    const Eigen::Matrix2d S = mesh.plastic(t);
    profile.plastic[part_of(mesh.middle(t))] += axis.across.dot(S * axis.across) * parts / length;
  }
  return profile;
}

/// A part of a sheet between colliders.
struct PressedPart {
  Vector3d axis{0, 0, 0}, bisector{0, 0, 0};  // [m rad] sums, weighted by the turn of the edges
  ColliderGap widest{0, {0, 0, 0}};
};

/// [1/m] Curvature that paper has somewhere in a part that turns by `turn` [rad] within its gap.
///
/// Across the axis paper is a curve. Where its tangent is at the angle psi to the direction across
/// the gap it gets on by cos(psi) ds, and a curvature of k or less turns it by k ds at most. While
/// psi passes from psi_1 to psi_2, both within 90 degrees, it gets on by
/// (sin(psi_2) - sin(psi_1))/k or more, which is no more than the width of the gap. What the mesh
/// shows between its edges does not matter for this.
double needed_curvature(const PressedPart& part, double turn) {
  const Vector3d axis = part.axis.normalized(), bisector = part.bisector.normalized(),
                 across = part.widest.normal - axis.dot(part.widest.normal) * axis;
  const double half = 0.5 * std::min(std::abs(turn), M_PI),
               off = std::asin(std::min(1.0, std::abs(bisector.dot(across.normalized()))));
  const auto reach = [&](double psi) { return std::sin(std::min(psi, M_PI / 2)); };
  return across.norm() * (reach(half + off) + reach(half - off)) /
         std::max(part.widest.width, 1e-9);
}

/// [1/m] The same for each part of a line.
std::vector<double> needed_curvature(const BentMesh& mesh, const FoldLine& line,
                                     const TurnAxis& axis, const std::vector<double>& turns) {
  const int count = static_cast<int>(turns.size());
  const Vector2d along = line.b - line.a;
  std::vector<PressedPart> parts(count);
  for_each_turn(mesh, axis, [&](const Vector2d& at, double, double turn, std::size_t h) {
    const double share = (at - line.a).dot(along) / along.squaredNorm();
    PressedPart& part = parts[std::clamp(static_cast<int>(share * count), 0, count - 1)];
    const Hinge& hinge = mesh.hinges.hinges[h];
    const Points3& x = mesh.sheet.x;
    const Vector3d edge = x.row(hinge.vertices[1]) - x.row(hinge.vertices[0]);
    const Vector2d d =
        mesh.sheet.pattern.row(hinge.vertices[1]) - mesh.sheet.pattern.row(hinge.vertices[0]);
    part.axis += turn * (d.dot(along) < 0 ? -edge : edge).normalized();
    for (const int t : hinge.triangles) {
      const Eigen::RowVector3i v = mesh.sheet.triangles.row(t);
      const Vector3d a = x.row(v[0]), b = x.row(v[1]), c = x.row(v[2]);
      part.bisector += turn * triangle_normal(a, b, c);
    }
    if (mesh.gap[h]->width > part.widest.width) part.widest = *mesh.gap[h];
  });
  std::vector<double> needed;
  for (int k = 0; k < count; ++k) needed.push_back(needed_curvature(parts[k], turns[k]));
  return needed;
}

/// The smallest value when all have the sign of the first; else 0.
double least(const std::vector<double>& values) {
  double least = std::numeric_limits<double>::infinity();
  for (const double value : values) least = std::min(least, values.front() > 0 ? value : -value);
  return std::max(0.0, least);
}

/// The line along an axis, if the sheet is being folded there.
std::optional<FoldLine> fold_on(const BentMesh& mesh, const TurnAxis& axis, const Pattern& pattern,
                                double yield_curvature) {
  const auto ends = on_paper(pattern, axis);
  if (!ends || (ends->second - ends->first).norm() < 3 * mesh.row) return std::nullopt;
  FoldLine line{ends->first, ends->second, 0, band_along(mesh, axis)};
  const Profile profile = profile_of(mesh, line, axis);
  for (const double turn : profile.plastic) line.plastic_turn += turn / profile.plastic.size();
  const double bend = least(profile.curvature);
  if (least(profile.turn) < min_turn || bend * mesh.row < unresolved_turn) return std::nullopt;
  const bool yields =
      mesh.gap.empty()
          ? bend >= least_bend * yield_curvature && least(profile.plastic) >= least_plastic
          : least(needed_curvature(mesh, line, axis, profile.turn)) >= yield_curvature;
  if (!yields || !is_localised(mesh, axis)) return std::nullopt;
  return line;
}

/// The axis about which the triangles turn that are beside a triangle; none: they turn in several
/// directions.
std::optional<TurnAxis> axis_through(const BentMesh& mesh, int seed) {
  TurnAxis axis = axis_of(mesh, {seed});
  for (int again = 0; again < 2; ++again) {
    const std::vector<int> band = band_along(mesh, axis);
    if (band.empty()) return std::nullopt;
    axis = axis_of(mesh, band);
  }
  return axis.share < one_way ? std::nullopt : std::optional(axis);
}

bool lies_on(const FoldLine& line, const PrescribedCrease& crease, double near) {
  const auto is_near = [&](const Vector2d& p) {
    for (std::size_t k = 0; k + 1 < crease.line.size(); ++k)
      if (distance_to_segment(p, crease.line[k], crease.line[k + 1]) < near) return true;
    return false;
  };
  return is_near(line.a) && is_near(line.b);
}

/// Places of the fold that turns most; empty: there is none.
std::vector<FoldLine> lines_on(const BentMesh& mesh, const Pattern& pattern,
                               double yield_curvature) {
  std::vector<int> seeds;
  for (int t = 0; t < mesh.sheet.triangles.rows(); ++t)
    if (mesh.counts[t]) seeds.push_back(t);
  std::stable_sort(seeds.begin(), seeds.end(),
                   [&](int s, int t) { return mesh.turn[s].norm() > mesh.turn[t].norm(); });
  const auto is_known = [&](const FoldLine& line) {
    return std::any_of(
        mesh.sheet.prescribed_creases.begin(), mesh.sheet.prescribed_creases.end(),
        [&](const PrescribedCrease& known) { return lies_on(line, known, 2 * mesh.row); });
  };
  for (const int seed : seeds) {
    const std::optional<TurnAxis> axis = axis_through(mesh, seed);
    if (!axis) continue;
    const std::optional<FoldLine> line = fold_on(mesh, *axis, pattern, yield_curvature);
    if (!line || is_known(*line)) continue;
    TurnAxis middle = *axis;
    centre(mesh, middle);
    const double ahead = axis->across.dot(middle.middle - axis->middle), more = margin * mesh.row;
    const double from = std::min(0.0, ahead) - more, to = std::max(0.0, ahead) + more;
    std::vector<FoldLine> lines;
    for (int k = 0; k < places; ++k) {
      TurnAxis there = *axis;
      there.middle += (from + (to - from) * k / (places - 1)) * axis->across;
      if (const auto ends = on_paper(pattern, there))
        lines.push_back({ends->first, ends->second, line->plastic_turn, line->band});
    }
    return lines;
  }
  return {};
}

}  // namespace

std::vector<FoldLine> find_fold_lines(const Sheet& sheet, const PlasticMemory& memory,
                                      const Pattern& pattern, double yield_curvature) {
  return lines_on(yielded_mesh(sheet, memory), pattern, yield_curvature);
}

std::vector<FoldLine> find_pressed_lines(const Sheet& sheet,
                                         const std::function<PlasticMemory()>& memory,
                                         const ColliderShapes& colliders, const Pattern& pattern,
                                         double yield_curvature) {
  const double widest = 2 / yield_curvature;  // paper that turns by 180 degrees in it yields
  BentMesh mesh = pressed_mesh(sheet, colliders, widest);
  if (std::count(mesh.counts.begin(), mesh.counts.end(), 1) == 0) return {};
  mesh.memory = memory();
  return lines_on(mesh, pattern, yield_curvature);
}

std::optional<FoldLine> parallel_line(const FoldLine& line, double off, const Pattern& pattern) {
  const Vector2d along = (line.b - line.a).normalized(), across(-along.y(), along.x());
  TurnAxis axis;
  axis.across = across;
  axis.middle = 0.5 * (line.a + line.b) + off * across;
  const auto ends = on_paper(pattern, axis);
  if (!ends) return std::nullopt;
  return FoldLine{ends->first, ends->second, line.plastic_turn, line.band};
}

}  // namespace paperbake
