#pragma once

#include "core/linear_algebra/block_cholesky.h"
#include "core/model/local_energies.h"
#include "core/model/plastic_grid.h"
#include "core/step1_elastic/energies/bending.h"
#include "core/step1_elastic/energies/crease_law.h"
#include "core/step1_elastic/energies/membrane.h"
#include "core/step1_elastic/energies/ridge_yield.h"

#include <array>
#include <utility>
#include <vector>

namespace paperbake {

using MembraneStress = std::vector<Eigen::Matrix2d>;  // [N/m] per triangle, second Piola-Kirchhoff

/// Membrane + bending energy of a whole mesh. Everything that depends on the pattern alone is
/// computed once.
class ElasticEnergy {
 public:
  /// stiffening  |T| factors on the bending stiffness; empty: 1 everywhere
  /// creases     where they are folded they are hinges with a law of their own (crease_law.h): no
  ///             bending moment of the plate crosses them, as none crosses a border
  ElasticEnergy(const Paper&, const Points2& pattern, const Triangles&,
                const std::vector<double>& stiffening = {},
                const std::vector<PrescribedCrease>& creases = {});

  /// [J] Energy at x.
  double energy(const Points3& x) const;

  /// [J] The two parts of the energy; bending includes the creases.
  struct Parts {
    double membrane, bending;
  };
  Parts parts(const Points3& x) const { return parts(x, dihedral_angles(x)); }
  Parts parts(const Points3& x, const std::vector<double>& dihedral_angles) const;

  /// The energies of the triangles at x and the configurational forces on the vertices. The plastic
  /// state, the ridges and the factors on the stiffness are those of the triangles as they are.
  /// source  [Eshelby 1975] for the membrane, whose energy-momentum tensor is w I - F^T F S; the
  ///         bending part is the derivative of RestBending
  LocalEnergies local_energies(const Points3& x) const;

  /// [J] Energy at x; gradient |V|x3 [N] is overwritten.
  double gradient(const Points3& x, Points3& gradient) const;

  /// Pairs of vertices that share a non-zero block of the Hessian.
  std::vector<std::pair<int, int>> coupled_vertices() const;

  /// Remembers where the blocks of `matrix` lie. block_of[v]: block row of vertex v, -1 if it is
  /// constrained.
  void bind(const BlockCholesky& matrix, const std::vector<int>& block_of);
  /// The same as gradient(), and adds the Hessian [N/m] to the bound matrix.
  /// stress  |T| [N/m] the membrane stress that the Hessian is to contain; null: the stress at x
  double hessian(const Points3& x, HessianForm, Points3& gradient, BlockCholesky& matrix,
                 const MembraneStress* stress = nullptr) const;

  /// |T| [N/m] Membrane stress at x + move, to first order in move.
  MembraneStress stress(const Points3& x, const Points3& move) const;

  /// Plastic state of the triangles. Empty in the beginning: paper that always springs back.
  PlasticMemory memory;
  /// Ridges within the triangles; empty: they bend evenly.
  RidgeField ridges;

  bool has_creases() const { return !creases_.empty(); }
  /// For each hinge, whether the sheet is folded along it; empty: there are no creases.
  std::vector<bool> folded_hinges() const;
  /// [rad] For each hinge, the angle to which hands press it, or 0; not empty.
  std::vector<double> pressed_hinges() const;

  /// Reads the state of the creases from the sheet.
  /// returns  the triangles beside edges that are folded now and were not before
  std::vector<int> load_creases(const Sheet&);
  /// Lets hands press creases only a share of the way from their angles at x to those of the sheet.
  void press(const Points3& x, double share);
  /// State of the creases if the sheet is left with these dihedral angles. An edge folds where it
  /// bends the paper beyond its first yield.
  std::vector<CreaseEdge> creases_left(const std::vector<double>& dihedral_angles) const;

  /// Plastic increment of the triangles if the sheet is left at x, or with these dihedral angles.
  PlasticMemory gained(const Points3& x) const { return gained(dihedral_angles(x)); }
  PlasticMemory gained(const std::vector<double>& dihedral_angles) const;

  /// [rad] Dihedral angle of each hinge.
  std::vector<double> dihedral_angles(const Points3& x) const {
    return paperbake::dihedral_angles(x, hinges_.hinges);
  }

  const Hinges& hinges() const { return hinges_; }

 private:
  struct Stencil {  // a triangle and the wings across its edges
    // corners 0-2, wings 3-5 (wing 3+i is across the edge opposite corner i); -1: border
    std::array<int, 6> vertices;
    std::array<BlockCholesky::Slot, 21> slots;  // upper half, row by row
  };
  struct CreaseHinge {
    int hinge;
    PrescribedCrease crease;
    CreaseEdge edge;
    double length;  // [m]
    double goal;    // [rad] that hands press it to, if they do
    double width;   // [m] of the paper that its angle is spread over while it is not folded
  };
  double evaluate(const Points3& x, HessianForm, Points3* gradient, BlockCholesky* matrix,
                  const MembraneStress* stress = nullptr) const;
  struct Element {            // a triangle, for the Hessian
    const Matrix3d& corners;  // [m]
    Matrix9& own;             // [N/m] what its corners alone contribute
    const Matrix3d& tangent;  // [J] d2E/dtheta2 of its bending
    const Vector3d& moments;  // [J] on its angles, from both sides
  };
  /// Adds the contribution of triangle t to the matrix: its own, and its bending over the whole
  /// stencil.
  void add_element(int t, const Element&, const std::vector<DihedralAngle>&, HessianForm,
                   BlockCholesky&) const;
  Matrix3d corners(const Points3& x, int t) const;
  // [rad] dihedral angles at the three edges of a triangle; 0 at the border
  Vector3d angles_of(int t, const std::vector<double>& dihedral_angles) const;
  PlasticState past(int t) const;
  /// Adds the folded creases at a triangle to its bending: half of each hinge; the other half goes
  /// to the other triangle.
  double add_creases(int t, const Vector3d& angles, Vector3d* moment = nullptr,
                     Matrix3d* tangent = nullptr) const;
  CreaseResponse response_of(const CreaseHinge&, double theta) const;
  /// Area on the pattern of the triangles on both sides of a hinge. [m2]
  double area_beside(const Hinge& hinge) const {
    return rest_[hinge.triangles[0]].area + rest_[hinge.triangles[1]].area;
  }
  /// True if the hinge is an edge along which the sheet is folded.
  bool is_folded(int hinge) const;
  /// Adds the part of the bending of triangle t to the configurational forces that comes from the
  /// lengths and directions of its edges.
  /// by_area  |T| [J/m2] receives the derivatives with respect to the areas of triangles
  void add_configurational_bending(int t, const Vector3d& angles, Points2& force,
                                   Eigen::VectorXd& by_area) const;
  RestBending rest_of_bending(int t) const;

  Paper paper_;
  Points2 pattern_;
  std::vector<double> stiffening_;
  Triangles triangles_;
  Hinges hinges_;
  std::vector<RestTriangle> rest_;
  std::vector<RestBending> bend_;
  std::vector<Stencil> stencils_;
  std::vector<CreaseHinge> creases_;
  std::vector<int> crease_of_hinge_;  // index into creases_, -1: none; empty: there are no creases
  CreaseLaw law_;
};

}  // namespace paperbake
