#pragma once

#include "core/step2_crumple/regions.h"

#include <vector>

namespace paperbake {

/// A straight line along which paper does not bend.
struct Ruling {
  Vector2d a, b;  // [m] on the pattern
  // [1/m] curvature across it: 1 over the mean radius, which on a cone is that of its middle
  double k = 0;
  int region = 0;            // number in Regions::all()
  bool cuts_corner = false;  // cuts off a corner that is pulled
  double length() const { return (b - a).norm(); }
};

/// A part of the pattern that rulings do not enter.
struct Disc {
  Vector2d centre;
  double radius;  // [m]
};

/// Rulings all over the curved regions, so that the sheet turns by facet_turn from one to the next.
/// From the strongest bending outwards: each is the ruling of the cone fitted there, as far as the
/// sheet bends as it says, and the next one begins facet_turn/k from its middle. So cylinders get
/// parallel rulings, cones get fans, and no two of them cross.
/// polygons  [m] what the mesh covers
/// tips      [m] corners of the sheet that are pulled: rulings that cut one off are laid the nearer
///           to it, the shorter they are
/// h         [m] spacing of the base mesh
std::vector<Ruling> place_rulings(const Pattern& polygons, const BendingField&, const Regions&,
                                  const std::vector<Disc>& keep_out_discs,
                                  const std::vector<Vector2d>& loaded_corners, double h,
                                  const RulingOptions&);

}  // namespace paperbake
