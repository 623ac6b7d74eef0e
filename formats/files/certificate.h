#pragma once

#include "core/model/sheet.h"

#include <optional>
#include <string>
#include <vector>

namespace paperbake {

/// A handle that jammed: the paper could not follow it to its target.
struct Jam {
  std::string handle;
  double off_mm;  // [mm] distance from the target
};

/// Quality of one frame of one sheet as it is written to the caches.
struct RenderNumbers {
  int triangles = 0;
  double stretch_mean_pct = 0, stretch_max_pct = 0;  // [%] relative length error of the edges
  // [ms] CPU time for positions and normals, without writing; 0 for a simulation mesh
  double ms = 0;
  // pairs of its triangles that intersect
  int crossings = 0;
  // layers that would have intersected were untangled
  bool kept_apart = false;
  // intersecting pairs of one of its triangles and one of a sheet before it in the scene
  int crossings_with_others = 0;
};

/// Quality of one simulated frame of one sheet: one line of cert/frames.jsonl, whose keys have
/// these names and this order.
struct FrameRecord {
  int frame = 0;
  std::string sheet;
  int triangles = 0;
  // [%] c_m = mean |l-L|/L over the edges of the simulation mesh after step 3, and their maximum
  double stretch_mean_pct = 0;
  double stretch_max_pct = 0;
  double angle_defect_max_deg = 0;
  double handle_err_max_mm = 0;            // [mm] from the keyed positions
  int singular = 0, new_singular = 0;      // singular points so far, and born in this frame
  double elastic_ms = 0, geometry_ms = 0;  // [ms] CPU time over all threads
  int substeps = 1, newton_iterations = 0;
  bool converged = true;
  double energy_J = 0;
  // render_triangles, ..., render_crossings_with_others: null when the frame was not rendered
  std::optional<RenderNumbers> render;
  // of the simulation mesh:
  int crossings = 0;              // pairs of triangles that intersect
  int crossings_with_others = 0;  // pairs with a triangle of a sheet before it in the scene
  int touching = 0;               // pairs of vertices, edges and triangles in active contact
  int touching_others = 0;        // pairs in active contact with another sheet
  int on_colliders = 0;           // vertices, edges and triangles in active contact with colliders
  // [mm] deepest penetration into a collider, of the simulation or the render mesh
  double inside_mm = 0;
  std::vector<Jam> jammed;
  std::string note;
  std::string input_hash;
  // of its positions in the .abc; empty when the frame is not in it
  std::string content_hash;
};

/// One row of cert/handles.csv.
struct HandleRecord {
  int frame = 0;
  std::string sheet, handle;
  Vector2d pattern = Vector2d::Zero();  // [m]
  Vector3d keyed = Vector3d::Zero();    // [m]
  Vector3d held = Vector3d::Zero();     // [m] position of the sheet point that it holds
  enum State { held_state, free_state, jammed_state } state = held_state;
};

/// One row of singular.csv.
struct SingularRecord {
  std::string sheet;
  SingularPoint point;
};

// The text of the three files. Every number is written with the fewest digits that read back as
// the same double. Each function throws Error(ErrorCode::simulation), with frame, sheet and field,
// when a number is NaN or infinite.

/// One JSON object on one line, without a newline. `jammed` is a list of [handle, mm]. Bytes of a
/// name that are not UTF-8 become U+FFFD.
std::string frame_line(const FrameRecord&);

/// CSV with the columns
///   frame,sheet,handle,u,v,keyed_x,keyed_y,keyed_z,held_x,held_y,held_z,state
/// with all lengths in metres and one of held, free and jammed as state. Names with commas, quotes
/// or line ends are quoted according to RFC 4180; lines end with \n.
std::string handles_csv(const std::vector<HandleRecord>&);

/// Reads the text of handles_csv. throws Error(ErrorCode::scene) with the row that is damaged
std::vector<HandleRecord> parse_handles_csv(const std::string& text);

/// CSV with the columns id,sheet,frame,u,v,cause, in order of birth, within a frame in the order
/// given; u and v in metres. id counts the points of each sheet from 1: it is apex.id of the maps
/// of that sheet.
std::string singular_csv(const std::vector<SingularRecord>&);

/// A field of a CSV file, quoted where RFC 4180 requires it.
std::string csv_field(const std::string& text);

}  // namespace paperbake
