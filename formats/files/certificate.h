#pragma once

#include "core/model/frame.h"
#include "core/model/sheet.h"
#include "formats/files/frame_statistics_table.h"

#include <optional>
#include <string>
#include <vector>

namespace paperbake {

/// A handle that jammed: the paper could not follow it to its target.
struct Jam {
  std::string handle;
  double off_mm;  // [mm] distance from the target
  // a handle that is keyed farther from it than the paper between them is long, though not before
  // one of them took hold of the paper; empty: none is known
  std::string taut_to = {};
};

/// Where a frame that was handed on is at its worst, for whoever mends it.
struct WorstPlaces {
  Vector2d stretch_at{0, 0};  // [m] middle of the worst edge on the pattern
  Vector2d inside_at{0, 0};   // [m] the point on the pattern that is deepest in a collider
  std::string inside_of;      // the name of that collider; empty: none
};

/// Quality of one frame of one sheet: one line of cert/frames.jsonl.
struct FrameRecord {
  int frame = 0;
  std::string sheet;
  FrameStatistics statistics;
  WorstPlaces worst;
  // [1] RMS distance from the twin of the bake, in shares of the longer side; empty: it has none
  std::optional<double> twin;
  std::vector<Jam> jammed;
  std::string note;
  bool step_unsolved = false;  // the sheet stands still although it, or a handle, moves
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
  HandleFrame::State state = HandleFrame::held;
};

/// One row of singular.csv.
struct SingularRecord {
  std::string sheet;
  SingularPoint point;
};

// The text of the three files. Every number is written with the fewest digits that read back as
// the same double. Each function throws Error(ErrorCode::simulation), with frame, sheet and field,
// when a number is NaN or infinite.

/// One JSON object on one line, without a newline: frame, sheet, the numbers of
/// visit_frame_statistics in their order and units (null where the frame was not rendered),
/// `render_stretch_at_mm` and `inside_at_mm` as [u, v] (null where there is none), `inside_of`,
/// `twin_pct` where there is a twin, `jammed` as a list of [handle, mm] or [handle, mm, handle to
/// which the paper is taut], note and hashes. Bytes of a name that are not UTF-8 become U+FFFD.
std::string frame_line(const FrameRecord&);

/// Reads such a line; a number that is missing in it keeps its default.
/// returns  nothing if the text is not such a line
std::optional<FrameRecord> parse_frame_line(const std::string& line);

/// Reads the lines of cert/frames.jsonl, each like this.
std::vector<std::optional<FrameRecord>> parse_frame_lines(const std::string& text);

/// CSV with the columns
///   frame,sheet,handle,u,v,keyed_x,keyed_y,keyed_z,held_x,held_y,held_z,state
/// with all lengths in metres and one of held, free, soft and jammed as state. Names with commas,
/// quotes or line ends are quoted according to RFC 4180; lines end with \n.
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
