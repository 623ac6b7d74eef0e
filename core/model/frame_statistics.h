#pragma once

#include <optional>

namespace paperbake {

/// How good the surface is that is rendered, in one frame of one sheet.
struct RenderStatistics {
  int triangles = 0;
  double stretch_mean = 0;  // [1] mean |l-L|/L over its edges
  double stretch_max = 0;   // [1] largest |l-L|/L of an edge
  double ms = 0;            // [ms] CPU time of positions and normals; 0 for a simulated mesh
  int crossings = 0;        // pairs of its triangles that pass through each other
  // pairs of one of its triangles and one of a sheet before it in the scene that do
  int crossings_with_others = 0;
  // parts that would have passed through each other were taken apart
  bool kept_apart = false;
};

/// The numbers of one frame of one sheet, in SI units and milliseconds. A new number is a field
/// here and a row of the table from which files are written
/// (formats/files/frame_statistics_table.h).
struct FrameStatistics {
  // of the simulated mesh after step 3, measured by whoever records the frame; the handle error is
  // measured again on what is handed on
  int triangles = 0;
  double stretch_mean = 0;      // [1] c_m = mean |l-L|/L over its edges
  double stretch_max = 0;       // [1] largest |l-L|/L of an edge
  double angle_defect_max = 0;  // [rad] largest angle defect of a vertex
  double handle_error_max = 0;  // [m] largest HandleFrame::error
  int singular = 0;             // singular points so far
  int folds = 0;                // crease lines that are folded so far
  int crossings = 0;            // pairs of its triangles that pass through each other
  // pairs of one of its triangles and one of a sheet before it in the scene that do
  int crossings_with_others = 0;
  // since the frame before that is recorded; 0 in the first
  double moved = 0;   // [m] root mean square over the sheet
  double driven = 0;  // [m] farthest way of what drives it: of a handle, a collider or the wind

  // of what is handed on; of the simulated mesh where nothing is
  double inside = 0;  // [m] how deep its deepest point is inside a collider

  // told by the simulation
  int new_singular = 0;    // singular points born in this frame
  double elastic_ms = 0;   // [ms] CPU time of step 1, over all threads
  double geometry_ms = 0;  // [ms] CPU time of everything else that touches the sheet
  bool inertia = false;    // the sheet moves with inertia
  int substeps = 1;
  int newton_iterations = 0;
  bool converged = true;
  double energy = 0;           // [J] stored in the sheet
  double membrane_energy = 0;  // [J] its stretching part
  double plastic = 0;          // [m rad] integral of the plastic curvature over the pattern so far
  int doublings = 0;           // of the number of triangles of its first mesh
  // [1] of the longer side: how far the sheet is from where it would be on a finer mesh
  // (mesh_check.h); 0: not known
  double mesh_error = 0;
  bool contact = false;         // the sheet came near itself and was kept from passing through
  int touching = 0;             // pairs of its features that contact keeps apart
  int touching_others = 0;      // pairs of one of its features and one of another sheet
  int on_colliders = 0;         // vertices, edges and triangles that colliders push
  double inside_colliders = 0;  // [m] how deep the deepest of them is, as the solver sees it
  // what became of the mesh that the method proposed
  enum Remesh : int { none, accepted, rejected } remesh = none;
  double remesh_rise = 0;  // [1] rise of the potential with it, as a share of the stored energy

  std::optional<RenderStatistics> render;  // empty until the frame was rendered
};

}  // namespace paperbake
