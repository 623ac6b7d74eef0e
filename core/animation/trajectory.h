#pragma once

#include "core/model/sheet.h"

#include <vector>

namespace paperbake {

/// Positions of a sheet at one time of a frame.
struct TrajectoryPoint {
  double at;  // [1] 0: start of the frame, 1: its end
  Points3 x;  // |V|x3 [m]
};

/// Where a sheet was during a frame, as the vertices of the mesh that it has at the end of it; they
/// go straight from point to point.
class Trajectory {
 public:
  /// The frame begins with the sheet where it is.
  void begin(const Sheet&);
  /// The sheet has gone on. It may be on another mesh by now, onto which its path is then taken.
  /// points  of a part of the frame, as if it were a whole one, with positions on the mesh of the
  ///         sheet
  /// from, to  [1] begin and end of the part
  void append(const Sheet&, const std::vector<TrajectoryPoint>& points, double from, double to);
  /// The frame ends with the sheet where it is.
  void end(const Sheet&);

  const std::vector<TrajectoryPoint>& points() const { return points_; }

 private:
  void carry_onto(const Sheet&);
  Points2 pattern_;      // of the mesh of all points
  Triangles triangles_;  // the same
  std::vector<TrajectoryPoint> points_;
};

}  // namespace paperbake
