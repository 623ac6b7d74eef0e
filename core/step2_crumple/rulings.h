#pragma once

#include "core/model/segment2.h"
#include "core/step2_crumple/regions.h"

#include <vector>

namespace paperbake {

/// A ruling: a straight line on the pattern along which the paper does not bend.
struct Ruling {
  Vector2d a, b;  // [m] its ends on the pattern
  // [1/m] curvature across it: 1 over the mean radius, which on a cone is the radius at its middle
  double k = 0;
  int region = 0;            // index into Regions::all()
  bool cuts_corner = false;  // it cuts off a loaded corner
  double length() const { return (b - a).norm(); }
};

/// Where handles that no other one is near pull at the sheet.
struct PulledPlaces {
  std::vector<Disc> keep_out_discs;  // that no ruling enters
  // [m] corners of the sheet that are pulled: the shorter the rulings that cut one off are, the
  // closer they are placed to each other
  std::vector<Vector2d> loaded_corners;
};

/// Places rulings all over the curved regions, so that the sheet turns by turn_per_ruling from one
/// to the next. It starts where the bending is strongest: each ruling is that of the cone fitted
/// there and extends as far as the sheet bends as the cone says, and the next one follows at
/// turn_per_ruling/k from its middle. Thus cylinders get parallel rulings, cones get fans, and no
/// two rulings cross.
/// polygons  [m] region that the mesh covers
/// h         [m] mean edge length of the base mesh
std::vector<Ruling> place_rulings(const Pattern& polygons, const BendingField&, const Regions&,
                                  const PulledPlaces&, double h, const RulingOptions&);

}  // namespace paperbake
