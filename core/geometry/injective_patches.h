#pragma once

#include "core/model/sheet.h"

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

namespace paperbake {

/// Proves of parts of a sheet that they do not intersect themselves, from how evenly they are
/// deformed. A part R of the pattern is convex, and the gradient F of the shape is near one matrix
/// B in all of it. Then for any two points of R, with d the way between them on the pattern,
///
///   |x(v) - x(u)|  =  | B d + integral of (F - B) along the way |  >=  (sigma_min(B) - eps) |d|,
///   eps >= |F - B|,
///
/// which is positive when sigma_min(B) > eps: no two points of R are in the same place. A part with
/// a fold along its edges can be proved up to 90 degrees.
///
/// R is a rectangle of cells of a grid over the pattern. B is the middle, and eps half the
/// diagonal, of the box of all F in these cells; boxes of squares of 2, 4 and 8 cells are kept, so
/// that a rectangle takes few of them.
///
/// The way must not leave the sheet: this needs a pattern that is triangulated without overlaps and
/// whose border is convex. Vertices of a straight border that are rounded to 32 bits make it not
/// quite convex; the longer ways around them are accounted for.
/// source  this project
class InjectivePatches {
 public:
  InjectivePatches(const Points2& pattern, const Triangles&);

  /// Is the pattern such that anything can be proved?
  bool can_prove() const { return can_prove_; }

  /// A rectangle of cells, ends included.
  struct Cells {
    int left, bottom, right, top;

    Cells joined(const Cells& other) const {
      return {std::min(left, other.left), std::min(bottom, other.bottom),
              std::max(right, other.right), std::max(top, other.top)};
    }
    int count() const { return (right - left + 1) * (top - bottom + 1); }
  };
  /// The cells that a triangle may reach into.
  const Cells& of_triangle(int t) const { return cells_[t]; }

  // the components of F in six of the lanes
  using Eight = float __attribute__((vector_size(32)));
  struct GradientBox {
    Eight low, high;
  };
  // not operator new: what the C library gives for it, aligned and of this size, cannot be used
  // again when it is free (glibc before 2.38), and memory grows with every frame
  using BoxAllocator = Eigen::aligned_allocator<GradientBox>;
  /// What is known of one shape of the sheet.
  class OfShape {
   public:
    /// x  |V|x3 [m], finite
    OfShape(const InjectivePatches&, const Points3& x);
    /// True: no two points of the sheet in these cells are in the same place. False: not known.
    bool is_injective(const Cells&) const;

   private:
    const InjectivePatches& patches_;
    // at [(level x rows + row) x columns + column]: of the square of 2^level cells from there on to
    // the right and upwards, where it lies on the grid
    struct FreeBoxes {
      void operator()(GradientBox* boxes) const { BoxAllocator().deallocate(boxes, 0); }
    };
    std::unique_ptr<GradientBox[], FreeBoxes> boxes_;
  };

 private:
  int columns_ = 0, rows_ = 0;
  int levels_ = 0;  // of squares whose boxes are kept
  bool can_prove_ = false;
  Triangles triangles_;
  // [1/m] F = (x1 - x0, x2 - x0) times this, row by row; not finite where that would be inexact
  std::vector<std::array<double, 4>> to_gradient_;
  std::vector<Cells> cells_;  // of each triangle
};

}  // namespace paperbake
