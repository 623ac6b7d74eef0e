#pragma once

#include "core/geometry/hinges.h"
#include "core/linear_algebra/column_cholesky.h"
#include "core/model/sheet.h"

#include <array>
#include <optional>
#include <vector>

namespace paperbake {

struct ShapeFitOptions {
  // [m] ell: waves shorter than about 4 ell are smoothed. A sixth of the simulated edges: with a
  // quarter shapes change (S8: c_m 0.05 -> 0.08 %), with a half they are rounded (0.26 %).
  double length = 0.002;
  double stretch = 300;  // [1] ks: weight of true lengths against position
  // [1] passes that take out stretch, one solve each: with 1, c_m is 0.051 % on S8 and S5, with 2
  // 0.045 %
  int steps = 2;
  // [1] over-relaxation of the last pass, because each falls short: with 1, c_m is a tenth larger
  double beyond = 1.5;
  // false: only prescribed creases have c = 1, and all other hinges have c = 0
  bool may_crease = true;
};

/// Makes a fine mesh smooth where paper is smooth, and gives it the lengths of the pattern, as near
/// as possible to where it is. Two least-squares problems, one after the other:
///
///   1.  min  sum_v a_v |x_v - y_v|^2
///            + ell^4 sum_h |K_h x - c_h K_h y - (1 - c_h) K_h S n|^2 / A_h
///   2.  min  sum_v a_v |d_v|^2  +  ell^4 sum_h |K_h d|^2 / A_h
///            + ks ell^2 sum_t A_t |F_t(x + d) - R_t|^2,   x += d,   repeated `steps` times
///
/// y    the given shape
/// a_v  area of a vertex;  A_t  of a triangle;  A_h  of the two triangles of a hinge
/// K    quadratic bending [Bergou 2006]: the cotangents of a hinge, zero for a flat shape
/// c    crease_share of the hinge in y, where there may be creases, or the least that is given for
///      it, where that is more: a sharp hinge keeps its bend, any other is to bend as the curvature
///      S says: K_h S n is K of the height -1/2 q^T S q over the plane with the normal n of the
///      hinge
/// F    gradient on the pattern
/// R    F (F^T F)^(-1/2) at x, the nearest map without stretch
///
/// The problems are separate because together they would hinder each other: a ripple is a field of
/// rotations R, and with R given, the stretch term defends it (ripples of 12 mm with ell 6 mm kept
/// 3/4 of their height). The second problem leaves smooth what is smooth. The matrices depend only
/// on the pattern and on which vertices are held, and are factored when those change.
/// source  [Bergou 2006] for K; otherwise this project
class ShapeFit {
 public:
  /// folds    prescribed creases: their hinges have c = 1, however small their angle
  /// creases  edges of which a least c may be given
  ShapeFit(const Points2& pattern, const Triangles&, const ShapeFitOptions&,
           const std::vector<PrescribedCrease>& folds = {},
           const std::vector<std::pair<int, int>>& creases = {});

  /// These vertices stay where they are given, from now on. Factors the matrices when they are
  /// others than before.
  void hold(const std::vector<int>& vertices);

  /// y          |V|x3 [m] the given shape
  /// curvature  |V|x3 [1/m] Sxx, Sxy, Syy, positive where the sheet bulges towards its normal
  /// least      least c of each edge that was given as a crease; empty: 0
  /// returns    |V|x3 [m] x
  /// May be called by several threads at the same time, after one of them has called hold().
  Points3 operator()(const Points3& y, const Points3& curvature,
                     const std::vector<double>& least = {}) const;

 private:
  struct Face {
    std::array<int, 3> v;
    // [1/m] gradients of the shape functions of the last two corners:
    // F = (x_1 - x_0) slope_1 + (x_2 - x_0) slope_2
    Vector2d slope[2];
    double weight;  // ks ell^2 A_t
  };
  struct Bend {
    std::array<double, 4> k;  // K
    Vector3d of_curvature;    // [m2] K of -1/2 (qx^2, 2 qx qy, qy^2)
    double weight;            // ell^4 / A_h
    bool sharp;
    int crease = -1;  // which of the edges that were given as creases it is; -1: none
  };
  void number(const std::vector<std::pair<int, int>>& creases);
  Points3 bend(const Points3& y, const Points3& curvature, const std::vector<double>& least) const;
  Points3 bend_pull(const Points3& y, const Points3& bend) const;
  void move(Points3& x, const Points3& pull, const ColumnCholesky&) const;
  Points3 stretch_pull(const Points3& x) const;

  ShapeFitOptions options_;
  Hinges hinges_;
  std::vector<Face> faces_;
  std::vector<Bend> bends_;
  std::vector<double> area_;                    // a_v
  Eigen::SparseMatrix<double> smooth_, stiff_;  // of all vertices, both triangular halves
  std::vector<int> free_;                       // vertices that are not held
  std::optional<std::vector<int>> held_;
  std::optional<ColumnCholesky> smooth_factor_, stiff_factor_;
};

}  // namespace paperbake
