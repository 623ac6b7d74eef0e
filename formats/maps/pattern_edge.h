#pragma once

#include "core/geometry/hinges.h"
#include "core/model/segment2.h"
#include "core/model/sheet.h"

namespace paperbake {

/// An edge between two triangles on the pattern, and how paper that is bent there turns about it.
class PatternEdge {
 public:
  PatternEdge(const Sheet& sheet, const Hinge& hinge) {
    const auto at = [&](int k) -> Vector2d { return sheet.pattern.row(hinge.vertices[k]); };
    const Vector2d along = at(1) - at(0);
    const double length = along.norm(),
                 wings = 0.5 * (cross(along, at(2) - at(0)) + cross(at(3) - at(0), along));
    across_ << -along.y() / length, along.x() / length;
    width_ = 2.0 / 3 * wings / length;
  }

  /// [m] The width that an edge of a mesh of equal triangles stands for; 3/2 of that would be right
  /// where the edges run along the rulings.
  double width() const { return width_; }
  /// [rad] The turn about the edge, across this width, of a curvature Sxx, Sxy, Syy [1/m].
  double turn_of(const Eigen::RowVector3d& S) const {
    const Vector2d& n = across_;
    return width_ * (S[0] * n.x() * n.x() + 2 * S[1] * n.x() * n.y() + S[2] * n.y() * n.y());
  }

 private:
  Vector2d across_;
  double width_;
};

}  // namespace paperbake
