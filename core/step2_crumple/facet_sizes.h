#pragma once

#include "core/model/paper.h"
#include "core/model/pattern.h"
#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

class Serializer;

/// How long the edges of a crumpled sheet are, by place on its pattern. It does not depend on the
/// mesh with which the shot began, so that neither does the number of facets. It becomes finer
/// where a mesh is too stiff to fold as the load asks, and never coarser again. Lengths are
/// multiples of the width of ridges (paper.h): heavier paper has larger facets.
class FacetSizes {
 public:
  FacetSizes(const Pattern&, const Paper&);

  /// Length of an edge at p. [m]
  double at(const Vector2d& p) const;
  /// Multiplies the lengths within `radius` [m] of p.
  void refine(const Vector2d& p, double radius, double factor);
  /// The metric (edge_operations.h) in which an edge that is to be divided is longer than 1.
  Points3 metric(const Points2& pattern) const;

  void archive(Serializer&);

 private:
  static constexpr int columns = 32;
  Vector2d cell_;                // [m]
  double least_;                 // [m]
  std::vector<double> lengths_;  // [m] columns x columns, row by row
};

}  // namespace paperbake
