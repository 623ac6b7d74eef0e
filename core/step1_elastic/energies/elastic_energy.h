#pragma once

#include "core/linear_algebra/block_cholesky.h"
#include "core/model/plastic_grid.h"
#include "core/step1_elastic/energies/bending.h"
#include "core/step1_elastic/energies/membrane.h"
#include "core/step1_elastic/energies/ridge_yield.h"

#include <array>
#include <utility>
#include <vector>

namespace paperbake {

using MembraneStress = std::vector<Eigen::Matrix2d>;  // by triangle, second Piola-Kirchhoff [N/m]

/// Membrane + bending energy of a whole mesh, with everything that depends on the pattern alone
/// computed once.
class ElasticEnergy {
 public:
  /// stiffening  |T| factors on the bending stiffness; empty: 1 everywhere
  /// folds       lines whose hinges turn by themselves (prescribed_creases.h): no moment of the
  ///             paper crosses them, as none crosses a border
  ElasticEnergy(const Paper&, const Points2& pattern, const Triangles&,
                const std::vector<double>& stiffening = {},
                const std::vector<PrescribedCrease>& folds = {});

  /// Energy at x. [J]
  double energy(const Points3& x) const;

  /// The two parts of it. [J]
  struct Parts {
    double membrane, bending;
  };
  Parts parts(const Points3& x) const { return parts(x, dihedral_angles(x)); }
  Parts parts(const Points3& x, const std::vector<double>& dihedral_angles) const;

  /// Energy at x [J]; gradient |V|x3 [N] is overwritten.
  double gradient(const Points3& x, Points3& gradient) const;

  /// Pairs of vertices that share a non-zero block of the second derivative.
  std::vector<std::pair<int, int>> coupled_vertices() const;

  /// Remembers where the blocks of `matrix` lie. block_of[v]: block row of vertex v, -1 when it is
  /// held.
  void bind(const BlockCholesky& matrix, const std::vector<int>& block_of);
  /// gradient() that also adds the second derivative [N/m] to the bound matrix.
  /// stress  |T| what it takes for the stress of the membrane [N/m]; null: the stress at x
  double hessian(const Points3& x, HessianForm, Points3& gradient, BlockCholesky& matrix,
                 const MembraneStress* stress = nullptr) const;

  /// Stress of the membrane at x + move, to first order in move. |T| [N/m]
  MembraneStress stress(const Points3& x, const Points3& move) const;

  /// What the triangles remember. Empty at first: paper that springs back whatever is done to it.
  PlasticMemory memory;
  /// How sharply they bend within; empty: evenly.
  RidgeField ridges;

  /// What they gain when the sheet is left at x, or with these folds.
  PlasticMemory gained(const Points3& x) const { return gained(dihedral_angles(x)); }
  PlasticMemory gained(const std::vector<double>& dihedral_angles) const;

  /// [rad] of each hinge.
  std::vector<double> dihedral_angles(const Points3& x) const {
    return paperbake::dihedral_angles(x, hinges_.hinges);
  }

  const Hinges& hinges() const { return hinges_; }

 private:
  struct Stencil {  // a triangle and the wings across its edges
    // corners 0-2, wings 3-5 (wing 3+i across the edge opposite corner i), -1: border
    std::array<int, 6> vertices;
    std::array<BlockCholesky::Slot, 21> slots;  // upper half, row by row
  };
  double evaluate(const Points3& x, HessianForm, Points3* gradient, BlockCholesky* matrix,
                  const MembraneStress* stress = nullptr) const;
  /// Adds to the matrix what triangle t contributes: `own`, of its corners alone, and its bending
  /// over the whole stencil.
  /// tangent  d2E/dtheta2 of its bending; edge_moment: what its angles feel from both sides
  void add_element(int t, const Matrix3& corners, Matrix9& own, const std::vector<DihedralAngle>&,
                   const Matrix3& tangent, const Vector3d& edge_moment, HessianForm,
                   BlockCholesky&) const;
  Matrix3 corners(const Points3& x, int t) const;
  // at the three edges of a triangle; 0 at the border
  Vector3d angles_of(int t, const std::vector<double>& dihedral_angles) const;
  PlasticState past(int t) const;
  /// What the folded lines at a triangle add to its bending: half of each hinge's, the other
  /// triangle has the rest.
  double add_folds(int t, const Vector3d& angles, Vector3d* moment = nullptr,
                   Matrix3* tangent = nullptr) const;

  Paper paper_;
  Triangles triangles_;
  Hinges hinges_;
  std::vector<RestTriangle> rest_;
  std::vector<RestBending> bend_;
  std::vector<Stencil> stencils_;
  struct CreaseSpring {
    double stiffness = 0, angle = 0;  // [J] k l, 0: no line; [rad]
  };
  std::vector<CreaseSpring> springs_;  // of each hinge; empty: there are no lines
};

}  // namespace paperbake
