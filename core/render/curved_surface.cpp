#include "core/render/curved_surface.h"

#include "core/geometry/curvature.h"
#include "core/geometry/hinges.h"
#include "core/geometry/measure.h"
#include "core/geometry/prescribed_creases.h"
#include "core/model/segment2.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace paperbake {
namespace {

/// Dihedral angles of a mesh, and the normal of the smooth sheet at every corner of every triangle.
struct Folded {
  Hinges hinges;
  std::vector<double> theta, share;  // of each hinge
  Points3 normals;                   // 3|T|x3
};

/// The triangle across the edge opposite corner i of t, and which of its corners is vertex v; {-1,
/// -1} at the border.
std::pair<int, int> across(const Sheet& sheet, const Hinges& hinges, int t, int i, int v) {
  const int h = hinges.of_triangle[t][i];
  if (h < 0) return {-1, -1};
  const auto& both = hinges.hinges[h].triangles;
  const int other = both[0] == t ? both[1] : both[0];
  for (int k = 0; k < 3; ++k)
    if (sheet.triangles(other, k) == v) return {other, k};
  return {-1, -1};
}

/// Normals at the corners: of the triangles around the vertex, weighted by their angles, and each
/// only as far as no crease lies between.
Points3 corner_normals(const Sheet& sheet, const Hinges& hinges, const std::vector<double>& share) {
  const int triangles = static_cast<int>(sheet.triangles.rows());
  Points3 weighted(3 * triangles, 3);  // normal x angle of each corner
  for (int t = 0; t < triangles; ++t) {
    const auto at = [&](int k) -> Vector3d { return sheet.x.row(sheet.triangles(t, k % 3)); };
    const Vector3d n = (at(1) - at(0)).cross(at(2) - at(0)).stableNormalized();
    for (int i = 0; i < 3; ++i) {
      const Vector3d u = at(i + 1) - at(i), v = at(i + 2) - at(i);
      weighted.row(3 * t + i) = angle_between(u, v) * n;
    }
  }
  Points3 normals(3 * triangles, 3);
  // corners at the vertex, and [1] how free of creases the path to each of them is
  std::vector<std::pair<int, double>> around;
  for (int t = 0; t < triangles; ++t)
    for (int i = 0; i < 3; ++i) {
      const int v = sheet.triangles(t, i);
      around.assign(1, {3 * t + i, 1.0});
      for (const int turn : {1, 2}) {  // around the vertex in both directions
        double open = 1;
        std::pair<int, int> at{t, i};
        while (open > 1e-3) {
          const int edge = (at.second + turn) % 3, h = hinges.of_triangle[at.first][edge];
          at = across(sheet, hinges, at.first, edge, v);
          if (at.first < 0 || at.first == t) break;
          open *= 1 - share[h];
          const int corner = 3 * at.first + at.second;
          const auto known = std::find_if(around.begin(), around.end(), [&](const auto& reached) {
            return reached.first == corner;
          });
          if (known == around.end())
            around.emplace_back(corner, open);
          else
            known->second = std::max(known->second, open);
        }
      }
      Vector3d sum = Vector3d::Zero();
      for (const auto& [corner, open] : around) sum += open * weighted.row(corner).transpose();
      const double length = sum.norm();
      normals.row(3 * t + i) = length > 1e-12 ? Eigen::RowVector3d(sum.transpose() / length)
                                              : Eigen::RowVector3d::UnitZ();
    }
  return normals;
}

Folded look(const Sheet& sheet) {
  std::map<std::pair<int, int>, double> remembered;  // share, by the vertices in order
  for (const RememberedCrease& crease : sheet.remembered)
    remembered[std::minmax(crease.a, crease.b)] = crease.share;
  Folded folded;
  folded.hinges = find_hinges(sheet.triangles);
  for (const Hinge& hinge : folded.hinges.hinges) {
    const auto [v, w] = std::minmax(hinge.vertices[0], hinge.vertices[1]);
    folded.theta.push_back(dihedral_angle(sheet.x, hinge));
    folded.share.push_back(is_folded(sheet, v, w) ? 1 : crease_share(folded.theta.back()));
    if (const auto before = remembered.find({v, w}); before != remembered.end())
      folded.share.back() = std::max(folded.share.back(), before->second);
  }
  folded.normals = corner_normals(sheet, folded.hinges, folded.share);
  return folded;
}

// [rad] along an edge: what turns more is a crease, or the error of a needle
constexpr double max_turn = 0.8;

/// The nearest tensors that bend in one direction only, and by no more than that along the edges of
/// their vertex.
Points3 developable(const Sheet& sheet, const Points3& tensors) {
  std::vector<Principal> principal;
  for (int v = 0; v < tensors.rows(); ++v) principal.push_back(principal_curvature(tensors.row(v)));
  // of each vertex: sum of the lengths of its edges across its ruling; number of these edges
  Eigen::VectorXd reach = Eigen::VectorXd::Zero(tensors.rows()), edges = reach;
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i)
      for (const int k : {1, 2}) {
        const int v = sheet.triangles(t, i);
        reach[v] +=
            std::abs((sheet.pattern.row(sheet.triangles(t, (i + k) % 3)) - sheet.pattern.row(v))
                         .dot(principal[v].across));
        edges[v] += 1;
      }
  Points3 result(tensors.rows(), 3);
  for (int v = 0; v < tensors.rows(); ++v) {
    const Vector2d& n = principal[v].across;
    const double most = max_turn * edges[v] / std::max(reach[v], 1e-12);
    result.row(v) = std::clamp(principal[v].k1, -most, most) *
                    Eigen::RowVector3d(n.x() * n.x(), n.x() * n.y(), n.y() * n.y());
  }
  return result;
}

}  // namespace

