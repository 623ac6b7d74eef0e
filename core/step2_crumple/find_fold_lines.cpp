#include "core/step2_crumple/find_fold_lines.h"

#include "core/geometry/collider_gap.h"
#include "core/geometry/hinges.h"
#include "core/geometry/measure.h"
#include "core/linear_algebra/symmetric_eigen.h"
#include "core/model/segment2.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace paperbake {
namespace {

constexpr double one_way = 0.9;               // [1] of the plastic turn, about the line
constexpr double min_turn = 90 * M_PI / 180;  // of the sheet, in three rows of triangles
// [1] of the curvature at which paper yields: what the mean over two rows of triangles must reach
// where single triangles have yielded
constexpr double least_bend = 0.5;
constexpr double unresolved = 1;  // [rad] in a row of triangles
// [1] of what the sheet turns by in the three rows at a fold: the most that it goes on to turn by
// in the rows beside them. Paper beside a fold is nearly flat, or turns back.
constexpr double most_beside = 0.3;
// how many places a fold is tried in, and how far beyond where it may be [rows]
constexpr int places = 7;
constexpr double margin = 0.1;
constexpr double least_plastic = 1 * M_PI / 180;  // turn that stays, in each part of the line

/// A mesh with what shows that its paper yields: the triangles that have yielded, or the colliders
/// that press the sheet.
struct BentMesh {
  const Sheet& sheet;
  PlasticMemory memory{0};
  Hinges hinges = find_hinges(sheet.triangles);
  double row = mean_edge(sheet.pattern, sheet.triangles);  // [m]
  std::vector<Eigen::Matrix2d>
      turn{};                  // |T| [m] curvature times area, plastic or that of the sheet
  std::vector<char> counts{};  // |T| whether a line may run through the triangle
  std::vector<std::optional<ColliderGap>> gap{};  // of each hinge; empty: colliders do not matter

