#pragma once

#include "core/column_cholesky.h"
#include "core/hinges.h"
#include "core/sheet.h"

#include <array>
#include <optional>
#include <vector>

namespace paperbake {

struct LocalGlobalOptions {
  double length = 0.004;  // [m] ell: waves shorter than about this are smoothed; a third of the edges that were simulated
  double stretch = 50;    // [1] ks: how much true lengths count against the place
  int steps = 2;          // [1] one solve each
};

/// Makes the shape of a fine mesh smooth where paper is smooth, and its lengths those of the pattern, near where it is:
///
///   min  sum_v a_v |x_v - y_v|^2  +  ell^4 sum_h |K_h x - c_h K_h y|^2 / A_h  +  ks ell^2 sum_t A_t |F_t - R_t|^2
///
/// y  the shape that is given;  a_v  area of a vertex;  A_t  of a triangle;  A_h  of the two triangles of a hinge
/// K  quadratic bending [Bergou 2006]: the cotangents of a hinge, zero for what is flat
/// c  crease_share of the hinge in y: what is sharp keeps its bend, what is not shall lose it
/// F  gradient of x on the pattern;  R  = F (F^T F)^(-1/2), the nearest without stretch: found before each solve
///
/// The matrix depends on the pattern and on which vertices are held only, and is factored when those change.
/// source  algorithm E2.3
class LocalGlobal {
 public:
  LocalGlobal(const Points2& pattern, const Triangles&, const LocalGlobalOptions&);

  /// The vertices that stay where they are given, from now on; factors when they are others than before.
  void hold(const std::vector<int>& vertices);

  /// y -> x. |V|x3 [m]. Several threads may ask at the same time, after one has called hold().
  Points3 operator()(const Points3& y) const;

 private:
  struct Face {
    std::array<int, 3> v;
    Eigen::Matrix<double, 3, 2> slope;  // [1/m] gradients of the shape functions: F = sum_i x_i slope_i
    double weight;                      // ks ell^2 A_t
  };
  struct Bend {
    std::array<double, 4> k;            // K
    double weight;                      // ell^4 / A_h
  };
  Points3 residual(const Points3& x, const Points3& y, const Points3& bend) const;

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