double crease_share(double theta) {
  const double t =
      std::clamp((std::abs(theta) - crease_begins) / (whole_crease - crease_begins), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

Vector3d CurvedSurface::at(const MeshPoint& place) const {
  Vector3d x = Vector3d::Zero();
  const Vector3d& b = place.weights;
  for (int i = 0; i < 3; ++i) {
    x += b[i] * corners.row(triangles(place.triangle, i)).transpose();
    x += b[(i + 1) % 3] * b[(i + 2) % 3] * bulge.row(3 * place.triangle + i).transpose();
  }
  return x;
}

CurvedSurface curve(const Sheet& sheet, const std::vector<int>& exact) {
  const Folded folded = look(sheet);
  std::vector<double> turns(folded.theta.size());
  for (std::size_t h = 0; h < turns.size(); ++h) turns[h] = (1 - folded.share[h]) * folded.theta[h];
  const Points3 curvature =
      developable(sheet, vertex_curvature(sheet.pattern, sheet.triangles, folded.hinges, turns));

  CurvedSurface surface{sheet.triangles, sheet.x, Points3::Zero(3 * sheet.triangles.rows(), 3),
                        curvature};
  for (int t = 0; t < sheet.triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i) {
      const int h = folded.hinges.of_triangle[t][i];
      // done from its other side
      if (h >= 0 && folded.hinges.hinges[h].triangles[0] != t) continue;
      const int j = (i + 1) % 3, k = (i + 2) % 3, a = sheet.triangles(t, j),
                b = sheet.triangles(t, k);
      const Vector2d e = sheet.pattern.row(b) - sheet.pattern.row(a);
      const Vector3d s = 0.5 * (curvature.row(a) + curvature.row(b));
      const Vector3d n = (folded.normals.row(3 * t + j) + folded.normals.row(3 * t + k))
                             .transpose()
                             .stableNormalized();
      const double open = h < 0 ? 1 : 1 - folded.share[h];
      const double turn =
          (s[0] * e.x() * e.x() + 2 * s[1] * e.x() * e.y() + s[2] * e.y() * e.y()) / e.norm();
      const Vector3d d = 0.5 * open * std::clamp(turn, -max_turn, max_turn) * e.norm() * n;
      surface.bulge.row(3 * t + i) = d;
      if (h < 0) continue;
      const int other = folded.hinges.hinges[h].triangles[1];
      for (int m = 0; m < 3; ++m)
        if (folded.hinges.of_triangle[other][m] == h) surface.bulge.row(3 * other + m) = d;
    }

  // on average a patch rises over its triangle by 1/12 of the sum of its bulges
  Points3 out = Points3::Zero(sheet.x.rows(), 3);
  Eigen::VectorXd area = Eigen::VectorXd::Zero(sheet.x.rows()),
                  open = Eigen::VectorXd::Ones(sheet.x.rows());
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    const Vector2d u =
        sheet.pattern.row(sheet.triangles(t, 1)) - sheet.pattern.row(sheet.triangles(t, 0));
    const Vector2d v =
        sheet.pattern.row(sheet.triangles(t, 2)) - sheet.pattern.row(sheet.triangles(t, 0));
    const double a = cross(u, v);
    for (int i = 0; i < 3; ++i) {
      out.row(sheet.triangles(t, i)) += a / 12 * surface.bulge.middleRows<3>(3 * t).colwise().sum();
      area[sheet.triangles(t, i)] += a;
    }
  }
  for (std::size_t h = 0; h < folded.share.size(); ++h)
    for (int k = 0; k < 2; ++k) {
      double& o = open[folded.hinges.hinges[h].vertices[k]];
      o = std::min(o, 1 - folded.share[h]);
    }
  for (const int v : exact) open[v] = 0;
  for (int v = 0; v < out.rows(); ++v)
    if (area[v] > 0) surface.corners.row(v) -= 0.5 * open[v] / area[v] * out.row(v);
  return surface;
}

}  // namespace paperbake