  Vector2d corner(int t, int i) const { return sheet.pattern.row(sheet.triangles(t, i)); }
  Vector2d middle(int t) const { return (corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3; }
  double area(int t) const { return pattern_area(sheet, t); }
  /// [m] Plastic curvature times area.
  Eigen::Matrix2d plastic(int t) const {
    return area(t) * symmetric_matrix(memory.curvature.row(t));
  }
  /// Whether the turn of a hinge belongs to a fold.
  bool counts_hinge(std::size_t h) const { return gap.empty() || gap[h]; }
};

/// A mesh that folds where triangles have yielded.
BentMesh yielded_mesh(const Sheet& sheet, const PlasticMemory& memory) {
  BentMesh mesh{sheet, memory};
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    mesh.turn.push_back(mesh.plastic(t));
    mesh.counts.push_back(!memory.curvature.row(t).isZero(0));
  }
  return mesh;
}

/// A mesh that folds where it turns by 1 rad or more in a row of triangles, between colliders that
/// are `widest` [m] apart or less.
BentMesh pressed_mesh(const Sheet& sheet, const ColliderShapes& colliders, double widest) {
  constexpr double straight = 0.1;  // [rad] edges that turn less do not matter
  BentMesh mesh{sheet};
  const int triangles = static_cast<int>(sheet.triangles.rows());
  mesh.turn.assign(triangles, Eigen::Matrix2d::Zero());
  mesh.counts.assign(triangles, 0);
  for (const Hinge& hinge : mesh.hinges.hinges) {
    const int a = hinge.vertices[0], b = hinge.vertices[1];
    const double turn = dihedral_angle(sheet.x, hinge);
    mesh.gap.emplace_back();
    if (std::abs(turn) < straight) continue;
    mesh.gap.back() = gap_around(colliders, 0.5 * (sheet.x.row(a) + sheet.x.row(b)), widest);
    if (!mesh.gap.back()) continue;
    const Vector2d d = sheet.pattern.row(b) - sheet.pattern.row(a), n(-d.y(), d.x());
    for (const int t : hinge.triangles) mesh.turn[t] += 0.5 * turn / d.norm() * n * n.transpose();
  }
  for (int t = 0; t < triangles; ++t)
    mesh.counts[t] = mesh.turn[t].norm() * mesh.row > unresolved * mesh.area(t);
  return mesh;
}

/// The line about which triangles turn.
struct Axis {
  Vector2d middle{0, 0}, across;  // [m]; of length 1
  double share;                   // [1] of their turn that is about it
  Vector2d along() const { return {-across.y(), across.x()}; }
  double distance(const Vector2d& p) const { return std::abs(across.dot(p - middle)); }  // [m]
};

Axis axis_of(const BentMesh& mesh, const std::vector<int>& triangles) {
  Axis axis;
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  double total = 0;
  for (const int t : triangles) {
    const Eigen::Matrix2d& S = mesh.turn[t];
    sum += S;
    total += S.norm();
    axis.middle += S.norm() * mesh.middle(t);
  }
  axis.middle /= total;
  const SymmetricEigen<2> turn = symmetric_eigen(sum);
  const Vector2d size = turn.values.cwiseAbs();
  const int most = size[0] > size[1] ? 0 : 1;
  axis.across = turn.vectors.col(most);
  axis.share = size[most] / total;
  return axis;
}

/// The triangles that count within a row of the line.
std::vector<int> band_along(const BentMesh& mesh, const Axis& axis) {
  std::vector<int> band;
  for (int t = 0; t < mesh.sheet.triangles.rows(); ++t)
    if (mesh.counts[t] && axis.distance(mesh.middle(t)) < mesh.row) band.push_back(t);
  return band;
}

/// The part of the line on paper that its middle lies on.
std::optional<std::pair<Vector2d, Vector2d>> on_paper(const Pattern& pattern, const Axis& axis) {
  const Vector2d along = axis.along();
  constexpr double none = std::numeric_limits<double>::infinity();
  double before = -none, after = none;
  const auto cut = [&](const std::vector<Vector2d>& polygon) {
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vector2d p = polygon[i] - axis.middle,
                     q = polygon[(i + 1) % polygon.size()] - axis.middle;
      const double sp = cross(along, p), sq = cross(along, q);
      if ((sp > 0) == (sq > 0)) continue;
      const double at = along.dot(p + sp / (sp - sq) * (q - p));
      (at > 0 ? after : before) = at > 0 ? std::min(after, at) : std::max(before, at);
    }
  };
  cut(pattern.outline);
  for (const auto& hole : pattern.holes) cut(hole);
  if (before == -none || after == none) return std::nullopt;
  return std::pair{Vector2d(axis.middle + before * along), Vector2d(axis.middle + after * along)};
}

/// What happens across a line in parts of it that are two rows of triangles long.
struct Profile {
  // [rad] within a row and a half of the line; [1/m] mean with weights that fall to zero in a row;
  // [rad] plastic turn
  std::vector<double> turn, curvature, plastic;
};

/// Calls visit(point on the pattern [m], distance from the axis [rows], with its sign, turn about
/// the axis [m rad], number of the hinge) for points of the edges within `reach` rows of the axis.
template <class Visit>
void for_each_turn_within(double reach, const BentMesh& mesh, const Axis& axis, Visit visit) {
  constexpr int samples = 5;  // of an edge
  for (std::size_t h = 0; h < mesh.hinges.hinges.size(); ++h) {
    const Hinge& hinge = mesh.hinges.hinges[h];
    const Vector2d p = mesh.sheet.pattern.row(hinge.vertices[0]),
                   d = mesh.sheet.pattern.row(hinge.vertices[1]).transpose() - p;
    if (std::min(axis.distance(p), axis.distance(p + d)) > (reach + 1) * mesh.row) continue;
    const double turn =
        dihedral_angle(mesh.sheet.x, hinge) * std::pow(d.dot(axis.along()), 2) / d.norm() / samples;
    for (int i = 0; i < samples; ++i) {
      const Vector2d at = p + (i + 0.5) / samples * d;
      const double rows = axis.across.dot(at - axis.middle) / mesh.row;
      if (std::abs(rows) <= reach) visit(at, rows, turn, h);
    }
  }
}

