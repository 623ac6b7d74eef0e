#pragma once

#include "core/column_cholesky.h"
#include "core/hinges.h"
#include "core/sheet.h"

#include <array>
#include <optional>
#include <vector>

namespace paperbake {

struct LocalGlobalOptions {
  double length = 0.004;  // [m] ell: waves shorter than about this are smoothed; half of the edges that were simulated
  double stretch = 50;    // [1] ks: how much true lengths count against the place
  int steps = 2;          // [1] one solve each
};

/// Makes the shape of a fine mesh smooth where paper is smooth, and its lengths those of the pattern, near where it is:
///
///   min  sum_v a_v |x_v - y_v|^2  +  ell^4 sum_h |K_h x - c_h K_h y - (1 - c_h) K_h S n|^2 / A_h  +  ks ell^2 sum_t A_t |F_t - R_t|^2
///
/// y  the shape that is given;  a_v  area of a vertex;  A_t  of a triangle;  A_h  of the two triangles of a hinge
/// K  quadratic bending [Bergou 2006]: the cotangents of a hinge, zero for what is flat
/// c  crease_share of the hinge in y: what is sharp keeps its bend, what is not shall bend as the curvature S says:
///    K_h S n is K of the height -1/2 q^T S q over the plane with the hinge's normal n
/// F  gradient of x on the pattern;  R  = F (F^T F)^(-1/2), the nearest without stretch: found before each solve
///
/// The first step solves this. Those that follow begin anew with place and bend where the step before left them, so that all
/// they do is to take out stretch, smoothly; asked for all three again they would trade lengths for the bend that was given.
///
/// The matrix depends on the pattern and on which vertices are held only, and is factored when those change.
/// source  algorithm E2.3; the curvature as the aim of K (c_m 0.031 -> 0.021 % on S1, and ell may grow) and the later steps
///         (0.027 -> 0.020) are this project's
class LocalGlobal {
 public:
  LocalGlobal(const Points2& pattern, const Triangles&, const LocalGlobalOptions&);

  /// The vertices that stay where they are given, from now on; factors when they are others than before.
  void hold(const std::vector<int>& vertices);

  /// y -> x. |V|x3 [m]. curvature  |V|x3 [1/m] Sxx, Sxy, Syy, positive where the sheet bulges to its normal. Several threads may ask at the same time, after one has called hold().
  Points3 operator()(const Points3& y, const Points3& curvature) const;

 private:
  struct Face {
    std::array<int, 3> v;
    Eigen::Matrix<double, 3, 2> slope;  // [1/m] gradients of the shape functions: F = sum_i x_i slope_i
    double weight;                      // ks ell^2 A_t
  };
  struct Bend {
    std::array<double, 4> k;            // K
    Vector3d of_curvature;              // [m2] K of -1/2 (qx^2, 2 qx qy, qy^2)
    double weight;                      // ell^4 / A_h
  };
  Points3 bend(const Points3& y, const Points3& curvature) const;
  Points3 first_pull(const Points3& y, const Points3& bend) const;
  Points3 stretch_pull(const Points3& x) const;

  LocalGlobalOptions options_;
  Hinges hinges_;
  std::vector<Face> faces_;
  std::vector<Bend> bends_;
  std::vector<double> area_;            // a_v
  Eigen::SparseMatrix<double> matrix_;  // of all vertices, both triangles
  std::vector<int> free_;               // vertices that are not held
  std::optional<std::vector<int>> held_;
  std::optional<ColumnCholesky> factor_;
};

}  // namespace paperbake
