#pragma once

#include "core/model/pattern.h"
#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

class Serializer;

/// What the bending of each triangle remembers.
struct PlasticMemory {
  // |T|x3 [1/m] Sp: Sxx, Sxy, Syy; the curvature to which the triangle springs back
  Points3 curvature;
  // |T|   [1/m] alpha: plastic curvature added up along the way, there and back
  Eigen::VectorXd hardening;
  // |T|   [1]   s in [0, 1]: how much of a sharp ridge it was while it flowed
  // (step1_elastic/ridge_yield.h)
  Eigen::VectorXd ridge;

  PlasticMemory() = default;
  /// Of triangles to which nothing has happened.
  explicit PlasticMemory(int triangles)
      : curvature(Points3::Zero(triangles, 3)),
        hardening(Eigen::VectorXd::Zero(triangles)),
        ridge(Eigen::VectorXd::Zero(triangles)) {}
};

/// The plastic memory of a sheet: square cells on its pattern, 64 along the longer side, that
/// outlive every mesh.
///
/// A triangle reads the mean of its cells and writes what it gained to all of them alike. So what
/// lies between the cells of one triangle is kept, and nothing spreads when meshes follow one
/// another. Plain values: a copy taken before a step that fails is the way back.
class PlasticGrid {
 public:
  explicit PlasticGrid(const Pattern&);

  /// The cells of each triangle of a mesh: those with their centre in it; the nearest one for a
  /// triangle that has none.
  struct Cover {
    // |T|+1: the cells of triangle t are cell[first[t]] ... cell[first[t+1]-1]
    std::vector<int> first;
    std::vector<int> cell;
    // [1] of what the triangle writes to that cell: 1, less where triangles have to share it
    std::vector<double> share;
  };
  Cover cover(const Points2& pattern, const Triangles&) const;

  PlasticMemory read(const Cover&) const;

  /// What the vertices of a mesh remember: the mean over the triangles around them, weighted by
  /// area, as core/curvature averages what they show.
  /// returns  |V|x3 [1/m] Sxx, Sxy, Syy
  Points3 at_vertices(const Points2& pattern, const Triangles&) const;

  /// Adds to the memory what triangles gained; of what was a ridge, the most is kept.
  /// returns  by how much integral() grew [m rad]
  double write(const Cover&, const PlasticMemory& gained);

  /// Nothing was ever written.
  bool is_virgin() const { return is_virgin_; }
  void reset();

  /// Integral of |Sp| (Frobenius) over the pattern: length of crease x angle kept in it. [m rad]
  double integral() const;

  void archive(Serializer&);  // what was written; the cells are those of the pattern

 private:
  struct Cell {
    Eigen::Vector4d memory = Eigen::Vector4d::Zero();  // [1/m] Sxx, Sxy, Syy, alpha
    double ridge = 0;                                  // [1]   s
    bool inside = false;                               // its centre lies in the pattern
    // about the nearest cell that is inside; itself when it is
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
