#pragma once

#include "core/model/pattern.h"
#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// A straight crease on the pattern.
struct DetectedCrease {
  Vector2d from, to;    // [m]
  double strength = 0;  // (0, 1], the most so far
  int frame_of_birth = 0;
  bool from_border = false, to_border = false;  // does that end lie on the border of the pattern?
};

/// When an edge of the simulation mesh counts as a crease. Both conditions are soft: strength rises
/// from 0 at the first number of a pair to what the angle says at the second.
///
/// turned  a mesh of any size folds at its edges where paper is merely rolled, so the angle alone
///         tells little ...
/// kept    ... and what paper would keep of the angle, were it let go, tells a crease from a roll:
///         the plastic curvature across the edge, over the width that the edge stands for; without
///         a plastic memory what lies beyond the yield curvature
struct CreaseThresholds {
  double angle[2] = {0.25, 0.35};          // [rad] |fold angle|
  double plastic_angle[2] = {0.05, 0.15};  // [rad]
  double full_angle = M_PI / 2;            // [rad] |fold angle| of strength 1
  // [1/m] 2 eps_y / h of the paper; only read without a plastic memory
  double yield_curvature = 100;
};

/// The edges of a mesh that are creases now.
/// plastic_curvature  |V|x3 [1/m], or empty
std::vector<DetectedCrease> detect_creases(const Sheet&, const Points3& plastic_curvature,
                                           const Pattern&, const CreaseThresholds&);

/// Adds the creases of a frame to those of all frames before. One that lies where a known one does
/// (both ends within `same` [m]) makes that one stronger and moves it when it is the stronger one,
/// so that the memory does not grow with every frame; one that lies along a known one (an edge that
/// was cut, a crease that grew) is as old as that one. Nothing is forgotten.
void merge_creases(std::vector<DetectedCrease>& history, const std::vector<DetectedCrease>& now,
                   int frame, double same);

}  // namespace paperbake
