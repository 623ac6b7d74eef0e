#pragma once

#include "core/model/singular_point_rules.h"
#include "core/step2_crumple/ruling_options.h"

namespace paperbake {

// [1] of the longer side: CrumpleOptions::persistence_severe
inline constexpr double severe_persistence = 0.0105;

/// When bending directions conflict, where a singular point is born and when an edge is flipped.
/// Angles in radians, lengths in metres.
struct CrumpleOptions {
  // [rad] turning angle |k2| sqrt(A) in the second principal direction above which there is a
  // conflict, because paper does not bend that way (8 degrees)
  double conflict_turn = 0.14;
  double conflict_ratio = 0.15;  // [1] besides, |k2| must be more than this fraction of |k1|
  // [rad] the other sign of a conflict: folds of both signs at one vertex, both larger than this
  // (13 degrees)
  double conflict_folds = 0.23;
  // [rad] threshold of the turning angle next to a singular point, which accounts for the rest
  // (20 degrees)
  double threshold_near_apex = 0.35;
  double fold_threshold_near_apex = 0.4;  // [rad] the same for the folds (23 degrees)
  // [1] of the longer side: the travel for which a conflict lasts before a singular point is born;
  // it is then no accident of the mesh
  double persistence = 0.08;
  // [1] the same for a severe conflict, which exceeds even the thresholds next to a singular point
  double persistence_severe = severe_persistence;
  // [1] the most of it that one step counts for: a conflict is seen at least twice
  double largest_travel = 0.005;
  // [1] least distance of singular points, in widths of the longest ridge that the sheet can have
  double spacing = 2;
  // [1] least distance of a singular point from the border, as a fraction of the longer side
  double border_share = 0.03;
  // [1] an edge is flipped when the other diagonal has less than this fraction of its sagitta
  double flip_gain = 0.65;
  double flip_period = 2 / 24.0;  // [s] time between two searches for edges to flip
  int max_points = 1000;          // [1] largest number of singular points on one sheet
  int max_triangles = 1000;       // [1] crumpling gives the mesh no more
  // [1] nor does a rehearsal (rehearsal.h) give the first mesh more. If it is more than
  // max_triangles, a finer first mesh may have twice as many triangles in the end.
  int max_first_triangles = 2000;
  RulingOptions rulings;
  SingularPointRules singular_point_rules;  // where singular points must not be born
};

/// What a step of Crumple changed.
struct CrumpleReport {
  int births = 0;   // singular points
  int flips = 0;    // edges
  int moves = 0;    // vertices that were moved on the pattern
  int resized = 0;  // vertices that were removed or added to give edges their length
  bool mesh_changed() const { return births + flips + moves + resized > 0; }
};

}  // namespace paperbake
