#pragma once

#include <Eigen/Core>

namespace paperbake {

/// The matrix with the entries xx, xy = yx, and yy.
inline Eigen::Matrix2d symmetric_matrix(const Eigen::RowVector3d& entries) {
  Eigen::Matrix2d m;
  m << entries[0], entries[1], entries[1], entries[2];
  return m;
}

/// Eigenvalues and eigenvectors of a symmetric matrix, M = sum_i values_i v_i v_i^T.
template <int n>
struct SymmetricEigen {
  Eigen::Matrix<double, n, 1> values;   // rising
  Eigen::Matrix<double, n, n> vectors;  // [1] v_i is column i, of unit length
};

/// The lower triangle of M is read. Implicit QR steps, to rounding.
SymmetricEigen<2> symmetric_eigen(const Eigen::Matrix2d& M);
SymmetricEigen<3> symmetric_eigen(const Eigen::Matrix3d& M);

}  // namespace paperbake
