#pragma once

#include "core/model/sheet.h"

#include <optional>
#include <string>
#include <vector>

namespace paperbake {

/// A handle that could not get where it was asked to.
struct Jam {
  std::string handle;
  double off_mm;
};

/// How good a frame is as caches are given it.
struct RenderNumbers {
  int triangles = 0;
  double stretch_mean_pct = 0, stretch_max_pct = 0;  // of its edges
  // CPU time: positions and normals, no writing; 0 for a simulated mesh
  double ms = 0;
  // pairs of its triangles that pass through each other
  int crossings = 0;
  // parts that would have passed through each other were taken apart
  bool kept_apart = false;
  // of its triangles and those of sheets before it in the scene
  int crossings_with_others = 0;
};

/// How good one frame of one sheet is. One line of cert/frames.jsonl, keys in this order and with
/// these names.
struct FrameRecord {
  int frame = 0;
  std::string sheet;
  int triangles = 0;
  // c_m = mean |l-L|/L over edges, simulation mesh after step 3
  double stretch_mean_pct = 0;
  double stretch_max_pct = 0;
  double angle_defect_max_deg = 0;
  double handle_err_max_mm = 0;  // against the keyed positions
  int singular = 0, new_singular = 0;
  double elastic_ms = 0, geometry_ms = 0;  // CPU time over all threads
  int substeps = 1, newton_iterations = 0;
  bool converged = true;
  double energy_J = 0;
  // render_triangles, ..., render_crossings_with_others: null when the frame was not rendered
  std::optional<RenderNumbers> render;
  int crossings = 0;              // pairs of simulated triangles that pass through each other
  int crossings_with_others = 0;  // of them and triangles of sheets before it in the scene
  int touching = 0;               // pairs of features of the mesh that contact keeps apart
  int touching_others = 0;        // pairs of one of them and one of another sheet
  int on_colliders = 0;           // vertices, edges and triangles that colliders push
  // how deep the deepest is inside a collider, simulated or rendered
  double inside_mm = 0;
  std::vector<Jam> jammed;
  std::string note;
  std::string input_hash;
  // of its positions in the .abc; empty when they are not there
  std::string content_hash;
};

/// One row of cert/handles.csv.
struct HandleRecord {
  int frame = 0;
  std::string sheet, handle;
  Vector2d pattern = Vector2d::Zero();  // [m]
  Vector3d keyed = Vector3d::Zero();    // [m]
  Vector3d held = Vector3d::Zero();     // [m] where its sheet point is
  enum State { held_state, free_state, jammed_state } state = held_state;
};

/// One row of singular.csv.
struct SingularRecord {
  std::string sheet;
  SingularPoint point;
};

// The text of the three files. Numbers are the shortest that read back as the same double. Each
// function throws Error(Fault::simulation), naming frame, sheet and field, when a number is NaN or
// infinite.

/// One JSON object, without a newline. `jammed` is a list of [handle, mm]. Bytes of a name that are
/// not UTF-8 become U+FFFD.
std::string frame_line(const FrameRecord&);

/// frame,sheet,handle,u,v,keyed_x,keyed_y,keyed_z,held_x,held_y,held_z,state   all lengths in m;
/// state: held, free, jammed. Names with commas, quotes or line ends are quoted as RFC 4180 says;
/// lines end with \n.
std::string handles_csv(const std::vector<HandleRecord>&);

/// Reads such a text. throws Error(Fault::scene) that names the line
std::vector<HandleRecord> parse_handles_csv(const std::string& text);

/// id,sheet,frame,u,v,cause   in order of birth; within a frame, in the order given. id counts from
///                            1 among the points of its
/// sheet: it is apex.id of that sheet's maps.
std::string singular_csv(const std::vector<SingularRecord>&);

/// A field of a CSV file, quoted where RFC 4180 asks for it.
std::string csv_field(const std::string& text);

}  // namespace paperbake
