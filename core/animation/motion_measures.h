#pragma once

#include "core/step1_elastic/elastic.h"

#include <vector>

namespace paperbake {

/// The constraint of a vertex; null: it is not held.
const PositionConstraint* constraint_of(int vertex, const PositionConstraints&);

/// How far the sheet is from rest: the largest displacement that a handle or a collider makes in
/// this frame, or a vertex made in the last step. Infinite when other vertices are held than
/// before, or when the mesh has changed. [m]
double max_displacement(const Sheet& sheet, const StepInput& now,
                        const PositionConstraints& held_before, const Points3& before);

/// Largest displacement between the targets of two frames, of vertices that are held in both. [m]
double farthest_target_move(const PositionConstraints& before, const PositionConstraints& now);

/// Whether a vertex that was held no longer is.
bool lets_go(const PositionConstraints& before, const PositionConstraints& now);

/// Vertices that a handle is about to move farther than the first length [m] while no other held
/// vertex lies within the second [m] of them on the pattern.
std::vector<int> isolated_moving_handles(const Sheet& sheet, const PositionConstraints& held,
                                         double min_move, double apart);

/// Largest displacement of a held vertex since the frame before, relative to the mean of all; 0
/// where all have moved as one rigid body. [m]
double relative_handle_motion(const Sheet& sheet, const PositionConstraints& held,
                              const PositionConstraints& held_before);

/// Root mean square of what is left of the displacements of the vertices without the rigid motion
/// that is nearest to them. 0 if the numbers of vertices differ. [m]
double rms_deformation(const Points3& before, const Points3& now);

/// How far colliders squeeze the sheet in this frame: the same of where they carry the vertices
/// that they touch at its beginning. 0 if there are fewer than three of these. [m]
double squeeze(const Points3& x, const ColliderMotion&);

}  // namespace paperbake