/// The same within a row and a half, for the edges that belong to a fold.
template <class Visit>
void for_each_turn(const BentMesh& mesh, const Axis& axis, Visit visit) {
  for_each_turn_within(1.5, mesh, axis,
                       [&](const Vector2d& at, double rows, double turn, std::size_t h) {
                         if (mesh.counts_hinge(h)) visit(at, rows, turn, h);
                       });
}

/// Whether the sheet turns within three rows of triangles, and hardly in those beside them. A roll
/// or a loop that its mesh can show turns on and on.
bool is_localised(const BentMesh& mesh, const Axis& axis) {
  double near = 0, all = 0;
  for_each_turn_within(3, mesh, axis, [&](const Vector2d&, double rows, double turn, std::size_t) {
    all += turn;
    if (std::abs(rows) <= 1.5) near += turn;
  });
  return std::abs(all) <= (1 + most_beside) * std::abs(near);
}

/// Moves the axis to where the sheet turns most: the mean of the turn within a row and a half,
/// which counts less the farther away it is.
void centre(const BentMesh& mesh, Axis& axis) {
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

Profile profile_of(const BentMesh& mesh, const FoldLine& line, const Axis& axis) {
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
std::vector<double> needed_curvature(const BentMesh& mesh, const FoldLine& line, const Axis& axis,
                                     const std::vector<double>& turns) {
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
      part.bisector += turn * (b - a).cross(c - a).normalized();
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
std::optional<FoldLine> fold_on(const BentMesh& mesh, const Axis& axis, const Pattern& pattern,
                                double yield_curvature) {
  const auto ends = on_paper(pattern, axis);
  if (!ends || (ends->second - ends->first).norm() < 3 * mesh.row) return std::nullopt;
  FoldLine line{ends->first, ends->second, 0, band_along(mesh, axis)};
  const Profile profile = profile_of(mesh, line, axis);
  for (const double turn : profile.plastic) line.plastic_turn += turn / profile.plastic.size();
  const double bend = least(profile.curvature);
  if (least(profile.turn) < min_turn || bend * mesh.row < unresolved) return std::nullopt;
  const bool yields =
      mesh.gap.empty()
          ? bend >= least_bend * yield_curvature && least(profile.plastic) >= least_plastic
          : least(needed_curvature(mesh, line, axis, profile.turn)) >= yield_curvature;
  if (!yields || !is_localised(mesh, axis)) return std::nullopt;
  return line;
}

/// The axis about which the triangles turn that are beside a triangle; none: they turn in several
/// directions.
std::optional<Axis> axis_through(const BentMesh& mesh, int seed) {
  Axis axis = axis_of(mesh, {seed});
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
    const std::optional<Axis> axis = axis_through(mesh, seed);
    if (!axis) continue;
    const std::optional<FoldLine> line = fold_on(mesh, *axis, pattern, yield_curvature);
    if (!line || is_known(*line)) continue;
    Axis middle = *axis;
    centre(mesh, middle);
    const double ahead = axis->across.dot(middle.middle - axis->middle), more = margin * mesh.row;
    const double from = std::min(0.0, ahead) - more, to = std::max(0.0, ahead) + more;
    std::vector<FoldLine> lines;
    for (int k = 0; k < places; ++k) {
      Axis there = *axis;
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
  Axis axis;
  axis.across = across;
  axis.middle = 0.5 * (line.a + line.b) + off * across;
  const auto ends = on_paper(pattern, axis);
  if (!ends) return std::nullopt;
  return FoldLine{ends->first, ends->second, line.plastic_turn, line.band};
}

}  // namespace paperbake
