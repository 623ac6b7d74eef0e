#pragma once

#include "core/step2_crumple/regions.h"

#include <vector>

namespace paperbake {

/// A straight line along which paper does not bend.
struct Ruling {
  Vector2d a, b;   // [m] on the pattern
  double k = 0;    // [1/m] curvature across it: 1 over the mean radius, which on a cone is that of its middle
  int region = 0;  // number in Regions::all()
  double length() const { return (b - a).norm(); }
};

/// A part of the pattern that rulings do not enter.
struct Disc {
  Vector2d centre;
  double radius;  // [m]
};

/// Rulings all over the curved regions, so that the sheet turns by facet_turn from one to the next. From the strongest bending
/// outwards: each is the ruling of the cone fitted there, as far as the sheet bends as it says, and the next one begins
/// facet_turn/k from its middle. So cylinders get parallel rulings, cones get fans, and no two of them cross.
/// polygons  [m] what the mesh covers
/// h         [m] spacing of the base mesh
std::vector<Ruling> lay_rulings(const Pattern& polygons, const BendingField&, const Regions&, const std::vector<Disc>& guards, double h,
                                const RulingOptions&);

}  // namespace paperbake
