#pragma once

#include "core/model/paper.h"
#include "core/model/pattern.h"
#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// A straight crease that the simulated sheet shows, as a segment on the pattern.
struct DetectedCrease {
  Vector2d from, to;    // [m]
  double strength = 0;  // (0, 1], the largest so far
  int frame_of_birth = 0;
  bool from_border = false, to_border = false;  // whether that end lies on the pattern's border
};

/// When an edge of the simulation mesh counts as a crease. It has to satisfy two soft conditions,
/// each given by a pair of thresholds: below the first the strength is 0, above the second the
/// condition does not reduce it.
///
/// angle          dihedral angle at the edge. Alone it says little: every mesh is folded at its
///                edges where paper is merely rolled.
/// plastic_angle  the angle that would remain if the paper were released, which tells a crease from
///                a roll: plastic curvature across the edge times the width that the edge stands
///                for; in a simulation without plasticity, the excess over the yield curvature
struct CreaseThresholds {
  double angle[2] = {0.25, 0.35};          // [rad]
  double plastic_angle[2] = {0.05, 0.15};  // [rad]
  double full_angle = M_PI / 2;            // [rad] dihedral angle of strength 1
  // [1/m] 2 eps_y / h of the paper; only used in a simulation without plasticity
  double yield_curvature = 100;
};

/// The thresholds for a paper.
CreaseThresholds crease_thresholds(const Paper&);

/// The edges of the mesh that are creases in this frame.
/// plastic_curvature  |V|x3 [1/m], or empty in a simulation without plasticity
std::vector<DetectedCrease> detect_creases(const Sheet&, const Points3& plastic_curvature,
                                           const Pattern&, const CreaseThresholds&);

/// Adds the creases of a frame to those of all frames before; none is ever removed. A crease in the
/// place of a known one (both ends within `same` [m]) replaces it if it is stronger and is dropped
/// otherwise, so that the history does not grow with every frame. A crease that lies along a known
/// one (part of an edge that was split, or a crease that has grown) inherits its frame of birth.
void merge_creases(std::vector<DetectedCrease>& history, const std::vector<DetectedCrease>& now,
                   int frame, double same);

}  // namespace paperbake
