#pragma once

#include "core/model/pattern.h"
#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

class Serializer;

/// Plastic state of the bending of each triangle of a mesh.
struct PlasticMemory {
  // |T|x3 [1/m] Sp: Sxx, Sxy, Syy; the curvature to which the triangle springs back
  Points3 curvature;
  // |T| [1/m] alpha: accumulated plastic curvature, whichever way the triangle was bent
  Eigen::VectorXd hardening;
  // |T| [1] s in [0, 1]: how much of a sharp ridge it was when it yielded (ridge_yield.h)
  Eigen::VectorXd ridge;

  PlasticMemory() = default;
  /// Of triangles that have never yielded.
  explicit PlasticMemory(int triangles)
      : curvature(Points3::Zero(triangles, 3)),
        hardening(Eigen::VectorXd::Zero(triangles)),
        ridge(Eigen::VectorXd::Zero(triangles)) {}
};

/// The plastic state of a sheet, in square cells on its pattern, 64 along the longer side. It
/// outlives every mesh.
///
/// A triangle reads the mean of its cells, and adds its plastic increment to all of them alike. So
/// differences between the cells of one triangle are kept, and nothing spreads when one mesh
/// follows another. It is plain data: a copy taken before a step that fails is enough to roll back.
class PlasticGrid {
 public:
  explicit PlasticGrid(const Pattern&);

  /// The cells of each triangle of a mesh: those whose centre lies in it; the nearest cell for a
  /// triangle that contains no centre.
  struct Cover {
    // |T|+1: the cells of triangle t are cell[first[t]] ... cell[first[t+1]-1]
    std::vector<int> first;
    std::vector<int> cell;
    // [1] fraction of its increment that the triangle writes to the cell: 1, less if triangles
    // share it
    std::vector<double> share;
  };
  Cover cover(const Points2& pattern, const Triangles&) const;

  PlasticMemory read(const Cover&) const;

  /// Plastic curvature at the vertices of a mesh: the mean over the triangles around each, weighted
  /// by area, as vertex_curvature (curvature.h) averages the measured curvature.
  /// returns  |V|x3 [1/m] Sxx, Sxy, Syy
  Points3 at_vertices(const Points2& pattern, const Triangles&) const;

  /// Adds the plastic increments of triangles to the state; of the ridges, the sharpest is kept.
  /// returns  [m rad] growth of integral()
  double write(const Cover&, const PlasticMemory& gained);

  /// True if nothing was ever written.
  bool is_virgin() const { return is_virgin_; }
  void reset();

  /// [m rad] Integral of |Sp| (Frobenius) over the pattern: length of creases x angle kept in them.
  double integral() const;

  void archive(Serializer&);  // what was written; the cells are those of the pattern

 private:
  struct Cell {
    Eigen::Vector4d memory = Eigen::Vector4d::Zero();  // [1/m] Sxx, Sxy, Syy, alpha
    double ridge = 0;                                  // [1] s
    bool inside = false;                               // its centre lies in the pattern
    // index of approximately the nearest cell that is inside; its own if it is inside
    int nearest = -1;
  };
  Vector2d centre(int column, int row) const { return size_ * Vector2d(column + 0.5, row + 0.5); }
  std::vector<int> centres_in(const Vector2d (&corner)[3]) const;

  double size_;  // [m] of a cell
  int columns_, rows_;
  double area_inside_;  // [m2] of the pattern per inside cell
  bool is_virgin_ = true;
  std::vector<Cell> cells_;  // row by row from (0, 0)
};

}  // namespace paperbake
