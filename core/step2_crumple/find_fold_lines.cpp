#include "core/step2_crumple/find_fold_lines.h"

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
// how many places a fold is tried in, and how far beyond where it may be [rows]
constexpr int places = 7;
constexpr double margin = 0.1;
constexpr double least_plastic = 1 * M_PI / 180;  // turn that stays, in each part of the line

/// A mesh with what has yielded of it.
struct YieldedMesh {
  const Sheet& sheet;
  const PlasticMemory& memory;
  Hinges hinges = find_hinges(sheet.triangles);
  double row = mean_edge(sheet.pattern, sheet.triangles);  // [m]

  Vector2d corner(int t, int i) const { return sheet.pattern.row(sheet.triangles(t, i)); }
  Vector2d middle(int t) const { return (corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3; }
  bool yielded(int t) const { return !memory.curvature.row(t).isZero(0); }
  /// [m] Plastic curvature times area.
  Eigen::Matrix2d plastic(int t) const {
    const Eigen::RowVector3d s = memory.curvature.row(t);
    const double area = 0.5 * cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0));
    Eigen::Matrix2d S;
    S << s[0], s[1], s[1], s[2];
    return area * S;
  }
};

/// The line about which triangles have yielded.
struct Axis {
  Vector2d middle{0, 0}, across;  // [m]; of length 1
  double share;                   // [1] of the plastic turn that is about it
  Vector2d along() const { return {-across.y(), across.x()}; }
  double distance(const Vector2d& p) const { return std::abs(across.dot(p - middle)); }  // [m]
};

Axis axis_of(const YieldedMesh& mesh, const std::vector<int>& triangles) {
  Axis axis;
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  double total = 0;
  for (const int t : triangles) {
    const Eigen::Matrix2d S = mesh.plastic(t);
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

/// The triangles that have yielded within a row of the line.
std::vector<int> band_along(const YieldedMesh& mesh, const Axis& axis) {
  std::vector<int> band;
  for (int t = 0; t < mesh.sheet.triangles.rows(); ++t)
    if (mesh.yielded(t) && axis.distance(mesh.middle(t)) < mesh.row) band.push_back(t);
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
/// the axis [m rad]) for points of the edges within a row and a half of the axis.
template <class Visit>
void for_each_turn(const YieldedMesh& mesh, const Axis& axis, Visit visit) {
  constexpr int samples = 5;  // of an edge
  for (const Hinge& hinge : mesh.hinges.hinges) {
    const Vector2d p = mesh.sheet.pattern.row(hinge.vertices[0]),
                   d = mesh.sheet.pattern.row(hinge.vertices[1]).transpose() - p;
    if (std::min(axis.distance(p), axis.distance(p + d)) > 2.5 * mesh.row) continue;
    const double turn =
        dihedral_angle(mesh.sheet.x, hinge) * std::pow(d.dot(axis.along()), 2) / d.norm() / samples;
    for (int i = 0; i < samples; ++i) {
      const Vector2d at = p + (i + 0.5) / samples * d;
      const double rows = axis.across.dot(at - axis.middle) / mesh.row;
      if (std::abs(rows) <= 1.5) visit(at, rows, turn);
    }
  }
}

/// Moves the axis to where the sheet turns most: the mean of the turn within a row and a half,
/// which counts less the farther away it is.
void centre(const YieldedMesh& mesh, Axis& axis) {
  for (int again = 0; again < 8; ++again) {
    double sum = 0, moment = 0;
    for_each_turn(mesh, axis, [&](const Vector2d&, double rows, double turn) {
      const double weight = 1.5 - std::abs(rows);
      sum += weight * turn;
      moment += weight * turn * rows;
    });
    if (!(std::abs(moment) < 0.5 * std::abs(sum))) return;
    axis.middle += moment / sum * mesh.row * axis.across;
  }
}

Profile profile_of(const YieldedMesh& mesh, const FoldLine& line, const Axis& axis) {
  const double length = (line.b - line.a).norm();
  const int parts = std::max(2, static_cast<int>(std::lround(length / (2 * mesh.row))));
  const Vector2d along = (line.b - line.a) / length;
  const auto part_of = [&](const Vector2d& p) {
    return std::clamp(static_cast<int>((p - line.a).dot(along) / length * parts), 0, parts - 1);
  };
  const std::vector<double> zero(parts, 0.0);
  Profile profile{zero, zero, zero};
  for_each_turn(mesh, axis, [&](const Vector2d& at, double rows, double turn) {
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

/// The smallest value when all have the sign of the first; else 0.
double least(const std::vector<double>& values) {
  double least = std::numeric_limits<double>::infinity();
  for (const double value : values) least = std::min(least, values.front() > 0 ? value : -value);
  return std::max(0.0, least);
}

/// The line along an axis, if the sheet is being folded there.
std::optional<FoldLine> fold_on(const YieldedMesh& mesh, const Axis& axis, const Pattern& pattern,
                                double yield_curvature) {
  const auto ends = on_paper(pattern, axis);
  if (!ends || (ends->second - ends->first).norm() < 3 * mesh.row) return std::nullopt;
  FoldLine line{ends->first, ends->second, 0, band_along(mesh, axis)};
  const Profile is = profile_of(mesh, line, axis);
  for (const double turn : is.plastic) line.plastic_turn += turn / is.plastic.size();
  const double bend = least(is.curvature);
  if (least(is.turn) < min_turn || bend * mesh.row < unresolved ||
      bend < least_bend * yield_curvature || least(is.plastic) < least_plastic)
    return std::nullopt;
  return line;
}

/// The axis about which the triangles have yielded that are beside a triangle; none: they have in
/// several directions.
std::optional<Axis> axis_through(const YieldedMesh& mesh, int seed) {
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

}  // namespace

std::vector<FoldLine> find_fold_lines(const Sheet& sheet, const PlasticMemory& memory,
                                      const Pattern& pattern, double yield_curvature) {
  const YieldedMesh mesh{sheet, memory};
  std::vector<int> seeds;
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    if (mesh.yielded(t)) seeds.push_back(t);
  std::stable_sort(seeds.begin(), seeds.end(),
                   [&](int s, int t) { return mesh.plastic(s).norm() > mesh.plastic(t).norm(); });
  const auto is_known = [&](const FoldLine& line) {
    return std::any_of(
        sheet.prescribed_creases.begin(), sheet.prescribed_creases.end(),
        [&](const PrescribedCrease& known) { return lies_on(line, known, 2 * mesh.row); });
  };
  for (const int seed : seeds) {
    const std::optional<Axis> axis = axis_through(mesh, seed);
    if (!axis) continue;
    const std::optional<FoldLine> line = fold_on(mesh, *axis, pattern, yield_curvature);
    if (!line || is_known(*line)) continue;
    Axis middle = *axis;
    centre(mesh, middle);
    const double way = axis->across.dot(middle.middle - axis->middle), more = margin * mesh.row;
    const double from = std::min(0.0, way) - more, to = std::max(0.0, way) + more;
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

}  // namespace paperbake
