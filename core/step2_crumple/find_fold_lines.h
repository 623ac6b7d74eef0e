#pragma once

#include "core/geometry/collider.h"
#include "core/model/fold_line.h"
#include "core/model/pattern.h"
#include "core/model/plastic_grid.h"
#include "core/model/sheet.h"

#include <functional>
#include <optional>
#include <vector>

namespace paperbake {

/// Lines along which the sheet is being folded, although no prescribed crease is there: one fold,
/// in several places that are less than a row of triangles apart, because the mesh says no better
/// where it is. Empty: there is none.
///
/// Paper folds where it has yielded from border to border and is bent more sharply than its mesh
/// can show. A line runs where triangles have yielded, in the direction about which they have
/// turned, from a tenth of a row before the middle of their plastic turn to a tenth of a row beyond
/// where the sheet turns most. It is a fold if
/// - nine tenths of the plastic turn within a row of triangles are about it: a crumple turns about
///   several lines;
/// - in each part of it that is two rows long, paper has yielded, and the sheet turns by 90 degrees
///   or more, with a mean curvature over two rows of half the yield curvature or more. The rows
///   spread the bend of the paper, and triangles of a coarse mesh yield one before the other; but a
///   page that is rolled over yields on a coarse mesh, too, and it has no fold;
/// - the bend is sharper than the mesh can show: 1 rad or more in a row of triangles. Paper that is
///   merely curled is bent less than that, and the plate shows it;
/// - it does not go on beside the line, as that of a tube which is pressed flat: in six rows the
///   sheet turns by at most 1.3 times what it turns in three.
///
/// yield_curvature  [1/m] 2 eps_y/h
/// source           this project
std::vector<FoldLine> find_fold_lines(const Sheet&, const PlasticMemory&, const Pattern&,
                                      double yield_curvature);

/// The same for a sheet that colliders press: its mesh may be too coarse to yield in any bend.
///
/// Paper of curvature k that turns by 180 degrees is 2/k wide, so between colliders that are closer
/// to each other it is curved more somewhere, whatever its mesh shows (find_fold_lines.cpp has the
/// bound for other turns and slanted gaps). A line is looked for as above, among the edges that lie
/// between two faces of colliders. It is a fold if it is bent more sharply than the mesh can show,
/// if each part of it that is two rows long turns by 90 degrees or more there, and if the gap bends
/// paper to the yield curvature in each. A sheet that hangs free or lies on something has no such
/// edge: it may bend in a loop that is wider than its mesh.
///
/// memory  of the triangles; asked for where there are such edges only, since it takes longer to
///         read than the rest
std::vector<FoldLine> find_pressed_lines(const Sheet&, const std::function<PlasticMemory()>& memory,
                                         const ColliderShapes&, const Pattern&,
                                         double yield_curvature);

/// The same fold farther to the left of its line, seen from a to b, from border to border; nothing
/// if there is no paper. off [m]
std::optional<FoldLine> parallel_line(const FoldLine&, double off, const Pattern&);

}  // namespace paperbake
