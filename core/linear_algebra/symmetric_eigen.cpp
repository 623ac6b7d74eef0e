#include "core/linear_algebra/symmetric_eigen.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace paperbake {

SymmetricEigen<2> symmetric_eigen(const Eigen::Matrix2d& M) {
  // The solver's compute() first makes a matrix tridiagonal. This one is so already, and the
  // templates that would find nothing to do take ten seconds to compile.
  double scale = std::max({std::abs(M(0, 0)), std::abs(M(1, 0)), std::abs(M(1, 1))});
  if (scale == 0) scale = 1;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver;
  solver.computeFromTridiagonal(M.diagonal() / scale, Eigen::Matrix<double, 1, 1>(M(1, 0) / scale));
  return {solver.eigenvalues() * scale, solver.eigenvectors()};
}

SymmetricEigen<3> symmetric_eigen(const Eigen::Matrix3d& M) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(M);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace paperbake
